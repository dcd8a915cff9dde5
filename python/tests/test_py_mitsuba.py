"""Predictions against Mitsuba's: the same numbers where the formulas are the same, and how far apart where they are not.

    python -m venv scratch && scratch/bin/pip install mitsuba==3.9.1
    BRDFFIT_LIBRARY=build/libbrdffit.so PYTHONPATH=python/src scratch/bin/python python/tests/test_py_mitsuba.py [red-plastic.csv]

prints the tables of docs/renderers.md. Mitsuba computes in single precision, and takes vectors as they come where brdffit
normalises them. The directions here are of unit length to 4e-9 in single precision, and `allowed` charges the rest.

SPDX-License-Identifier: MIT
"""
import functools
import math
import re
import sys

import numpy as np
import pytest

import brdffit
from brdffit.fit import SCHEMA

SINGLE = 2.0 ** -24  # half a unit in the last place of 1
SAME = 64 * SINGLE  # relative, 4e-6: of formulas that are the same. Largest seen: 1.2e-6, twenty roundings
EXPONENT = 60  # of Beckmann, at most, where Mitsuba has not cut it off; exp magnifies the roundings of its argument by that
WALTER = 0.0035  # what Walter et al. (2007) and Mitsuba's source state of the rational approximation to Beckmann's G1
ROUGH = (0.001, 0.02, 0.1, 0.3, 0.8, 1.0)
COUNT = 3000


@pytest.fixture(scope="module")
def mi():
    return single(pytest.importorskip("mitsuba"))


def single(mitsuba):
    mitsuba.set_variant("scalar_rgb")
    return mitsuba


# ---- Directions -------------------------------------------------------------


def unit(v):
    return v / np.linalg.norm(v, axis=1, keepdims=True)


def around(rng, count):
    """Uniform in cosine for one half, and in its logarithm down to 1e-4, which is 0.006 degrees, for the other."""
    cosine = np.where(rng.random(count) < 0.5, rng.uniform(1e-4, 1, count), 10 ** rng.uniform(-4, 0, count))
    phi, sine = rng.uniform(0, 2 * np.pi, count), np.sqrt(1 - cosine ** 2)
    return np.stack([sine * np.cos(phi), sine * np.sin(phi), cosine], 1)


@functools.lru_cache(maxsize=1)
def pairs():
    """Light and view, COUNT x 3, half of the pairs near the mirror direction at every scale of the lobes above."""
    rng = np.random.default_rng(1)
    light, view = (around(rng, 400 * COUNT) for _ in range(2))
    spread = 10 ** rng.uniform(-4, 0, (len(light), 1))
    mirror = unit(light * [-1, -1, 1] + spread * rng.standard_normal(light.shape))
    near = (rng.random(len(light)) < 0.5) & (mirror[:, 2] > 1e-4)
    both = np.stack([light, np.where(near[:, None], mirror, view)]).astype(np.float32).astype(float)
    exact = (np.abs(np.linalg.norm(both, axis=2) - 1) < SINGLE / 16).all(0)
    assert exact.sum() >= COUNT
    return both[:, exact][:, :COUNT]


def slope2(light, view):
    """tan^2 of the half vector's angle."""
    half = light + view
    return (half[:, :2] ** 2).sum(1) / half[:, 2] ** 2


def between(light, view):
    """v.h."""
    return (unit(light + view) * view).sum(1)


def allowed(steepness, same=SAME):
    """Relative difference of each pair that is only rounding. Errors of the vectors' lengths turn the half vector by up to
    their sum over |l + v|, which moves tan(theta_h) by 1 + tan^2 times that, and a lobe by its steepness |d ln D / d tan|.
    Schlick's and the exact Fresnel factor change by 6 times what v.h does, at most, from F0 = 0.04 on."""
    light, view = pairs()
    error = sum(np.abs(np.linalg.norm(one, axis=1) - 1) for one in (light, view))
    tangent = np.sqrt(slope2(light, view))
    turned = error / np.linalg.norm(light + view, axis=1)
    return same + turned * ((1 + tangent ** 2) * (steepness(tangent) + 4 * tangent / (1 + tangent ** 2)) + 6)


def ggx_allowed(sigma):
    return allowed(lambda tangent: 4 * tangent / (sigma ** 2 + tangent ** 2))


def beckmann_allowed(sigma):
    return allowed(lambda tangent: 2 * tangent / sigma ** 2, EXPONENT * 8 * SINGLE)


# ---- The two programs --------------------------------------------------------


def predict(light, view, sigma, distribution="ggx", masking="smith-separable", channels=1, **members):
    """brdffit's radiance f_r cos(theta of light): of one lobe with y = 1/4, which is F = 1, unless it is told otherwise."""
    line = {"schema": SCHEMA, "lobes": 1, "distribution": distribution, "masking": masking, "quantity": "radiance",
            "channels": [str(k) for k in range(channels)], "sigma": [float(np.float32(sigma))], "x": [0.0] * channels,
            "y": [[0.25]] * channels}
    return brdffit.Fit.from_dict(line | members).predict(light, view)


def render(mi, description, light, view):
    """Mitsuba's f_r cos(theta_o), N x 3, of a BSDF or of what one is made from: its wi is where the camera is."""
    bsdf = mi.load_dict(description) if isinstance(description, dict) else description
    context, at = mi.BSDFContext(), mi.SurfaceInteraction3f()
    out = []
    for l, v in zip(light, view):
        at.wi = mi.Vector3f(*v)
        out.append(np.array(bsdf.eval(context, at, mi.Vector3f(*l)), float))
    return np.array(out)


def conductor(distribution, alpha):
    """F = 1: a perfect mirror."""
    return {"type": "roughconductor", "material": "none", "distribution": distribution, "alpha": alpha}


def g1(mi, distribution, alpha, direction):
    """Mitsuba's own, of each direction."""
    d = mi.MicrofacetDistribution(getattr(mi.MicrofacetType, {"ggx": "GGX", "beckmann": "Beckmann"}[distribution]), alpha, alpha)
    return np.array([d.smith_g1(mi.Vector3f(*one), mi.Vector3f(0, 0, 1)) for one in direction], float)


def g1_erf(alpha, direction):
    """Beckmann's, exact."""
    tangent = np.hypot(direction[:, 0], direction[:, 1]) / direction[:, 2] * float(np.float32(alpha))
    erfc = np.array([math.erfc(1 / one) if one > 0 else 0.0 for one in tangent])
    with np.errstate(divide="ignore"):
        return 1 / (1 - erfc / 2 + tangent * np.exp(-1 / tangent ** 2) / (2 * math.sqrt(math.pi)))


def apart(ours, theirs):
    """Relative differences where Mitsuba has not cut the lobe off: it does where D cos(theta_h) is 1e-20."""
    here = theirs > 0
    assert here.mean() > 0.05
    return np.where(here, np.abs(ours / np.where(here, theirs, 1) - 1), np.nan)


def within(difference, most):
    assert (np.isnan(difference) | (difference <= most)).all(), (np.nanargmax(difference / most), np.nanmax(difference / most))


def cut_off(ours, theirs, light, view):
    """Where Mitsuba says 0, so would a D cos(theta_h) of 1e-20, with y = 1/4 and no masking."""
    gone = theirs == 0
    most = 1e-20 / (4 * unit(light + view)[:, 2] * view[:, 2])
    return (ours[gone] <= 1.001 * most[gone]).all()


def exact_fresnel(cosine, eta):
    """Of a dielectric."""
    inner = np.sqrt(1 - (1 - cosine ** 2) / eta ** 2)
    across, along = (cosine - eta * inner) / (cosine + eta * inner), (eta * cosine - inner) / (eta * cosine + inner)
    return (across ** 2 + along ** 2) / 2


# ---- Comparisons: of the same formula ----------------------------------------


def ggx(mi, alpha):
    light, view = pairs()
    ours, theirs = predict(light, view, alpha)[:, 0], render(mi, conductor("ggx", alpha), light, view)[:, 0]
    assert cut_off(ours, theirs, light, view)
    return apart(ours, theirs)


def beckmann(mi, alpha, swap):
    """swap: put Mitsuba's G1 into ours, so that D is left."""
    light, view = pairs()
    ours = predict(light, view, alpha, "beckmann")[:, 0]
    theirs = render(mi, conductor("beckmann", alpha), light, view)[:, 0]
    assert cut_off(ours, theirs, light, view)
    for direction in (light, view) if swap else ():
        ours = ours * g1(mi, "beckmann", alpha, direction) / g1_erf(alpha, direction)
    return apart(ours, theirs)


def correlated(mi, alpha):
    """Heitz's 1/(1 + L + L) of Mitsuba's own L = 1/G1 - 1, in the place of its product of two G1."""
    light, view = pairs()
    a, b = (g1(mi, "ggx", alpha, direction) for direction in (light, view))
    theirs = render(mi, conductor("ggx", alpha), light, view)[:, 0] / (a + b - a * b)
    return apart(predict(light, view, alpha, masking="smith")[:, 0], theirs)


def metal(mi, roughness, base=(0.04, 0.5, 0.95)):
    light, view = pairs()
    theirs = render(mi, {"type": "principled", "metallic": 1.0, "roughness": roughness,
                         "base_color": {"type": "rgb", "value": list(base)}}, light, view)
    ours = predict(light, view, roughness ** 2, channels=3, fresnel="schlick", f0=[[one] for one in base])
    return apart(ours, theirs)


def tinted(roughness, base, f0):
    """Members of brdffit's model and of Mitsuba's, for principled with Schlick's Fresnel and Burley's diffuse term."""
    eta = (1 + math.sqrt(f0)) / (1 - math.sqrt(f0))
    theirs = {"type": "principled", "roughness": roughness, "spec_tint": 1.0, "eta": eta,
              "base_color": {"type": "rgb", "value": base}}
    ours = {"fresnel": "schlick", "f0": [[f0]], "diffuse": "burley", "x": [base],
            "x_more": [[base * roughness, base * roughness ** 2]]}
    return ours, theirs


def dielectric(mi, roughness, base=0.5, f0=0.04):
    light, view = pairs()
    ours, theirs = tinted(roughness, base, f0)
    return apart(predict(light, view, roughness ** 2, **ours)[:, 0], render(mi, theirs, light, view)[:, 0])


def plastic(mi, alpha, eta=1.5, schlick=False):
    """The specular part of roughplastic, ours times the exact Fresnel factor or with Schlick's."""
    light, view = pairs()
    theirs = render(mi, {"type": "roughplastic", "distribution": "ggx", "alpha": alpha, "int_ior": eta, "ext_ior": 1.0,
                         "diffuse_reflectance": {"type": "rgb", "value": 0.0}}, light, view)[:, 0]
    if schlick:
        return apart(predict(light, view, alpha, fresnel="schlick", f0=[[((eta - 1) / (eta + 1)) ** 2]])[:, 0], theirs)
    return apart(predict(light, view, alpha)[:, 0] * exact_fresnel(between(light, view), eta), theirs)


def lambert(mi, base=(0.04, 0.5, 0.95)):
    light, view = pairs()
    theirs = render(mi, {"type": "diffuse", "reflectance": {"type": "rgb", "value": list(base)}}, light, view)
    return apart(predict(light, view, 0.5, channels=3, x=list(base), y=[[0.0]] * 3), theirs)


# ---- Tests -------------------------------------------------------------------


@pytest.mark.parametrize("alpha", ROUGH)
def test_ggx(mi, alpha):
    within(ggx(mi, alpha), ggx_allowed(alpha))
    within(correlated(mi, alpha), ggx_allowed(alpha))


@pytest.mark.parametrize("alpha", ROUGH)
def test_beckmann(mi, alpha):
    within(beckmann(mi, alpha, swap=True), beckmann_allowed(alpha))
    direct = beckmann(mi, alpha, swap=False)
    within(direct, beckmann_allowed(alpha) + (1 + WALTER) ** 2 - 1)
    assert alpha < 0.02 or np.nanmax(direct) > WALTER  # which is what differs, and not our G1 that approximates


def test_differences_have_names(mi):
    """Masking and Fresnel: that these are not within rounding is why docs/renderers.md tells which is whose."""
    assert np.nanmax(plastic(mi, 0.2, schlick=True)) > 0.01
    theirs = render(mi, conductor("ggx", 0.3), *pairs())[:, 0]
    for masking in ("smith", "v-cavity", "none"):
        assert np.nanmax(apart(predict(*pairs(), 0.3, masking=masking)[:, 0], theirs)) > 0.1


@pytest.mark.parametrize("roughness", [0.15, 0.4, 1.0])
def test_principled(mi, roughness):
    within(metal(mi, roughness), ggx_allowed(roughness ** 2)[:, None])
    within(dielectric(mi, roughness), ggx_allowed(roughness ** 2))


def test_roughplastic_is_ours_but_for_fresnel(mi):
    within(plastic(mi, 0.2), ggx_allowed(0.2))


def test_diffuse(mi):
    within(lambert(mi), SAME)


def test_what_mitsuba_renders_is_found_again(mi):
    """The round trip: samples that Mitsuba made, fitted by its own formulas, from the paper's 84 directions and grazing ones."""
    rng = np.random.default_rng(2)
    light, view = (around(rng, 300) for _ in range(2))
    ours, theirs = tinted(0.5, 0.3, 0.08)
    values = render(mi, theirs, light, view)[:, :1]
    fit = brdffit.fit(brdffit.Samples.from_arrays(light, view, values, quantity="radiance"), distribution="ggx",
                      masking="smith-separable", fresnel="schlick", diffuse="burley", relative_gap=1e-6, absolute_gap=1e-9)
    np.testing.assert_allclose([fit.sigma[0], fit.y[0, 0], fit.f0[0, 0], fit.x[0]], [0.25, 0.25, 0.08, 0.3], rtol=1e-4)


@pytest.mark.parametrize("lobes", [["ggx"], ["ggx", "ggx"], ["ggx", "beckmann"]])
def test_a_fit_as_a_material(mi, lobes, tmp_path):
    fit = brdffit.Fit.from_dict({
        "schema": SCHEMA, "lobes": len(lobes), "distributions": lobes, "masking": "smith-separable", "quantity": "radiance",
        "channels": ["r", "g", "b"], "sigma": [0.1, 0.5][:len(lobes)], "x": [0.3, 0.2, 0.0],
        "y": np.array([[0.02, 0.1], [0.03, 0.05], [0.01, 0.02]])[:, :len(lobes)], "channel_scale": [1.0] * 3,
        "max_incidence": 90.0})
    assert fit.export("mitsuba", tmp_path / "one.xml").exact
    text = re.search(r"<bsdf.*</bsdf>", (tmp_path / "one.xml").read_text(), re.DOTALL)[0]
    text = text.replace("<bsdf", '<bsdf version="3.0.0"', 1)
    light, view = pairs()
    most = ggx_allowed(0.1)[:, None] + ((1 + WALTER) ** 2 - 1 if "beckmann" in lobes else 0)
    within(apart(fit.predict(light, view), render(mi, mi.load_string(text), light, view)), most)


# ---- The tables of docs/renderers.md -----------------------------------------


def same_formula(mi):
    """Median and largest difference, the latter where the vectors' lengths explain less than 1e-6 of it."""
    rows = [("roughconductor, GGX", 0.001, ggx, ggx_allowed), ("roughconductor, GGX", 0.1, ggx, ggx_allowed),
            ("roughconductor, GGX", 0.8, ggx, ggx_allowed), ("G1 / (a + b - a b), GGX", 0.3, correlated, ggx_allowed),
            ("roughconductor, Beckmann, its G1", 0.1, lambda mi, s: beckmann(mi, s, True), beckmann_allowed),
            ("roughconductor, Beckmann, its G1", 0.8, lambda mi, s: beckmann(mi, s, True), beckmann_allowed),
            ("roughconductor, Beckmann", 0.1, lambda mi, s: beckmann(mi, s, False), beckmann_allowed),
            ("roughconductor, Beckmann", 0.8, lambda mi, s: beckmann(mi, s, False), beckmann_allowed),
            ("principled, metallic 1", 0.16, lambda mi, s: metal(mi, s ** 0.5).max(1), ggx_allowed),
            ("principled, spec_tint 1", 0.16, lambda mi, s: dielectric(mi, s ** 0.5), ggx_allowed),
            ("roughplastic, exact Fresnel", 0.2, plastic, ggx_allowed),
            ("diffuse", math.inf, lambda mi, s: lambert(mi).max(1), lambda s: allowed(lambda tangent: 0 * tangent))]
    for name, sigma, compared, most in rows:
        difference, bound = compared(mi, sigma), most(sigma)
        sharp = np.isfinite(difference) & (bound - bound.min() < 1e-6)
        print("%-34s sigma %-6g median %.1e  largest %.1e  of %d pairs" % (
            name, sigma, np.nanmedian(difference), difference[sharp].max(), sharp.sum()))


def other_formula(mi, alpha=0.3):
    """Largest differences of what is not the same, among pairs within 60 and 85 degrees."""
    light, view = pairs()
    theirs = render(mi, conductor("ggx", alpha), light, view)[:, 0]
    rows = [("GGX, masking %s" % m, apart(predict(light, view, alpha, masking=m)[:, 0], theirs)) for m in ("smith", "v-cavity")]
    rows += [("Beckmann, masking %s" % m, apart(predict(light, view, alpha, "beckmann", m)[:, 0],
                                                render(mi, conductor("beckmann", alpha), light, view)[:, 0]))
             for m in ("smith", "v-cavity")]
    rows.append(("Schlick for n = 1.5", plastic(mi, alpha, schlick=True)))
    for name, difference in rows:
        inside = [np.minimum(light[:, 2], view[:, 2]) > math.cos(math.radians(limit)) for limit in (60, 85)]
        print("%-30s sigma %g: within 60 degrees median %.2g largest %.2g, within 85 median %.2g largest %.2g" % (
            name, alpha, *(of(difference[here]) for here in inside for of in (np.nanmedian, np.nanmax))))


def measured_material(mi, path):
    """Fits of a file with each masking, and as Mitsuba would render their numbers, whose masking is its own."""
    samples = brdffit.Samples.from_csv(path)
    light, view = samples.light, samples.view
    for options in ({"lobes": 2}, {"distribution": "ggx"}, {"distribution": "ggx", "fresnel": "schlick"}):
        for masking in ("v-cavity", "smith", "smith-separable"):
            fit = brdffit.fit(samples, masking=masking, max_incidence=60, **options)
            theirs = light[:, 2:] * fit.x / np.pi
            for p, (name, sigma) in enumerate(zip(fit.distributions, fit.sigma)):
                if fit.f0 is None:
                    lobe = render(mi, conductor(name, sigma), light, view)
                else:
                    lobe = render(mi, {"type": "principled", "metallic": 1.0, "roughness": sigma ** 0.5,
                                       "base_color": {"type": "rgb", "value": list(fit.f0[:, p])}}, light, view)
                theirs = theirs + 4 * fit.y[:, p] * lobe
            ours, data = fit.predict(light, view, quantity="radiance"), samples.values * light[:, 2:]
            rms = [np.linalg.norm(a - data) / np.linalg.norm(data) for a in (ours, theirs)]
            print("%-48s sigma %s, rms of fit %.4f, as Mitsuba renders it %.4f, apart %.1e" % (
                (options, masking), np.round(fit.sigma, 4), *rms, np.linalg.norm(theirs - ours) / np.linalg.norm(ours)))


def plastic_fitted(mi, alpha=0.2, eta=1.5, albedo=0.5):
    """What a fit with Schlick's Fresnel makes of roughplastic, whose F is exact and whose diffuse term is not Lambert's."""
    rng = np.random.default_rng(3)
    light, view = (around(rng, 2000) for _ in range(2))
    values = render(mi, {"type": "roughplastic", "distribution": "ggx", "alpha": alpha, "int_ior": eta, "ext_ior": 1.0,
                         "diffuse_reflectance": {"type": "rgb", "value": albedo}}, light, view)[:, :1]
    for diffuse in ("lambert", "burley"):
        fit = brdffit.fit(brdffit.Samples.from_arrays(light, view, values, quantity="radiance"), distribution="ggx",
                          masking="smith-separable", fresnel="schlick", diffuse=diffuse)
        print("roughplastic alpha %g eta %g diffuse %g, fitted with %s: sigma %.4f, 4 y %.3f, n %.3f, x %.3f, relative rms %.3f" % (
            alpha, eta, albedo, diffuse, fit.sigma[0], 4 * fit.y[0, 0], fit.ior[0, 0], fit.x[0],
            math.sqrt(fit.e2) / np.linalg.norm(values)))


def main():
    import mitsuba

    mi = single(mitsuba)
    print("mitsuba %s, %s" % (mi.__version__, mi.variant()))
    exact, walter = g1_erf(0.8, pairs()[0]), g1(mi, "beckmann", 0.8, pairs()[0])
    print("Beckmann's G1: rational approximation off by %.4f at most" % np.abs(walter / exact - 1).max())
    same_formula(mi)
    other_formula(mi)
    plastic_fitted(mi)
    for path in sys.argv[1:]:
        measured_material(mi, path)


if __name__ == "__main__":
    main()
