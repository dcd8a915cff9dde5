"""brdffit-report: its pages, its exit codes, and what a browser says of them. SPDX-License-Identifier: MIT"""
import base64
import html
import os
import re
import shutil
import stat
import struct
import sys
import zlib

import numpy as np
import pytest

import brdffit
import browser
import harness
from brdffit import _lobes, report
from brdffit.report import _analysis as analysis
from brdffit.report import _page, _spheres
from brdffit.report import _proof as proof
from places import SOURCES

FILES = ("two_lobe_satin.csv", "ggx_metal.csv", "matte.csv", "two_lobe_table.binary")


@pytest.fixture(scope="session")
def pages(instruments, tmp_path_factory):
    folder = tmp_path_factory.mktemp("report")
    bad = tmp_path_factory.mktemp("bad") / "bad.csv"
    bad.write_text("theta_i,theta_o,r\n0,0,x\n")
    assert report.main(["-q", "-o", str(folder), "--lobes", "2", *(str(instruments / name) for name in FILES), str(bad)]) == 3
    long = bad.with_name("a-name-of-sixty-letters-without_a_place_to_break_it_is_as_bad.csv")
    long.write_bytes((instruments / FILES[0]).read_bytes())
    assert report.main(["-q", "-o", str(folder / "open"), "--lobes", "2", "--box-budget", "30", str(long),
                        str(instruments / FILES[0])]) == 4
    assert report.main(["-q", "-o", str(folder / "phong"), "--lobes", "2", "--distribution", "blinn-phong",
                        str(instruments / FILES[0])]) == 0
    assert report.main(["-q", "-o", str(folder / "mixed"), "--lobes", "ggx,blinn-phong", "--gap", "0.05",
                        *(str(instruments / name) for name in FILES[:2])]) == 0
    return folder


def every_page(pages):
    return sorted(pages.rglob("*.html"))


def test_pages_stand_alone(pages):
    names = sorted(p.name for p in pages.glob("*.html"))
    assert names == ["ggx_metal.html", "index.html", "matte.html", "two_lobe_satin.html", "two_lobe_table.html"]
    for page in every_page(pages):
        text = re.sub(r"data:image/png;base64,[\w+/=]*", "data:", page.read_text())
        assert not re.search(r"(?:src|href)='(?!data:|[\w.-]+\.html)", text) and "<script" not in text
        assert not re.search(r"\bnan\b", text, re.I)
    text = (pages / "two_lobe_satin.html").read_text()
    for words in ("Proven: no Beckmann fit with 2 lobes", "Proven: a model whose E² is within 1 % of the optimum has σ in [",
                  "Measured against fitted", "In the plane of incidence", "The proof", "Spheres", "lit from beyond 60°"):
        assert words in text
    assert (pages / "two_lobe_table.html").read_text().count("<img ") == 3
    assert "warning, lobe" in (pages / "matte.html").read_text().lower()
    assert "not proven to its gap" in (pages / "open" / "two_lobe_satin.html").read_text()
    assert re.search(r"within 1 % of the optimum has n in \[", (pages / "phong" / "two_lobe_satin.html").read_text())
    text = (pages / "mixed" / "two_lobe_satin.html").read_text()
    assert "fit of one GGX and one Blinn-Phong lobe with σ in [" in text and "in its Blinn-Phong lobe" in text
    assert "σ and n" in (pages / "mixed" / "index.html").read_text()


def test_index(pages):
    text = (pages / "index.html").read_text()
    assert "4 of 5 files fitted, 4 certified, 1 failed." in text
    assert re.search(r"bad\.csv</b>: line 2, field 3, sample 0, channel 0: the field is not a number", text)
    assert "2 of 2 files fitted, 0 certified, 2 open." in (pages / "open" / "index.html").read_text()
    for name in FILES:
        link = re.sub(r"\..*", ".html", name)
        assert "<a href='%s'>" % link in text and (pages / link).exists()


def test_names_are_escaped(tmp_path):
    samples = brdffit.Samples.example()
    text = report.page(samples, "<b>&", lobes=1)
    assert "<b>&<" not in text and "&lt;b&gt;&amp;" in text


def test_a_name_that_is_not_utf8_stops_nothing(instruments, tmp_path, capsys):
    odd = os.path.join(tmp_path, os.fsdecode(b"odd\xff.csv"))
    shutil.copy(instruments / "matte.csv", odd)
    files = [odd, odd.replace("odd", "absent"), str(instruments / "matte.csv")]
    assert report.main(["-q", "--lobes", "1", "-o", str(tmp_path / "out"), *files]) == 1
    assert sorted(p.name for p in (tmp_path / "out").iterdir()) == ["index.html", "matte.html", "odd_.html"]
    assert "odd\ufffd.csv" in (tmp_path / "out" / "odd_.html").read_text()
    assert "absent\ufffd.csv" in (tmp_path / "out" / "index.html").read_text()


def test_exit_codes(instruments, tmp_path, capsys):
    out = ["-q", "-o", str(tmp_path / "out")]
    good = str(instruments / FILES[0])
    assert report.main([*out, good, str(tmp_path / "absent.csv")]) == 1
    assert "absent.csv" in capsys.readouterr().err and "absent.csv" in (tmp_path / "out" / "index.html").read_text()
    with pytest.raises(SystemExit) as caught:
        report.main([*out, "--lobes", "4", good])
    assert caught.value.code == 2
    for wrong in (["--lobes", "ggx,phong"], ["--lobes", "ggx", "--distribution", "ward"], ["--lobes", "ggx,ggx,ggx,ggx"]):
        with pytest.raises(SystemExit) as caught:
            report.main([*out, *wrong, good])
        assert caught.value.code == 2


def test_one_page_that_fails_stops_nothing(instruments, tmp_path, monkeypatch, capsys):
    def broken(material, index):
        if material.name == "matte":
            raise ValueError("a mistake of ours")
        return drawn(material, index)

    drawn = report.material_page
    monkeypatch.setattr(report, "material_page", broken)
    files = [str(instruments / name) for name in ("two_lobe_satin.csv", "matte.csv", "ggx_metal.csv")]
    assert report.main(["-q", "--lobes", "1", "-o", str(tmp_path), *files]) == 1
    assert sorted(p.name for p in tmp_path.iterdir()) == ["ggx_metal.html", "index.html", "two_lobe_satin.html"]
    assert "a mistake of ours" in capsys.readouterr().err and "a mistake of ours" in (tmp_path / "index.html").read_text()


def test_the_command_line_finds_it(instruments, tmp_path):
    script = tmp_path / "brdffit-report"
    script.write_text("#!%s\nimport sys\nfrom brdffit.report import main\nsys.exit(main())\n" % sys.executable)
    script.chmod(script.stat().st_mode | stat.S_IXUSR)
    environment = harness.environment(PATH="%s:%s" % (tmp_path, os.environ["PATH"]), PYTHONPATH=str(SOURCES))
    done = harness.run("report", "-o", tmp_path / "out", instruments / FILES[0], env=environment)
    assert done.returncode == 0 and (tmp_path / "out" / "two_lobe_satin.html").exists(), done.stderr
    done = harness.run("help", "report", env=environment)
    assert done.returncode == 0 and "usage: brdffit report" in done.stdout
    for arguments in (("report", "x.csv"), ("help", "report")):
        done = harness.run(*arguments, env=harness.environment(PATH=str(tmp_path / "out")))
        assert done.returncode == 2 and "pip install ./python" in done.stderr


# ---- What the pages claim ------------------------------------------------------


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
        edges, steps = analysis.bound_steps(boxes, material.leaves[lobes], 0.005, 6.0)
        at = steps[np.searchsorted(edges, sigma) - 1]
        assert np.all(at > 0) and np.all(at <= exact * slack)


@pytest.mark.parametrize("names", (["beckmann"] * 3, ["ggx", "blinn-phong"], ["beckmann", "ggx"], ["ward", "ggx", "ward"]),
                         ids=",".join)
def test_bounds_stay_below_the_curve_of_lists(names):
    """An axis a lobe; the profile of a distribution is over one of its lobes, and every model of 1 % is in the intervals."""
    material = analysis.measure("satin", brdffit.Samples.example(), {"relative_gap": 0.05}, names)
    count, slack = len(names), 1 + 1e-9
    fit, boxes = material.main, material.boxes[count]
    grids, at_fit = [], []
    for p in range(count):
        grid = np.unique(np.concatenate([np.geomspace(0.02, 2.9, 14), fit.sigma]))
        grids.append(grid)
        at_fit.append(int(np.searchsorted(grid, fit.sigma[p])))
    exact = analysis.objective(material, grids, count)
    assert exact.shape == tuple(map(len, grids))
    assert exact[tuple(at_fit)] == pytest.approx(fit.e2, rel=1e-6)
    assert exact.min() * slack >= fit.lower_bound
    bound = boxes.bound_at(*np.meshgrid(*grids, indexing="ij"))
    assert np.all(np.isfinite(bound)) and np.all(bound <= exact * slack)
    for p in range(count):
        same = analysis.same_kind(fit, p)
        assert fit.distributions[p] == fit.distributions[same.start]
        edges, steps = analysis.bound_steps(boxes, material.leaves[count], 0.01, 2.95, same)
        alone = exact.min(axis=tuple(q for q in range(count) if q != p))
        assert np.all(steps[np.searchsorted(edges, grids[p]) - 1] <= alone * slack)
    share, intervals = material.near[count]
    places = np.stack([grids[p][index] for p, index in enumerate(np.argwhere(exact <= (1 + share) * fit.lower_bound).T)], 1)
    for _, same in _lobes.kinds(fit.distributions):
        places[:, same].sort(axis=1)
    for p, (low, high) in enumerate(intervals):
        assert low <= fit.sigma[p] <= high
        assert len(places) == 0 or low <= places[:, p].min() and places[:, p].max() <= high
    # A page has a profile for each distribution, and words for each lobe.
    text = _page.material_page(material, None)
    page = html.unescape(text)
    kinds = len(set(names))
    assert len(proof.profiles(material, count)) == kinds
    for words in (fit.certificate, *([] if kinds == 1 else [_lobes.title(name) for name in names])):
        assert words in page
    assert ("Map of the boxes" in page) == (count == 2)
    assert not re.search(r"\b(nan|inf)\b", re.sub(r"base64,[\w+/=]*", "", text), re.I)


@pytest.mark.parametrize("distribution", ("beckmann", "ggx", "blinn-phong"))
def test_near_optimal_models_are_inside(distribution):
    """Every model within 1 % of the optimum that a fine grid finds has its roughness in the intervals."""
    material = analysis.measure("satin", brdffit.Samples.example(), {"distribution": distribution}, 2)
    for lobes in (1, 2):
        fit = material.fits[lobes]
        share, intervals = material.near[lobes]
        assert share == 0.01
        sigma = np.unique(np.concatenate([f * np.geomspace(0.8, 1.25, 120) for f in fit.sigma]))
        good = analysis.objective(material, sigma, lobes) <= (1 + share) * fit.lower_bound
        places = sigma[np.argwhere(good)]
        assert len(places) > 3  # or nothing was tried
        places.sort(axis=1)
        for p, (low, high) in enumerate(intervals):
            assert low <= places[:, p].min() and places[:, p].max() <= high
            # The data are of two Beckmann lobes: others they hardly tell.
            assert high / low < 1.5 if lobes == 1 else high / low < 1.1 or distribution != "beckmann"


@pytest.mark.parametrize("lobes", (1, 2))
def test_leaves_tile_the_range(lobes):
    """Random roughness lies in one box that was not split, and in one only."""
    material = analysis.measure("satin", brdffit.Samples.example(), {"relative_gap": 1e-4}, lobes)
    boxes, leaves = material.boxes[lobes], material.leaves[lobes]
    points = np.sort(np.exp(np.random.default_rng(3).uniform(np.log(1e-3), np.log(6), (500, lobes))), axis=1)
    inside = np.all((boxes.sigma_low[leaves] <= points[:, None]) & (points[:, None] <= boxes.sigma_high[leaves]), -1)
    assert np.all(inside.sum(1) == 1)


def test_a_large_table_is_summed_in_parts(monkeypatch):
    """Parts of which nothing is used too: the light beyond 60 degrees is sorted to the end."""
    example = brdffit.Samples.example()
    order = np.argsort(-example.light[:, 2], kind="stable")
    samples = brdffit.Samples.from_arrays(example.light[order], example.view[order], example.values[order],
                                          weights=np.linspace(0.5, 2, len(order)))
    material = analysis.measure("satin", samples, {}, 1)
    sigma = np.geomspace(0.05, 1, 20)
    whole = analysis.objective(material, sigma, 1)
    assert np.interp(material.fits[1].sigma, sigma, whole) >= material.fits[1].e2
    monkeypatch.setattr(analysis, "LARGE", 40)
    np.testing.assert_allclose(analysis.objective(material, sigma, 1), whole, rtol=1e-12)


def test_reasons_are_the_librarys():
    rng = np.random.default_rng(5)
    light, view = rng.standard_normal((2, 400, 3))
    light[:, 2] = np.abs(light[:, 2]) * np.where(rng.random(400) < 0.9, 1, -1)
    samples = brdffit.Samples.from_arrays(light, view, rng.random((400, 3)) + 1, weights=rng.integers(0, 4, 400).astype(float))
    fit = brdffit.fit(samples)
    reason = analysis.places(samples, 60.0).reason
    assert int(np.sum(reason == "")) == fit.samples_used
    for name in ("zero_weight", "light_below_horizon", "view_below_horizon", "incidence"):
        assert int(np.sum(reason == name)) == fit.samples_skipped[name] > 0
    text = _page.material_page(analysis.measure("random", samples, {}, 1), None)
    assert "skipped: of weight 0" in text and "The first 200 of %d skipped samples" % np.sum(reason != "") in text


@pytest.mark.parametrize("samples", (
    brdffit.Samples.from_arrays([[0, 0, 1.0]], [[0, 0, 1.0]], [[0.3]]),
    brdffit.Samples.from_arrays(*brdffit.protocol84(), np.zeros((84, 3))),
    brdffit.Samples.from_arrays(*brdffit.protocol84(), np.full((84, 31), 0.2) - 0.001 * np.arange(84)[:, None] * np.arange(31)),
    brdffit.Samples.from_coefficients(np.ones(9), np.ones(9), np.linspace(0, 2, 9), np.exp(-np.linspace(0, 20, 9))),
    brdffit.Samples.from_arrays([[0, 0.01, 1.0]] * 6, [[0, 0, 1.0]] * 6, np.arange(6.0) * 1e-300, channels=["mwir"]),
), ids=("one", "black", "spectral", "coefficients", "tiny"))
@pytest.mark.parametrize("lobes", (1, 2, ["ggx", "blinn-phong"]))
def test_odd_materials_get_a_page(samples, lobes):
    try:
        brdffit.fit(samples, lobes=lobes)
    except brdffit.BrdffitError:
        pytest.skip("the library refuses these samples")
    text = report.page(samples, "odd", lobes=lobes)
    assert not re.search(r"\b(nan|inf)\b", re.sub(r"base64,[\w+/=]*", "", text), re.I)


def test_scattered_directions_are_not_drawn_as_lines(instruments):
    """Of samples all over the hemisphere: fitted against measured; of a table of such, its own look-ups."""
    rng = np.random.default_rng(8)
    light, view = rng.standard_normal((2, 500, 3)) + [0, 0, 4]
    scattered = brdffit.Samples.from_arrays(light, view, 0.1 + rng.random((500, 3)))
    material = analysis.measure("scattered", scattered, {}, 1)
    assert analysis.series(material.views) == []
    assert "Fitted over measured radiance" in _page.material_page(material, None)
    table = brdffit.Samples.from_merl(instruments / "two_lobe_table.binary", samples=(light, view))
    material = analysis.measure("table", table, {}, 1)
    assert material.views is not table and len(analysis.series(material.views)) == 4
    assert "dots: the measured table" in _page.material_page(material, None)


# ---- Spheres, computed again by other means --------------------------------------


def unpack(uri):
    """Pixels of a PNG of ours: 8 bits, RGBA, no filter."""
    data = base64.b64decode(uri.partition(",")[2])
    place, body, size = 8, b"", None
    while place < len(data):
        length, kind = struct.unpack(">I4s", data[place:place + 8])
        chunk = data[place + 8:place + 8 + length]
        size = struct.unpack(">II", chunk[:8]) if kind == b"IHDR" else size
        body += chunk if kind == b"IDAT" else b""
        place += 12 + length
    return np.frombuffer(zlib.decompress(body), np.uint8).reshape(size[1], 1 + 4 * size[0])[:, 1:].reshape(size[1], size[0], 4)


def rotation(axis, angle):
    x, y, z = axis
    k = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * k + (1 - np.cos(angle)) * k @ k


def look_up(planes, light, view, normal):
    """One cell as the database's own reader finds it: rotate by -phi_h about the normal, then by -theta_h."""
    up = np.array([0.0, 0.0, 1.0])
    axis = np.cross(normal, up)
    length = np.linalg.norm(axis)
    upright = np.eye(3) if length < 1e-12 else rotation(axis / length, np.arctan2(length, normal @ up))
    light, view = upright @ light, upright @ view
    half = (light + view) / np.linalg.norm(light + view)
    theta_h, phi_h = np.arccos(min(half[2], 1)), np.arctan2(half[1], half[0])
    difference = rotation(np.array([0.0, 1, 0]), -theta_h) @ rotation(up, -phi_h) @ light
    theta_d, phi_d = np.arccos(min(difference[2], 1)), np.arctan2(difference[1], difference[0]) % np.pi
    n_h, n_d, n_p = planes.shape[1:]
    cell = (int(np.sqrt(theta_h / (np.pi / 2)) * n_h), int(theta_d / (np.pi / 2) * n_d), int(phi_d / np.pi * n_p))
    return planes[(slice(None), *np.minimum(cell, [n_h - 1, n_d - 1, n_p - 1]))]


def test_spheres_against_plain_code(instruments):
    """Measured: the file's bytes through a lookup by rotations. Fitted: the paper's formula. Both through the stated
    exposure, no other factor: the pixels agree to a level of 255."""
    path = instruments / "two_lobe_table.binary"
    samples = brdffit.Samples.from_merl(path, samples="84")
    material = analysis.measure("table", samples, {}, 2)
    rendered = _spheres.render(material)
    measured, fitted, difference = (unpack(uri).astype(float) for uri, _ in rendered.pictures)
    raw = path.read_bytes()
    dims = np.frombuffer(raw, "<i4", 3)
    planes = np.frombuffer(raw, "<f8", offset=12).reshape(3, *dims) * (np.array([1, 1.15, 1.66]) / 1500)[:, None, None, None]
    light, view, fit = _spheres.LIGHT, np.array([0.0, 0, 1]), material.main
    rng, size = np.random.default_rng(11), len(measured)
    off, sums, known = [], np.zeros((2, 3)), 0
    for row, column in rng.integers(0, size, (1500, 2)):
        x, y = ((column + 0.5) / size * 2.06 - 1.03), -((row + 0.5) / size * 2.06 - 1.03)
        if x * x + y * y >= 1:
            assert measured[row, column, 3] == 0
            continue
        normal = np.array([x, y, np.sqrt(1 - x * x - y * y)])
        cosine = normal @ light
        if cosine <= 0:
            assert not measured[row, column, :3].any() and not fitted[row, column, :3].any()
            continue
        half = (light + view) / np.linalg.norm(light + view)
        nh, nv = normal @ half, normal @ view
        tan2 = 1 / nh**2 - 1
        shadow = min(1, 2 * nh * nv / (view @ half), 2 * nh * cosine / (view @ half))
        lobes = np.exp(-tan2 / fit.sigma**2) / fit.sigma**2 * shadow / (np.pi * nv * nh**4)
        model = fit.x * cosine / np.pi + fit.y @ lobes
        table = look_up(planes, light, view, normal) * cosine
        if (table < 0).any():  # not measured: violet
            assert measured[row, column, 2] > measured[row, column, 0] > measured[row, column, 1]
            continue
        known, sums = known + 1, sums + [table, model]
        for picture, value in ((measured, table), (fitted, model)):
            want = 255 * np.clip(value * rendered.exposure, 0, 1) ** (1 / 2.2)
            off.append(np.abs(picture[row, column, :3] - want).max())
        want = 255 * np.clip(0.5 + 2 * (model - table) * rendered.exposure, 0, 1)
        off.append(np.abs(difference[row, column, :3] - want).max())
    off = np.array(off)
    # Rounding may choose the other one of two cells at a border.
    assert known > 800 and np.mean(off > 0.51) < 0.005, (known, np.mean(off > 0.51))
    # The words: ratios of means over the whole sphere, here over a part of its pixels.
    said = [1 + float(s) / 100 for s in re.findall(r"([+-][\d.e+-]+) %", rendered.words[0])]
    assert len(said) == 3 and np.allclose(said, sums[1] / sums[0], atol=0.01)


# ---- In a browser -----------------------------------------------------------------

# Texts that stick out of their figure, and elements that stick out of the page.
CUT = """[...document.querySelectorAll('svg text')].filter(t => { if (!t.checkVisibility()) return false;
const a = t.getBoundingClientRect(), b = t.closest('figure').getBoundingClientRect();
return a.left < b.left - 1 || a.right > b.right + 1 || a.top < b.top - 1 || a.bottom > b.bottom + 1 }).map(t => t.textContent)"""
WIDE = """[...document.querySelectorAll('body *')].filter(e => e instanceof HTMLElement && e.checkVisibility() &&
!e.closest('.scroll') && e.getBoundingClientRect().right > document.documentElement.clientWidth + 1)
.map(e => e.tagName + ' ' + e.className)"""
# Tables of which a part hides behind a scroll bar.
HIDDEN = """[...document.querySelectorAll('.scroll')].filter(e => e.checkVisibility()
&& e.scrollWidth > e.clientWidth + 1).length"""
# Luminance of paper and ink, 0 to 255.
INK = """['backgroundColor', 'color'].map(p => getComputedStyle(document.body)[p].match(/\\d+/g).slice(0, 3)
.reduce((a, b) => a + b / 3, 0))"""


@pytest.mark.skipif(browser.PROGRAM is None, reason="no Chromium here: sh tools/setup/deps.sh install browser")
def test_in_a_browser(pages, tmp_path):
    chromium = browser.Browser(tmp_path / "profile")
    try:
        for page in every_page(pages):
            # 718: A4 with margins of 10 mm.
            for width, dark, media in (*((w, d, "") for w in (390, 1280) for d in (False, True)), (718, True, "print")):
                chromium.show(page.as_uri(), width, dark, media)
                where = (page.name, width, dark, media)
                assert chromium.problems() == []
                assert chromium.run("document.documentElement.scrollWidth <= window.innerWidth"), where
                assert chromium.run(WIDE) == [] and chromium.run(CUT) == [] and chromium.run(HIDDEN) == 0, where
                paper, ink = chromium.run(INK)
                assert (paper < 60 and ink > 180) if dark and not media else (paper > 240 and ink < 60), where
                assert [u for u in chromium.requests() if not u.startswith("data:")] == [page.as_uri()]
            assert chromium.run("[...document.images].every(i => i.complete && i.naturalWidth > 0)")
            assert chromium.print().startswith(b"%PDF-")
    finally:
        chromium.close()
