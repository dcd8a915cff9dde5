"""Pages of the C reference, from the headers: their comments are the documentation, and this only puts it into pages.

A header is a row of groups: a comment, and the declarations that follow it up to the next blank line. Groups stand under
titles, `/* ---- Samples ---- */`. Paragraphs of a comment become text, what is indented or aligned in it stays as it is.
SPDX-License-Identifier: MIT
"""
import re

from .docstrings import inline

_TITLE = re.compile(r"^/\* -{3,} (.*?) -+ \*/$")
_GUARD = re.compile(r"^#(?:include|if|ifdef|ifndef|else|endif|define (?:\w+_H|BRDFFIT_API)\b)|^extern \"C\"|^}$|^struct \w+;$")


def _tokens(text):
    """("title" | "blank" | "comment" | "code", text) in the order of the file."""
    lines = iter(text.split("\n"))
    for line in lines:
        title = _TITLE.match(line)
        if title:
            yield "title", title.group(1)
        elif not line.strip():
            yield "blank", ""
        elif line.startswith("/*"):
            block = [line]
            while not block[-1].rstrip().endswith("*/"):
                block.append(next(lines))
            yield "comment", "\n".join(block)
        elif not _GUARD.match(line):
            block = [line]
            while not _complete(block):
                block.append(next(lines))
            yield "code", "\n".join(block)


def _bare(text):
    return re.sub(r"/\*.*?(?:\*/|$)", "", text, flags=re.S)


def _complete(block):
    text = "\n".join(block)
    if text.startswith("#"):
        return text.count("/*") == text.count("*/") and not text.rstrip().endswith("\\")
    bare = _bare(text).rstrip()
    return bare.endswith(";") and bare.count("{") == bare.count("}") and text.count("/*") == text.count("*/")


def _words(comment):
    """The text of a comment without its stars."""
    body = re.sub(r"^/\*+ ?|\s*\*/$", "", comment)
    return "\n".join(re.sub(r"^ ?\* ?", "", line).rstrip() for line in body.split("\n")).strip("\n")


def _prose(words):
    out = []
    for paragraph in re.split(r"\n\s*\n", words):
        if re.search(r"^ |\S {2,}\S", paragraph, re.M) and not re.search(r"\A\S.*\. {2}\S", paragraph):
            out += [".. code-block:: text", "", *("   " + line for line in paragraph.split("\n")), ""]
        else:
            out += [inline(" ".join(paragraph.split())), ""]
    return out


def _enumerators(code):
    """Each constant and the words beside it."""
    body = code[code.index("{") + 1:code.rindex("}")]
    for name, words in re.findall(r"^ *([A-Z]\w*)(?: = [^,/\n]+)?,?(?: */\*(.*?)\*/)?", body, re.M | re.S):
        yield name, " ".join(words.split())


def _directive(code):
    """Kind of the C domain, its signature, and the code that is shown; None for nothing of ours."""
    macro = re.match(r"#define (\w+)", code)
    if macro:
        return "macro", macro.group(1), code
    flat = " ".join(_bare(code).split())
    record = re.match(r"typedef (struct|enum) (\w+)( \{)?", flat)
    if record:
        return record.group(1), record.group(2), code if record.group(3) else None
    if flat.startswith("typedef "):
        return "type", flat[len("typedef "):-1], None
    if flat.startswith("BRDFFIT_API "):
        return "function", flat[len("BRDFFIT_API "):-1], None
    raise ValueError("not understood: " + code)


def _group(comment, codes):
    out, words = [], [] if comment is None else _prose(_words(comment))
    parts = []
    for kind, signature, shown in map(_directive, codes):
        if parts and parts[-1][0] == kind and kind in ("function", "macro"):
            parts[-1][1].append(signature)
            parts[-1][2].append(shown)
        else:
            parts.append((kind, [signature], [shown]))
    for kind, signatures, shown in parts:
        out += [".. c:%s:: %s" % (kind, signatures[0]), *(" " * (len(kind) + 8) + more for more in signatures[1:]), ""]
        body = words
        words = []
        code = [text for text in shown if text]
        if kind == "enum":
            for name, meaning in _enumerators(code[0]):
                body = [*body, ".. c:enumerator:: " + name, "", *(["   " + inline(meaning), ""] if meaning else [])]
        elif code:
            body = [*body, ".. code-block:: c", "", *("   " + line for text in code for line in text.split("\n")), ""]
        out += ["   " + line if line else "" for line in body]
    return out + words


def page(text, title, first):
    """The header as reStructuredText; `first` is the title of what stands before the first one of its own."""
    out = [title, "=" * len(title), ""]
    comment, codes, seen = None, [], False
    pending_title = first
    for kind, token in [*_tokens(text), ("blank", "")]:
        if kind == "code":
            codes.append(token)
            continue
        if codes or (kind == "title" and comment):
            if pending_title is not None:
                out += [pending_title, "-" * len(pending_title), ""]
                pending_title = None
            out += _group(comment, codes)
            comment, codes = None, []
        if kind == "comment":
            if not seen:  # the header's own comment opens the page
                out += _prose(re.sub(r"\s*SPDX-License-Identifier: MIT", "", _words(token)))
                seen = True
            else:
                comment = token
        elif kind == "title":
            pending_title = token
    return "\n".join(out)
