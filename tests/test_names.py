"""Names of distributions: the library has them, and the command line, its manual and the documents tell all of them.

Not in tests/cli, which runs under sanitizers too: a library with AddressSanitizer cannot be loaded into Python.

SPDX-License-Identifier: MIT
"""
import ctypes
import os
import pathlib
import re
import subprocess

import pytest

ROOT = pathlib.Path(__file__).resolve().parent.parent
BUILD = (ROOT / os.environ.get("BRDFFIT_BUILD", "build")).resolve()


def run(*arguments, cwd=None):
    done = subprocess.run([BUILD / "brdffit", *arguments], cwd=cwd, env={**os.environ, "LC_ALL": "C.UTF-8"}, check=True,
                          capture_output=True, encoding="utf-8")
    return " ".join(done.stdout.split())


def library_names():
    """Name, title and parameter of each distribution, in the order of the enum."""
    library = ctypes.CDLL(str(BUILD / "libbrdffit.so"))
    for function in (library.brdffit_distribution_string, library.brdffit_distribution_title,
                     library.brdffit_parameter_string):
        function.restype = ctypes.c_char_p
    out = []
    while library.brdffit_distribution_string(len(out)) != b"unknown":
        at = len(out)
        out.append(tuple(f(at).decode() for f in (library.brdffit_distribution_string, library.brdffit_distribution_title,
                                                  library.brdffit_parameter_string)))
    for function in (library.brdffit_distribution_title, library.brdffit_parameter_string):
        assert function(len(out)) == function(-1) == b"unknown"
    return out


NAMES = library_names()
TITLES = {name: title for name, title, _ in NAMES}


def test_each_has_a_title():
    assert len({name for name, _, _ in NAMES}) == len({title for _, title, _ in NAMES}) == len(NAMES)
    for name, title, parameter in NAMES:
        assert title.lower() == name and parameter in ("sigma", "exponent")


@pytest.mark.parametrize("command", ["fit", "map"])
def test_the_help_has_each(command):
    text = run(command, "--help")
    known = re.search(r"--distribution NAME what a lobe is: (.*?) with roughness sigma; (.*?) with exponent n", text)
    for words, wanted in zip(known.groups(), ("sigma", "exponent")):
        assert re.split(r", | or ", words) == [name for name, _, parameter in NAMES if parameter == wanted]


def test_the_manual_has_each():
    """In DISTRIBUTIONS, with its formula, and n where it is known by that."""
    manual = (ROOT / "tools" / "brdffit" / "brdffit.1").read_text()
    section = manual.partition(".SH DISTRIBUTIONS")[2].partition(".SH")[0]
    entries = dict(re.findall(r"\.TP\n\.B (\S+)\n(.+)\n", section))
    assert list(entries) == [name for name, _, _ in NAMES]
    for name, _, parameter in NAMES:
        assert ("\\(*s" in entries[name]) == (parameter == "sigma"), name


@pytest.fixture(scope="module")
def desk(tmp_path_factory):
    folder = tmp_path_factory.mktemp("instruments")
    subprocess.run([BUILD / "goniometer", folder], check=True, capture_output=True)
    return folder


@pytest.mark.parametrize("name, title, parameter", NAMES)
def test_each_is_fitted(desk, name, title, parameter):
    words = run("fit", "--distribution", name, "two_lobe_satin.csv", cwd=desk)
    assert "no %s fit with 1 lobe and %s in" % (title, "n" if parameter == "exponent" else "σ") in words
    other = "ggx" if name != "ggx" else "beckmann"
    words = run("fit", "--lobes", name + "," + other, "--gap", "0.1", "two_lobe_satin.csv", cwd=desk)
    assert "fit of one %s and one %s lobe" % (title, TITLES[other]) in words or "exact" in words


def test_words_of_columns():
    """The reader's words are what `info --help` and the documents list."""
    library = ctypes.CDLL(str(BUILD / "libbrdffit_io.so"))
    library.brdffit_io_column_words.restype = ctypes.c_char_p
    library.brdffit_io_column_words.argtypes = [ctypes.c_size_t, ctypes.POINTER(ctypes.c_char_p)]
    what, known = ctypes.c_char_p(), {}
    while (words := library.brdffit_io_column_words(len(known), ctypes.byref(what))) is not None:
        known[what.value.decode()] = words.decode().strip()
    assert len(known) > 15
    told, documents = run("info", "--help"), (ROOT / "docs" / "files.md").read_text(encoding="utf-8")
    for meaning, words in known.items():
        assert "%s: %s" % (meaning, words) in told
        assert "| %s | %s |" % (meaning, words) in documents
