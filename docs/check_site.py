"""A look at the built pages: what a reader would miss, and what Sphinx does not say. SPDX-License-Identifier: MIT"""
import html.parser
import json
import pathlib
import re
import sys
import urllib.parse

from ext import api_pages

# Attributes by which a page makes the browser fetch something.
_FETCHED = {"img": "src", "script": "src", "link": "href", "iframe": "src", "source": "src", "object": "data"}
_NOT_FETCHED = {"index", "search", "next", "prev", "canonical", "author", "help", "copyright", "top"}


class Page(html.parser.HTMLParser):
    def __init__(self, path):
        super().__init__()
        self.fetched, self.links, self.without_alt, self.names, self.images = [], [], [], set(), 0
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag, attributes):
        found = dict(attributes)
        self.names |= {found[key] for key in ("id", "name") if found.get(key)}
        if tag in _FETCHED and found.get(_FETCHED[tag]) and not (tag == "link" and found.get("rel") in _NOT_FETCHED):
            self.fetched.append(found[_FETCHED[tag]])
        if tag == "a" and found.get("href"):
            self.links.append(found["href"])
        if tag == "img":
            self.images += 1
            if len(found.get("alt") or "") < 20 or (found.get("alt") or "").startswith(("_images", "../_images")):
                self.without_alt.append(found.get("src"))


def _local(folder, pages, path, link):
    """What is wrong with a link, or None."""
    address, _, name = link.partition("#")
    parts = urllib.parse.urlsplit(address)
    if parts.scheme or parts.netloc:
        return None
    target = path if not parts.path else (path.parent / urllib.parse.unquote(parts.path)).resolve()
    if not target.is_file():
        return "no such file"
    if name and target in pages and urllib.parse.unquote(name) not in pages[target].names:
        return "no such place"
    return None


def _notebooks(sources):
    for path in sorted(sources.glob("*.ipynb")):
        for number, cell in enumerate(json.loads(path.read_text(encoding="utf-8"))["cells"]):
            if cell["cell_type"] == "code" and (cell["outputs"] or cell["execution_count"] is not None):
                yield "%s: cell %d is stored with its output; clear it" % (path.name, number)


def _declared(headers):
    """What the headers declare, as the C reference should hold it: told by other means than ext/c_header.py's. Functions of
    brdffit_shade.h are made by macros for two types: export.md tells of them."""
    for path in sorted(set(headers.glob("*.h")) - {headers / "brdffit_shade.h"}):
        text = re.sub(r"/\*.*?\*/", "", path.read_text(encoding="utf-8"), flags=re.S)
        yield from re.findall(r"^BRDFFIT_API\s[^;(]*?(\w+)\(", text, re.M)
        yield from re.findall(r"typedef (?:struct|enum) (\w+)", text)
        yield from re.findall(r"^ +(BRDFFIT_[A-Z0-9_]+)(?: = \w+)?,?$", re.sub(r"[ \t]+$", "", text, flags=re.M), re.M)


def problems(folder, sources):
    pages = {path.resolve(): Page(path) for path in sorted(folder.rglob("*.html"))}
    yield from _notebooks(sources)
    for path, page in pages.items():
        here = path.relative_to(folder.resolve())
        yield from ("%s: fetches %s from elsewhere" % (here, a) for a in page.fetched if a.startswith(("http", "//")))
        yield from ("%s: %s has no words in its place" % (here, source) for source in page.without_alt)
        for link in page.links:
            wrong = _local(folder, pages, path, link)
            if wrong:
                yield "%s: %s: %s" % (here, link, wrong)
    names = set().union(*(page.names for page in pages.values()))
    yield from ("%s is in no page of the reference" % name for name in api_pages.exported() if name not in names)
    places = {name.rpartition(".")[2] for name in names if name.startswith("c.")}  # a constant's is in its enum's
    declared = sorted(set(_declared(sources.parent / "include")))
    yield from ("%s is in no page of the reference" % name for name in declared if name not in places)
    if len(declared) < 100:
        yield "only %d names are declared in the headers: they were not understood" % len(declared)
    for name, least in (("tutorial.html", 4), ("maps.html", 1), ("proof.html", 7)):
        page = pages.get((folder / name).resolve())
        if page is None or page.images < least:
            yield "%s has fewer than %d figures: its cells were not run" % (name, least)


def check(folder, sources):
    found = list(problems(folder, sources))
    for line in found:
        print("docs: " + line, file=sys.stderr)
    if not found:
        print("docs: %s" % (folder / "index.html"))
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(check(pathlib.Path(sys.argv[1]), pathlib.Path(__file__).resolve().parent))
