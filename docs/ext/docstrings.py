"""The package's docstrings for Sphinx.

They are written to be read in a terminal: plain sentences, then lines "name: meaning" whose continuations are indented.
Here such lines become definition lists, indented paragraphs become code, `names` become links, and what reStructuredText
would misread is escaped. SPDX-License-Identifier: MIT
"""
import inspect
import re
import sys
import typing

from sphinx.pycode import ModuleAnalyzer
from sphinx.util.inspect import stringify_signature
from sphinx.util.nodes import make_refnode

import brdffit

_NAME = r"\w+(?: \([^()]*\))?"
_NAMES = re.compile(r"^(%s(?:(?:,| and) %s)*(?: after it)?): " % (_NAME, _NAME))
_NEXT = re.compile(r"; (\w+(?:, \w+)*): ")
_LITERAL = re.compile(r"(`+)(.+?)\1", re.S)
# Packages that annotations name, whose documentation is not linked: pages fetch nothing, and the builder neither.
_ELSEWHERE = {"xarray"}
_QUOTED = re.compile(r'^"[\w-]+": ')


def _plain(text):
    """Of the text between literals: stars, bars and trailing underscores are meant."""
    text = re.sub(r"([*|\\])", r"\\\1", text)
    return re.sub(r"(?<=\w)_(?=\W|$)", r"\\_", text)


def _literal(word):
    name = word.removeprefix("brdffit.").removesuffix("()")
    head, _, rest = name.partition(".")
    if head not in brdffit.__all__ or not re.fullmatch(r"\w*", rest):
        return "``%s``" % word
    member = getattr(getattr(brdffit, head), rest, None) if rest else None
    # Fields of a dataclass have no place of their own: their class lists them.
    target = name if callable(member) or isinstance(member, property) else head
    return ":py:obj:`%s <brdffit.%s>`" % (word, target)


def inline(text):
    out, end = [], 0
    for match in _LITERAL.finditer(text):
        out += [_plain(text[end:match.start()]), _literal(match.group(2))]
        end = match.end()
    return "".join(out) + _plain(text[end:])


def _paragraphs(lines):
    block = []
    for line in [*lines, ""]:
        if line.strip():
            block.append(line.rstrip())
        elif block:
            yield block
            block = []


def _definitions(block, known):
    """The lines of a block as (names, text lines); None where it is a plain paragraph."""
    found = []
    for line in block:
        match = _NAMES.match(line)
        if match:
            found.append((match.group(1), [line[match.end():]]))
        elif found and line.startswith(" "):
            found[-1][1].append(line.strip())
        else:
            return None
    return [part for names, lines in found for part in _split(names, lines, known)]


def _split(names, lines, known):
    """One line may define several: "x: diffuse coefficients; y: specular ones"."""
    out = []
    if not any(map(_QUOTED.match, lines)):
        lines = [" ".join(lines)]
        while True:
            cut = next((m for m in _NEXT.finditer(lines[0]) if m.group(1).split(", ")[0] in known), None)
            if cut is None:
                break
            out.append((names, [lines[0][:cut.start()]]))
            names, lines = cut.group(1), [lines[0][cut.end():]]
    return [*out, (names, lines)]


def _definition(names, text):
    plain = re.fullmatch(r"\w+(?:, \w+)*", names)
    out = [", ".join("``%s``" % name for name in names.split(", ")) if plain else inline(names), "    " + inline(text[0])]
    listed = False
    for line in text[1:]:
        if _QUOTED.match(line):
            out += ([] if listed else [""]) + ["    - " + inline(line)]
            listed = True
        else:
            out.append(("      " if listed else "    ") + inline(line))
    return [*out, ""]


def _known(kind, thing):
    """What a docstring may define: the attributes of a class, the parameters of a function; None: nothing."""
    if kind in ("class", "exception"):
        return {*dir(thing), *getattr(thing, "__annotations__", ())}
    return set(inspect.signature(thing).parameters) if callable(thing) else None


def convert(lines, kind, known):
    out, titled = [], False
    for block in _paragraphs(lines):
        definitions = None if known is None else _definitions(block, known)
        if definitions:
            title = "Attributes" if kind in ("class", "exception") else "Parameters" if any(
                name in known for names, _ in definitions for name in re.findall(r"\w+", names)) else None
            if title and not titled:
                out += [".. rubric:: " + title, ""]
                titled = True
            for names, text in definitions:
                out += _definition(names, text)
        elif all(line.startswith("    ") for line in block):
            out += [".. code-block:: python", "", *block, ""]
        else:
            out += [*inline("\n".join(line.strip() for line in block)).split("\n"), ""]
    return out


def process(app, what, name, obj, options, lines):
    lines[:] = convert(lines, what, _known(what, obj))


def signature(app, what, name, obj, options, text, returns):
    """Annotations as they are written, not what they stand for: ArrayLike alone is a paragraph."""
    if what not in ("class", "exception", "function", "method") or text is None:
        return None
    try:
        given = inspect.signature(obj)
    except (TypeError, ValueError):
        return None
    parameters = list(given.parameters.values())
    needed = sum(p.default is p.empty for p in parameters)
    if what == "class" and (len(parameters) > 20 or needed > 6):
        return "", None  # made by the library, never by hand; the attributes say what is in it
    if parameters and parameters[0].name == "self":
        parameters = parameters[1:]
    if what in ("class", "exception"):
        given = given.replace(return_annotation=inspect.Signature.empty)
    written = stringify_signature(given.replace(parameters=parameters)).replace("npt.ArrayLike", "ArrayLike")
    before, arrow, after = written.partition(" -> ")
    return before, after if arrow else None


def _internal(name):
    """Whether some module of the package knows this name: an alias of a type, or a class that users never name."""
    modules = [module for path, module in list(sys.modules.items()) if path.split(".")[0] == "brdffit"]
    return name == "ArrayLike" or any(hasattr(module, name) for module in modules) or hasattr(typing, name)


def resolve(app, env, node, contnode):
    """Annotations name what they were written with: a public class under the name that users import becomes a link, and an
    alias stays text (python.md says what they stand for). What nobody knows is a warning."""
    target = node.get("reftarget", "")
    name = target.rpartition(".")[2]
    if target.partition(".")[0] in _ELSEWHERE:
        return contnode
    if node.get("refdomain") != "py" or not (target == name or target.startswith("brdffit.")):
        return None
    objects = env.domains["py"].objects
    known = objects.get("brdffit." + name) or next((objects[path] for path in sorted(objects) if path.startswith("brdffit.")
                                                    and path.count(".") == 2 and path.endswith("." + name)
                                                    and objects[path].objtype in ("class", "exception")), None)
    if known:
        return make_refnode(app.builder, node["refdoc"], known.docname, known.node_id, contnode)
    return contnode if node.get("reftype") == "class" and _internal(name) else None


def forget_overloads(app):
    """Their signatures are for type checkers: `signature` gives the one that says every argument, and all that may come back."""
    for name in [name for name in sys.modules if name.partition(".")[0] == "brdffit"]:
        analyzer = ModuleAnalyzer.for_module(name)  # autodoc gets the same one
        analyzer.analyze()
        analyzer.overloads.clear()


def setup(app):
    app.connect("builder-inited", forget_overloads)
    app.connect("autodoc-process-docstring", process)
    app.connect("autodoc-process-signature", signature)
    app.connect("missing-reference", resolve)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
