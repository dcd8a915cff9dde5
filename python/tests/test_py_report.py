"""brdffit-report: its pages, its exit codes, and what a browser says of them. SPDX-License-Identifier: MIT"""
import os
import re
import stat
import sys

import harness
import numpy as np
import pytest
from places import SOURCES

import browser
import brdffit
from brdffit import report
from brdffit.report import _analysis as analysis

FILES = ("two_lobe_satin.csv", "ggx_metal.csv", "matte.csv", "two_lobe_table.binary")


@pytest.fixture(scope="session")
def pages(instruments, tmp_path_factory):
    folder = tmp_path_factory.mktemp("report")
    assert report.main(["-q", "-o", str(folder), *(str(instruments / name) for name in FILES)]) == 0
    return folder


def test_pages_stand_alone(pages):
    names = sorted(p.name for p in pages.iterdir())
    assert names == ["ggx_metal.html", "index.html", "matte.html", "two_lobe_satin.html", "two_lobe_table.html"]
    for page in pages.iterdir():
        text = re.sub(r"data:image/png;base64,[\w+/=]*", "data:", page.read_text())
        assert not re.search(r"(?:src|href)='(?!data:|[\w.-]+\.html)", text) and "<script" not in text and not re.search(r"\bnan\b", text, re.I)
    text = (pages / "two_lobe_satin.html").read_text()
    for words in ("Proven: no Beckmann fit with 2 lobes", "Measured against fitted", "In the plane of incidence", "The proof",
                  "Spheres", "lit from beyond 60°"):
        assert words in text
    assert (pages / "two_lobe_table.html").read_text().count("<img ") == 3


def test_names_are_escaped(tmp_path):
    samples = brdffit.Samples.example()
    text = report.page(samples, "<b>&", lobes=1)
    assert "<b>&<" not in text and "&lt;b&gt;&amp;" in text


def test_exit_codes(instruments, tmp_path, capsys):
    out = ["-q", "-o", str(tmp_path / "out")]
    good = str(instruments / FILES[0])
    assert report.main([*out, good, str(tmp_path / "absent.csv")]) == 1
    assert "absent.csv" in capsys.readouterr().err and "absent.csv" in (tmp_path / "out" / "index.html").read_text()
    (tmp_path / "bad.csv").write_text("theta_i,theta_o,r\n0,0,x\n")
    assert report.main([*out, str(tmp_path / "bad.csv")]) == 3
    assert report.main([*out, "--box-budget", "3", good]) == 4
    with pytest.raises(SystemExit) as caught:
        report.main([*out, "--lobes", "3", good])
    assert caught.value.code == 2


def test_the_command_line_finds_it(instruments, tmp_path):
    script = tmp_path / "brdffit-report"
    script.write_text("#!%s\nimport sys\nfrom brdffit.report import main\nsys.exit(main())\n" % sys.executable)
    script.chmod(script.stat().st_mode | stat.S_IXUSR)
    done = harness.run("report", "-o", tmp_path / "out", instruments / FILES[0], env=harness.environment(
        PATH="%s:%s" % (tmp_path, os.environ["PATH"]), PYTHONPATH=str(SOURCES)))
    assert done.returncode == 0 and (tmp_path / "out" / "two_lobe_satin.html").exists(), done.stderr


def test_bounds_stay_below_the_curve():
    """The picture of the proof against plain least squares, which shares nothing with the search."""
    material = analysis.measure("satin", brdffit.Samples.example(), {}, 2)
    slack = 1 + 1e-9
    sigma = np.geomspace(0.01, 5, 60)
    for lobes in (1, 2):
        exact = analysis.objective(material, sigma, lobes)
        boxes = material.boxes[lobes]
        assert len(boxes) == material.fits[lobes].boxes
        assert exact.min() * slack >= material.fits[lobes].e2
        if lobes == 1:
            assert np.all(boxes.bound_at(sigma) <= exact * slack)
        else:
            i, j = np.meshgrid(sigma, sigma, indexing="ij")
            bound = boxes.bound_at(i, j)
            assert np.all(np.isfinite(bound)) and np.all(bound <= exact * slack)
            exact = exact.min(axis=1)
        edges, steps = analysis.bound_steps(boxes, 0.005, 6.0)
        at = steps[np.searchsorted(edges, sigma) - 1]
        assert np.all(at > 0) and np.all(at <= exact * slack)
        for (low, high), found in zip(analysis.near_optimal(material, lobes, 0.01), material.fits[lobes].sigma):
            assert low <= found <= high and high / low < 1.5


@pytest.mark.skipif(browser.PROGRAM is None, reason="no Chromium here")
def test_in_a_browser(pages, tmp_path):
    chromium = browser.Browser(tmp_path / "profile")
    try:
        for page in sorted(pages.iterdir()):
            for width in (390, 1280):
                for dark in (False, True):
                    chromium.show(page.as_uri(), width, dark)
                    assert chromium.problems() == []
                    assert chromium.run("document.documentElement.scrollWidth <= window.innerWidth"), (page, width)
                    assert [u for u in chromium.requests() if not u.startswith("data:")] == [page.as_uri()]
    finally:
        chromium.close()
