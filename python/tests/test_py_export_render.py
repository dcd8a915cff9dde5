"""Exports in the programs that they are for: Mitsuba evaluates and draws, MaterialX and USD read and validate.

    pip install -r python/tests/requirements-renderers.txt

Each test is skipped, with a word, where its package is missing. Cycles: test_py_export_cycles.py. SPDX-License-Identifier: MIT
"""
import re
import shutil
import subprocess

import numpy as np
import pytest

import brdffit
from places import ROOT
from test_py_export import apart, by_materialx, measured, model, pairs

SINGLE = 1e-5  # relative RMS that single precision makes; Beckmann's exponential magnifies it, test_py_mitsuba.py says how


@pytest.fixture(scope="module")
def mi():
    mitsuba = pytest.importorskip("mitsuba")
    mitsuba.set_variant("scalar_rgb")
    return mitsuba


def bsdf(mi, path):
    """The one of an exported scene."""
    assert mi.load_file(str(path)) is not None
    text = re.search(r"<bsdf.*</bsdf>", path.read_text(), re.DOTALL)[0]
    return mi.load_string(text.replace("<bsdf", '<bsdf version="3.0.0"', 1))


def evaluated(mi, one, light, view):
    context, at, out = mi.BSDFContext(), mi.SurfaceInteraction3f(), []
    for l, v in zip(light, view):
        at.wi = mi.Vector3f(*v)
        out.append(np.array(one.eval(context, at, mi.Vector3f(*l)), float))
    return np.array(out)


@pytest.mark.parametrize(("members", "exact"), [
    ({"masking": "smith-separable"}, True), ({"masking": "smith-separable", "f0": (0.9, 0.7, 0.4)}, True),
    ({"masking": "smith-separable", "sigma": (0.1, 0.4)}, True),
    ({"masking": "smith-separable", "distribution": "beckmann"}, False), ({"f0": (0.05, 0.04, 0.03)}, False),
    ({"distribution": "ward", "masking": "v-cavity"}, False)])
def test_mitsuba_is_what_was_judged(mi, members, exact, tmp_path):
    """And the fit itself where the model is the same; Beckmann but for Mitsuba's own approximation of masking."""
    fit, light, view = model(**members), *pairs()
    made = fit.export("mitsuba", tmp_path / "one.xml", samples=None if exact else measured(fit), scene=True)
    theirs = evaluated(mi, bsdf(mi, tmp_path / "one.xml"), light, view)
    assert apart(theirs, made.shown.values(light, view)) < (4 if "beckmann" in members.values() else 1) * SINGLE
    assert made.exact == (exact or "beckmann" in members.values())
    if exact:
        assert apart(theirs, fit.predict(light, view, quantity="radiance")) < SINGLE


def test_mitsuba_reads_the_table(mi, tmp_path):
    """An .bsdf file of ours in its plugin for measurements."""
    fit, light, view = model(), *brdffit.protocol84()
    fit.export("rgl", tmp_path / "fit.bsdf")
    one = mi.load_dict({"type": "measured", "filename": str(tmp_path / "fit.bsdf")})
    theirs = evaluated(mi, one, view, light)  # its cosine is the other one, and f_r is reciprocal
    ours = fit.predict(light, view, quantity="brdf") * view[:, 2:]
    assert apart(theirs, ours) < 0.02


# ---- Draws --------------------------------------------------------------------------

DRAWS = """
#include <stdio.h>
#include <stdlib.h>
#include "brdffit_shade.h"
int main(void)
{
    static struct brdffit_shade_d m;
    const double sigma[] = {%g}, x[] = {0.3, 0.2, 0.1}, y[] = {%g, %g, %g}, v[] = {%.17g, 0, %.17g};
    struct brdffit_shade_description d = {1, 3, {BRDFFIT_SHADE_GGX}, BRDFFIT_SHADE_SMITH_SEPARABLE, BRDFFIT_SHADE_LAMBERT, 0,
                                          sigma, x, y, 0, 0};
    double u[3], l[3], out[3];
    brdffit_shade_make_d(&m, &d);
    while (scanf("%%lf %%lf %%lf", u, u + 1, u + 2) == 3) {
        const double pdf = brdffit_shade_sample_d(&m, v, u, l);
        brdffit_shade_eval_d(&m, l, v, out);
        printf("%%.9g %%.9g %%.9g %%.9g\\n", pdf > 0 ? (out[0] + out[1] + out[2]) / 3 / pdf : 0, l[0], l[1], l[2]);
    }
    return 0;
}
"""
COUNT = 12000


@pytest.mark.skipif(shutil.which("gcc") is None, reason="no gcc to draw with brdffit_shade.h")
@pytest.mark.parametrize("sigma", [0.15, 0.5])
def test_draws_are_as_good_as_mitsubas(mi, sigma, tmp_path):
    """Variance of a white furnace, and of a lamp of 6 degrees in the mirror direction, by draws from the material alone: at most
    1.1 of Mitsuba's of the same material, and four standard errors of both. Means agree within four standard errors."""
    y, view = (0.12, 0.1, 0.08), np.array([0.6, 0, 0.8])
    model(masking="smith-separable", sigma=(sigma,), y=y).export("mitsuba", tmp_path / "one.xml")
    one, rng = bsdf(mi, tmp_path / "one.xml"), np.random.default_rng(4)
    context, at, u = mi.BSDFContext(), mi.SurfaceInteraction3f(), rng.random((COUNT, 3))
    at.wi = mi.Vector3f(*view)
    drawn = [one.sample(context, at, a, mi.Point2f(b, c)) for a, b, c in u]
    theirs = np.array([(np.mean(np.array(weight, float)), *np.array(sample.wo, float)) for sample, weight in drawn])
    (tmp_path / "draw.c").write_text(DRAWS % (sigma, *y, *view[[0, 2]]))
    subprocess.run(["gcc", "-O1", "-w", "-I", ROOT / "include", "-o", tmp_path / "draw", tmp_path / "draw.c", "-lm"], check=True)
    text = subprocess.run([tmp_path / "draw"], input="\n".join("%.17g %.17g %.17g" % tuple(row) for row in rng.random((COUNT, 3))),
                          capture_output=True, text=True, check=True).stdout
    ours = np.array(text.split(), float).reshape(-1, 4)
    lamp = np.cos(np.radians(6))
    for light in (lambda d: 1.0, lambda d: (d[:, 1:] @ (view * [-1, -1, 1]) > lamp) * 1.0):
        a, b = (d[:, 0] * light(d) for d in (ours, theirs))
        assert abs(a.mean() - b.mean()) < 4 * np.sqrt((a.var() + b.var()) / COUNT)
        noise = [np.sqrt(max(0.0, ((c - c.mean()) ** 4).mean() - c.var() ** 2) / COUNT) for c in (a, b)]
        assert a.var() <= 1.1 * b.var() + 4 * np.hypot(*noise)


# ---- Documents ---------------------------------------------------------------------------


@pytest.mark.parametrize("target", ["materialx", "openpbr"])
def test_materialx_validates(target, tmp_path):
    mx = pytest.importorskip("MaterialX")
    fit, path = model(f0=(0.05, 0.04, 0.03), sigma=(0.1, 0.4)), tmp_path / "one.mtlx"
    made = fit.export(target, path, samples=measured(fit))
    document = mx.createDocument()
    mx.readFromXmlFile(document, str(path))
    library = mx.createDocument()
    mx.loadLibraries(mx.getDefaultDataLibraryFolders(), mx.getDefaultDataSearchPath(), library)
    document.setDataLibrary(library)
    valid, why = document.validate()
    assert valid, why
    assert len(document.getMaterialNodes()) == 1
    if target == "materialx":
        assert apart(by_materialx(path.read_text(), *pairs()), made.shown.values(*pairs())) < 1e-7
        return
    shader = mx.getShaderNodes(document.getMaterialNodes()[0])[0]
    assert shader.getNodeDef() is not None and shader.getCategory() == "open_pbr_surface"
    # Every input is one that the specification has.
    assert all(shader.getNodeDef().getActiveInput(one.getName()) is not None for one in shader.getInputs())


def test_usd_opens(tmp_path):
    pytest.importorskip("pxr")
    from pxr import Usd, UsdShade

    made = model(f0=(0.05, 0.04, 0.03)).export("usd", tmp_path / "one.usda")
    stage = Usd.Stage.Open(str(tmp_path / "one.usda"))
    material = UsdShade.Material(stage.GetDefaultPrim())
    shader, _, _ = material.ComputeSurfaceSource()
    assert shader.GetIdAttr().Get() == "UsdPreviewSurface"
    assert abs(shader.GetInput("roughness").Get() - np.exp(made.shown.parameters[0] / 2)) < 1e-6
    assert np.allclose(shader.GetInput("diffuseColor").Get(), made.shown.parameters[1:4], rtol=1e-6)
