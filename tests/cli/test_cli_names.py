"""Names of distributions: the library has them, and the command line, its manual and the documents tell all of them.

SPDX-License-Identifier: MIT
"""
import ctypes
import re

import pytest

import harness


def library_names():
    """Name, title and parameter of each distribution, in the order of the enum."""
    library = ctypes.CDLL(str(harness.BUILD / "libbrdffit.so"))
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
    text = " ".join(harness.run(command, "--help").stdout.split())
    known = re.search(r"--distribution NAME what a lobe is: (.*?) with roughness sigma; (.*?) with exponent n", text)
    for words, wanted in zip(known.groups(), ("sigma", "exponent")):
        assert re.split(r", | or ", words) == [name for name, _, parameter in NAMES if parameter == wanted]


def test_the_manual_has_each():
    """In DISTRIBUTIONS, with its formula, and n where it is known by that."""
    manual = (harness.ROOT / "tools" / "brdffit" / "brdffit.1").read_text()
    section = manual.partition(".SH DISTRIBUTIONS")[2].partition(".SH")[0]
    entries = dict(re.findall(r"\.TP\n\.B (\S+)\n(.+)\n", section))
    assert list(entries) == [name for name, _, _ in NAMES]
    for name, _, parameter in NAMES:
        assert ("\\(*s" in entries[name]) == (parameter == "sigma"), name


@pytest.mark.parametrize("name, title, parameter", NAMES)
def test_each_is_fitted(desk, name, title, parameter):
    done = harness.run("fit", "--distribution", name, "two_lobe_satin.csv", cwd=desk)
    assert done.returncode == 0
    words = " ".join(done.stdout.split())
    assert "no %s fit with 1 lobe and %s in" % (title, "n" if parameter == "exponent" else "σ") in words
    other = "ggx" if name != "ggx" else "beckmann"
    done = harness.run("fit", "--lobes", name + "," + other, "--gap", "0.1", "two_lobe_satin.csv", cwd=desk)
    assert done.returncode == 0
    assert "fit of one %s and one %s lobe" % (title, TITLES[other]) in " ".join(
        done.stdout.split()) or "exact" in done.stdout
