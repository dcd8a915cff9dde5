"""The JSON contract: every line valid, complete, and true of its file.

SPDX-License-Identifier: MIT
"""
import gzip
import json
import shutil

import numpy as np
import pytest

import harness
import model

REQUIRED = {
    "schema": str, "file": str, "status": str, "distributions": list, "norm": str, "lobes": int, "sigma": list, "x": list,
    "y": list, "channel_scale": list, "e2": (int, float), "objective": (int, float), "lower_bound": (int, float),
    "gap": (int, float), "rms": list,
    "samples_used": int, "samples_skipped": dict, "boxes": int, "nodes": int, "seconds": dict,
}
SKIPS = {"zero_weight", "light_below_horizon", "view_below_horizon", "incidence", "masked", "absent", "cell_below_horizon",
         "saturated"}


def check_exponents(line):
    """n and sigma = 1/sqrt(n) say the same; lobes by sigma have no n."""
    by_n = [p for p, name in enumerate(line["distributions"]) if name in model.EXPONENTS]
    if not by_n:
        assert not {"exponent", "exponent_interval", "exponent_range"} & set(line)
        return
    for p in range(line["lobes"]):
        if p not in by_n:
            assert line["exponent"][p] is None and line["exponent_interval"][p] is None
            continue
        n, (low, high) = line["exponent"][p], line["exponent_interval"][p]
        assert low == n <= high
        assert n * line["sigma"][p] ** 2 == pytest.approx(1, rel=1e-14)
        assert np.allclose(np.array([high, low]) * np.array(line["sigma_interval"][p]) ** 2, 1, rtol=1e-14)
    if len(by_n) == line["lobes"]:
        assert np.allclose(np.array(line["exponent_range"])[::-1] * np.array(line["sigma_range"]) ** 2, 1, rtol=1e-14)


def check_order(line):
    """Lobes of one distribution stand together, ascending, each within the range of its parameter."""
    names, sigma = line["distributions"], line["sigma"]
    assert names == sorted(names, key=names.index)
    assert line["distribution"] == (names[0] if len(set(names)) == 1 else None)
    for p, name in enumerate(names):
        assert p == 0 or names[p - 1] != name or sigma[p - 1] <= sigma[p]
        value, (low, high) = (line["exponent"][p], line["exponent_range"]) if name in model.EXPONENTS else (
            sigma[p], line["sigma_range"])
        assert low <= value <= high


def check_contract(line, lobes):
    for name, kind in REQUIRED.items():
        assert isinstance(line[name], kind), name
    channels = len(line["channels"])
    assert line["schema"] == "brdffit.fit/1"
    assert line["lobes"] == len(line["distributions"]) == lobes
    assert line["norm"] in ("l2", "l1", "linf")
    assert line["objective"] == line["e2"]
    for name in ("sigma", "weight", "effective_samples", "sigma_interval", "warnings"):
        assert len(line[name]) == lobes, name
    for name in ("x", "y", "channel_scale", "rms"):
        assert len(line[name]) == channels, name
    assert all(len(row) == lobes for row in line["y"])
    check_order(line)
    assert all(low <= s <= high for s, (low, high) in zip(line["sigma"], line["sigma_interval"]))
    check_exponents(line)
    assert min(line["x"]) >= 0 and min(min(row) for row in line["y"]) >= 0
    assert line["e2"] >= line["lower_bound"] >= 0
    assert line["gap"] == pytest.approx(line["e2"] - line["lower_bound"], rel=1e-12, abs=1e-300)
    assert set(line["samples_skipped"]) == SKIPS
    assert set(line["seconds"]) == {"read", "reduce", "search"} and min(line["seconds"].values()) >= 0
    assert line["boxes"] >= 1 and line["nodes"] >= 1
    assert (line["status"] == "certified") == (line["stop"] in ("relative_gap", "absolute_gap"))
    if line["stop"] == "relative_gap":
        assert line["e2"] <= (1 + line["relative_gap"]) * line["lower_bound"] * (1 + 1e-12)
    weights = np.array(line["y"]).sum(0)
    if weights.sum() > 0:
        assert np.allclose(line["weight"], weights / weights.sum(), rtol=1e-12, atol=1e-300)


FILES = ["two_lobe_satin.csv", "two_lobe_exact.csv", "ggx_metal.csv", "matte.csv", "two_lobe_outliers.csv", "mis.csv",
         "mixed.csv", "single.csv", "zero.csv", "vectors.csv", "two_lobe_table.binary"]


@pytest.mark.parametrize("norm", ["l1", "linf"])
@pytest.mark.parametrize("name", [name for name in FILES if not name.endswith(".binary")])
def test_every_line_of_a_norm_is_true(desk, name, norm):
    if not harness.has_ecos():
        pytest.skip("this build is without ECOS")
    for options in (["--lobes", "1", "--distribution", "ggx"], ["--lobes", "2", "--gap", "0.01"]):
        (line,) = harness.fit(name, "--norm", norm, *options, cwd=desk)
        check_contract(line, int(options[1]))
        assert line["status"] == "certified" and line["norm"] == norm
        model.check_line(line, desk / name)


# In-plane steps of 10 degrees: some samples are 90 degrees off the mirror direction, but for rounding. At an exponent of 0.1
# a Lafortune lobe of 1e-16 is 0.025 there, or 0: the bound allows for both, and does not close.
RIGHT_ANGLES = ["matte.csv", "two_lobe_outliers.csv"]


def test_a_lobe_that_rounding_decides(desk):
    (line,) = harness.fit("matte.csv", "--distribution", "lafortune", "--box-budget", "20000", expect=4, cwd=desk)
    check_contract(line, 1)
    assert line["status"] != "certified" and line["stop"] in ("budget", "rounding")
    assert 0.8 * line["e2"] < line["lower_bound"] < line["e2"]


@pytest.mark.parametrize("lobes", [1, 2])
@pytest.mark.parametrize("distribution", model.DISTRIBUTIONS)
@pytest.mark.parametrize("name", FILES)
def test_every_line_is_true(desk, name, distribution, lobes):
    more = ["--exponent-min", "0.5"] if distribution == "lafortune" and name in RIGHT_ANGLES else []
    (line,) = harness.fit(name, "--lobes", str(lobes), "--distribution", distribution, *more, cwd=desk)
    check_contract(line, lobes)
    assert line["status"] == "certified"
    assert line["distribution"] == distribution
    samples = model.check_line(line, desk / name)
    total = line["samples_used"] + sum(line["samples_skipped"].values())
    assert total == (13500 if name.endswith(".binary") else samples.total)


LISTS = ["ggx,blinn-phong", "beckmann,ggx", "blinn-phong,ward,blinn-phong", "ashikhmin-shirley,torrance-sparrow", "ggx,ggx,ggx"]


@pytest.mark.parametrize("names", LISTS)
@pytest.mark.parametrize("name", ["two_lobe_satin.csv", "matte.csv", "mixed.csv", "vectors.csv", "two_lobe_table.binary"])
def test_every_line_of_a_list_is_true(desk, name, names):
    (line,) = harness.fit(name, "--lobes", names, "--gap", "0.05", cwd=desk)
    given = names.split(",")
    check_contract(line, len(given))
    assert line["status"] == "certified"
    assert line["distributions"] == sorted(given, key=given.index)
    model.check_line(line, desk / name)


@pytest.mark.parametrize("engine", [["--norm", "l1"], ["--norm", "linf"], ["--engine", "socp"]], ids=" ".join)
def test_every_line_of_a_list_is_true_otherwise(desk, engine):
    if not harness.has_ecos():
        pytest.skip("this build is without ECOS")
    for names in ("ggx,blinn-phong", "ward,beckmann"):
        (line,) = harness.fit("mixed.csv", "--lobes", names, "--gap", "0.1", *engine, cwd=desk)
        check_contract(line, 2)
        assert line["status"] == "certified"
        model.check_line(line, desk / "mixed.csv")


@pytest.mark.parametrize("options", [
    ["--normalise", "none"], ["--max-incidence", "off"], ["--max-incidence", "35"], ["--values", "radiance"],
    ["--sigma-min", "0.3", "--sigma-max", "1"], ["--gap", "1e-6"], ["--gap", "0.5", "--normalize", "max"],
    ["--box-budget", "1"], ["--resolution", "10"],
])
def test_options_are_recorded(desk, options):
    done = harness.run("fit", "--json", "--lobes", "2", "two_lobe_satin.csv", *options, cwd=desk)
    assert done.returncode in (0, 4)
    (line,) = harness.lines(done.stdout)
    check_contract(line, 2)
    assert line["status"] == ("certified" if done.returncode == 0 else "gap_open")
    model.check_line(line, desk / "two_lobe_satin.csv")
    for option, value in zip(options[::2], options[1::2]):
        recorded = {
            "--normalise": line["normalise"], "--normalize": line["normalise"], "--max-incidence": line["max_incidence"],
            "--values": line["quantity"], "--sigma-min": line["sigma_range"][0], "--sigma-max": line["sigma_range"][1],
            "--gap": line["relative_gap"], "--box-budget": line["box_budget"], "--resolution": line["sigma_resolution"],
        }[option]
        assert str(recorded) == value or recorded == (90 if value == "off" else float(value))


def test_exponent_options_are_recorded(desk):
    (line,) = harness.fit("two_lobe_satin.csv", "--distribution", "blinn-phong", "--exponent-min", "3", "--exponent-max=7.5",
                          cwd=desk)
    check_contract(line, 1)
    assert line["exponent_range"] == [3, 7.5] and line["exponent"] == [7.5] and line["warnings"] == [["at_limit"]]
    model.check_line(line, desk / "two_lobe_satin.csv")


@pytest.mark.parametrize("bins", ["edge", "centre"])
def test_merl_bins(desk, bins):
    (line,) = harness.fit("two_lobe_table.binary", "--merl-bins", bins, cwd=desk)
    assert (line["format"], line["merl_bins"], line["merl_samples"]) == ("merl", bins, "table")
    model.check_line(line, desk / "two_lobe_table.binary")


def test_merl_protocol(desk):
    (line,) = harness.fit("two_lobe_table.binary", "--merl-samples", "84", cwd=desk)
    assert line["merl_samples"] == "84"
    assert line["samples_used"] + sum(line["samples_skipped"].values()) == 84


def test_gzip_is_the_same(desk):
    with open(desk / "two_lobe_satin.csv", "rb") as plain, gzip.open(desk / "packed.csv.gz", "wb") as packed:
        shutil.copyfileobj(plain, packed)
    one, two = harness.fit("two_lobe_satin.csv", "packed.csv.gz", cwd=desk)
    for name in ("file", "seconds"):
        del one[name], two[name]
    assert one == two


def test_digits_survive(desk):
    """17 digits: reading the numbers back and writing them again changes nothing."""
    done = harness.run("fit", "--json", "--lobes", "2", "mis.csv", cwd=desk)
    (line,) = harness.lines(done.stdout)
    for value in [*line["sigma"], *line["x"], line["e2"], line["lower_bound"], *line["rms"]]:
        assert "%.17g" % value in done.stdout


def test_the_locale_does_not_matter(desk):
    plain = harness.fit("mis.csv", cwd=desk)
    for locale in ("C", "de_DE.UTF-8", "tr_TR.UTF-8"):
        other = harness.fit("mis.csv", cwd=desk, env=harness.environment(LC_ALL=locale, LC_NUMERIC=locale))
        assert [dict(line, seconds=0) for line in other] == [dict(line, seconds=0) for line in plain]


@pytest.mark.parametrize("name, code, exit_code, place", [
    ("infinite.csv", "value", 3, {"line": 3, "column": 6, "sample": 1, "channel": 1, "value": "inf"}),
    ("words.csv", "value", 3, {"line": 3, "column": 6, "sample": 1, "channel": 1}),
    ("ragged.csv", "format", 3, {"line": 3}),
    ("header.csv", "no_samples", 3, {}),
    ("empty.csv", "format", 3, {}),
    ("grazing.csv", "no_samples", 3, {}),
    ("lying.binary", "format", 3, {}),
    ("truncated.csv.gz", "read", 1, {}),
    ("missing.csv", "open", 1, {}),
])
def test_errors(desk, name, code, exit_code, place):
    (line,) = harness.fit(name, cwd=desk, expect=exit_code)
    assert (line["schema"], line["file"], line["status"]) == ("brdffit.fit/1", name, "error")
    assert line["error"]["code"] == code
    assert line["error"]["message"]
    for key, value in place.items():
        assert line["error"][key] == value, key
    assert not {"sigma", "e2", "x"} & set(line)


@pytest.mark.parametrize("text, value", [("inf", "inf"), ("-inf", "-inf"), ("1e999", "inf")])
def test_values_that_are_no_numbers(tmp_path, text, value):
    (tmp_path / "bad.csv").write_text("theta_i,theta_o,r\n0,0,1\n10,0,%s\n" % text)
    (line,) = harness.fit("bad.csv", cwd=tmp_path, expect=3)
    assert line["error"]["line"] == 3
    assert line["error"].get("value", value) == value


@pytest.mark.parametrize("name", [b'quo"te\\slash.csv', "täble σ.csv".encode(), b"tab\tline\n.csv", b"\xff\xfe.csv",
                                  b"\xed\xa0\x80.csv", b"esc\x1b[31m.csv"])
def test_names_of_files(instruments, tmp_path, name):
    path = tmp_path.joinpath("x").parent.__fspath__().encode() + b"/" + name
    shutil.copy(instruments / "matte.csv", path)
    for arguments in ((), ("--lobes", "2")):
        (line,) = harness.fit(name, *arguments, cwd=tmp_path)
        try:
            assert line["file"] == name.decode()
            assert "file_bytes" not in line
        except UnicodeDecodeError:
            assert "\ufffd" in line["file"]
            assert bytes.fromhex(line["file_bytes"]) == name
    report = harness.run("fit", name, cwd=tmp_path)
    assert report.returncode == 0
    assert "\x1b" not in report.stdout
    saved = tmp_path / "fit.json"
    saved.write_text(json.dumps(line))
    again = harness.run("eval", "fit.json", name, cwd=tmp_path)
    assert again.returncode == 0, again.stderr


def test_names_of_channels(tmp_path):
    (tmp_path / "odd.csv").write_text('theta_i,theta_o,"a ""quoted"" name",naïve,\\slash\n'
                                      '0,0,1,2,3\n20,0,0.5,1,1\n40,0,0.2,0.9,1\n',
                                      encoding="utf-8")
    (line,) = harness.fit("odd.csv", cwd=tmp_path)
    assert line["channels"] == ['a "quoted" name', "naïve", "\\slash"]


def test_info(desk):
    done = harness.run("info", "--json", "two_lobe_satin.csv", "ragged.csv", "two_lobe_table.binary", "mixed.csv", "mis.csv",
                       cwd=desk)
    assert done.returncode == 3
    satin, ragged, table, mixed, abc = harness.lines(done.stdout)
    assert ragged["status"] == "error" and ragged["error"]["line"] == 3
    header, rows = model.read_text(desk / "two_lobe_satin.csv")
    assert satin["channels"] == header[4:]
    assert np.allclose(satin["minimum"], rows[:, 4:].min(0), rtol=1e-15)
    assert np.allclose(satin["maximum"], rows[:, 4:].max(0), rtol=1e-15)
    assert np.allclose(satin["mean"], rows[:, 4:].mean(0), rtol=1e-13)
    samples = model.Samples(desk / "two_lobe_satin.csv", "brdf")
    assert satin["samples_used"] == samples.used and satin["rows"] == samples.total
    half = np.degrees(np.arctan(np.sqrt(samples.c)))
    assert satin["half_angle_range"] == pytest.approx([half.min(), half.max()], abs=1e-6)
    assert satin["distinct_half_angles"] == len(np.unique(half.round(6)))
    assert satin["resolved_sigma"] == pytest.approx(np.tan(np.radians(np.unique(half.round(9))[2])), rel=1e-6)
    assert satin["incidence_range"] == pytest.approx([0, 60], abs=1e-6)
    assert table["dims"] == [30, 15, 30] and table["rows"] == 13500
    assert table["samples_used"] + sum(table["samples_skipped"].values()) == 13500
    assert mixed["samples_skipped"] == {"zero_weight": 1, "light_below_horizon": 1, "view_below_horizon": 1, "incidence": 1,
                                        "masked": 0, "absent": 1, "cell_below_horizon": 0, "saturated": 0}
    assert mixed["negative"] == [1]
    assert (abc["form"], abc["quantity"], abc["incidence_range"]) == ("coefficients", "radiance", None)
    fitted = harness.run("fit", "--json", "two_lobe_satin.csv", "two_lobe_table.binary", "mixed.csv", "mis.csv", cwd=desk)
    for line, told in zip(harness.lines(fitted.stdout), (satin, table, mixed, abc)):
        for name in ("samples_used", "samples_skipped", "channels", "quantity", "format", "max_incidence"):
            assert line[name] == told[name]


def test_engine_and_verify_are_told(desk):
    """Which engine, what ECOS did, and what was proven again; null where it was not asked for."""
    if not harness.has_ecos():
        pytest.skip("this build is without ECOS")
    name = "two_lobe_satin.csv"
    moment, = harness.fit(name, cwd=desk)
    assert (moment["engine"], moment["socp"], moment["verify"]) == ("moment", None, None)
    socp, = harness.fit("--engine", "socp", "--verify", "socp=0.01", name, cwd=desk)
    assert socp["engine"] == "socp" and set(socp["socp"]) == {"solved", "refused", "decided"}
    assert socp["socp"]["solved"] + socp["socp"]["decided"] == socp["boxes"]
    assert socp["e2"] == pytest.approx(moment["e2"], rel=1e-6)
    verify = socp["verify"]
    assert verify["engine"] == "socp" and verify["proven"] is True and verify["stop"] is None
    assert verify["level"] == pytest.approx(0.99 * socp["lower_bound"], rel=1e-12)
    every, = harness.fit("--engine", "socp", "--socp-every-box", "--gap", "0.01", name, cwd=desk)
    assert every["socp"]["decided"] == 0 and every["socp"]["solved"] == every["boxes"]
    # No level at the bound itself can be had for a few boxes: open, and how much is left.
    opened, = harness.fit("--verify", "socp=0", "--gap", "1e-6", "--box-budget", "200", name, cwd=desk, expect=4)
    assert opened["verify"]["proven"] is False and opened["verify"]["stop"] == "budget"
    assert 0 < opened["verify"]["unproven"] < 1
