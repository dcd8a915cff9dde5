"""Mathematics as MathML, which browsers draw themselves: no script, no font and no network.

SPDX-License-Identifier: MIT
"""
from docutils import nodes
from docutils.utils.math import MathError
from docutils.utils.math.latex2mathml import tex2mathml
from sphinx.util import logging

logger = logging.getLogger(__name__)


def _translate(node, block):
    try:
        return tex2mathml(node.astext(), as_block=block)
    except (MathError, SyntaxError) as error:
        logger.warning("formula %r: %s", node.astext(), error, location=node)
        return ""


def inline(writer, node):
    writer.body.append(_translate(node, False))
    raise nodes.SkipNode


def block(writer, node):
    # Wide formulae scroll by themselves on a phone.
    writer.body.append('<div class="formula">%s</div>' % _translate(node, True))
    raise nodes.SkipNode


def setup(app):
    app.add_html_math_renderer("mathml", inline_renderers=(inline, None), block_renderers=(block, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}
