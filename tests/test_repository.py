"""What stands in the repository for those who come by says what is there: targets of make, versions, files.

SPDX-License-Identifier: MIT
"""
import pathlib
import re
import subprocess

import pytest

ROOT = pathlib.Path(__file__).resolve().parent.parent
WORKFLOWS = sorted((ROOT / ".github" / "workflows").glob("*.yml"))


def version():
    return re.search(r'BRDFFIT_VERSION_STRING "(.*)"', (ROOT / "include" / "brdffit.h").read_text()).group(1)


@pytest.mark.parametrize("path", WORKFLOWS, ids=lambda path: path.name)
def test_workflows_make_what_there_is(path):
    """Each `make` of a workflow names targets that the Makefile knows, or files of the build."""
    text = path.read_text()
    assert "permissions:\n  contents: read" in text
    known = subprocess.run(["make", "-C", ROOT, "-npRr", "help", "ECOS=0"], capture_output=True, text=True).stdout
    for words in re.findall(r"\bmake ((?:-j\d+ |[\w./-]+ ?)+)", text):
        for word in words.split():
            if not word.startswith("-") and "=" not in word and "/" not in word and not word.isupper():
                assert re.search(r"^%s:" % re.escape(word), known, re.M), (path.name, word)


def test_citation():
    text = (ROOT / "CITATION.cff").read_text()
    assert re.search(r"^version: (.*)$", text, re.M).group(1) == version()
    assert "10.1109/CVPR.2010.5540197" in text and "start: 319" in text and "end: 326" in text


def test_files_that_are_named_exist():
    for name in ("SECURITY.md", "SUPPORT.md", "CODE_OF_CONDUCT.md"):
        for target in re.findall(r"\]\(([^)#:]+)\)", (ROOT / name).read_text()):
            assert (ROOT / target).exists(), (name, target)
    for script in re.findall(r"entry: sh (\S+)", (ROOT / ".pre-commit-config.yaml").read_text()):
        assert (ROOT / script).exists()
