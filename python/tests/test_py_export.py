"""Fits as materials: exact where the target has the model, told where it has not; what is written is what was judged.

The numbers are read back from the files and put into formulas that are written here once more, from the targets' specifications.
SPDX-License-Identifier: MIT
"""
import json
import math
import re
import shutil
import subprocess
import xml.etree.ElementTree as xml

import numpy as np
import pytest

import brdffit
from brdffit.export import TARGETS, command
from brdffit.fit import SCHEMA
from places import ROOT


def model(distribution="ggx", masking="smith", sigma=(0.3,), y=(0.15, 0.12, 0.1), f0=None, x=(0.3, 0.2, 0.1), **members):
    """A fit made by hand, its coefficients the same for each lobe."""
    lobes = len(sigma)
    line = {"schema": SCHEMA, "status": "certified", "lobes": lobes, "distribution": distribution, "masking": masking,
            "quantity": "brdf", "channels": ["r", "g", "b"], "channel_scale": [1.0] * 3, "max_incidence": 90.0,
            "sigma": list(sigma), "x": list(x), "y": [[one / lobes] * lobes for one in y]}
    if f0 is not None:
        line |= {"fresnel": "schlick", "f0": [[one] * lobes for one in f0]}
    return brdffit.Fit.from_dict(line | members)


def pairs(count=400, seed=3):
    rng = np.random.default_rng(seed)
    light, view = (np.abs(rng.standard_normal((count, 3))) * np.sign(rng.standard_normal((count, 3))) for _ in range(2))
    near = light * [-1, -1, 1] + 0.3 * rng.standard_normal((count, 3))
    view = np.where(np.arange(count)[:, None] % 2 == 0, near, view)
    light[:, 2], view[:, 2] = np.abs(light[:, 2]) + 0.02, np.abs(view[:, 2]) + 0.02
    return light / np.linalg.norm(light, axis=1, keepdims=True), view / np.linalg.norm(view, axis=1, keepdims=True)


def measured(fit, noise=0.01):
    """Samples of it, with noise, where the maskings of renderers are alike: up to 75 degrees."""
    light, view = pairs(600, 5)
    near = (light[:, 2] > 0.26) & (view[:, 2] > 0.26)
    light, view = light[near], view[near]
    values = fit.predict(light, view, quantity="brdf") * (1 + noise * np.random.default_rng(6).standard_normal((len(light), 3)))
    return brdffit.Samples.from_arrays(light, view, values)


def apart(ours, theirs):
    return float(np.sqrt(((ours - theirs) ** 2).sum() / (theirs ** 2).sum()))


# ---- Formulas, once more ---------------------------------------------------------


def geometry(light, view):
    half = light + view
    half /= np.linalg.norm(half, axis=1, keepdims=True)
    return light[:, 2], view[:, 2], half[:, 2], np.minimum(1, (half * view).sum(1))


def ggx(alpha, light, view):
    """D G2 / (4 n.v), correlated."""
    nl, nv, nh, _ = geometry(light, view)
    a2 = alpha ** 2
    d = a2 / (math.pi * (nh ** 2 * (a2 - 1) + 1) ** 2)
    l, v = (np.sqrt(1 + a2 * (1 - c ** 2) / c ** 2) for c in (nl, nv))
    return d * 2 / (l + v) / (4 * nv)


def schlick(f0, f90, light, view):
    w = (1 - geometry(light, view)[3]) ** 5
    return np.asarray(f0) + np.multiply.outer(w, np.asarray(f90) - f0)


def conductor(eta, k, cosine):
    """Complex amplitudes."""
    index = complex(eta, k)
    inner = np.sqrt(1 - (1 - cosine ** 2) / index ** 2 + 0j)
    across, along = (cosine - index * inner) / (cosine + index * inner), (index * cosine - inner) / (index * cosine + inner)
    return (np.abs(across) ** 2 + np.abs(along) ** 2) / 2


# ---- The targets, by their files ---------------------------------------------------


def by_pbrt(text, light, view):
    """pbrt-v4: mixes, conductors of a reflectance with alpha as it is, diffuse."""
    made = {}
    nl, _, _, vh = geometry(light, view)
    for name, rest in re.findall(r'MakeNamedMaterial "([^"]+)" (.*)', text):
        kind = re.search(r'"string type" "(\w+)"', rest)[1]
        if kind == "mix":
            first, second = re.search(r'\[ "([^"]+)" "([^"]+)" \]', rest).groups()
            amount = float(re.search(r'"float amount" (\S+)', rest)[1])
            made[name] = (1 - amount) * made[first] + amount * made[second]
            continue
        rgb = {key: np.array(value.split(), float) for key, value in re.findall(r'"rgb (\w+)" \[ ([^\]]+) \]', rest)}
        if kind == "diffuse":
            assert ((rgb["reflectance"] >= 0) & (rgb["reflectance"] <= 1)).all()
            made[name] = np.multiply.outer(nl / math.pi, rgb["reflectance"])
            continue
        assert '"bool remaproughness" false' in rest
        alpha = float(re.search(r'"float roughness" (\S+)', rest)[1])
        made[name] = ggx(alpha, light, view)[:, None] * np.stack([conductor(*one, vh) for one in zip(rgb["eta"], rgb["k"])], 1)
    return made[name]


def by_gltf(text, light, view):
    material = json.loads(text)["materials"][0]
    pbr, specular = material["pbrMetallicRoughness"], material["extensions"]["KHR_materials_specular"]
    base, metallic, factor = np.array(pbr["baseColorFactor"][:3]), pbr["metallicFactor"], specular["specularFactor"]
    f0 = np.minimum(0.04 * np.array(specular["specularColorFactor"]), 1)
    g = ggx(pbr["roughnessFactor"] ** 2, light, view)[:, None]
    f = schlick(f0, 1.0, light, view)
    diffuse = np.multiply.outer(light[:, 2] / math.pi, base)
    dielectric = (1 - factor * f.max(1, keepdims=True)) * diffuse + factor * f * g
    return (1 - metallic) * dielectric + metallic * schlick(base, 1.0, light, view) * g


def by_usd(text, light, view):
    def triple(name):
        return np.array(re.search(r"%s = \(([^)]*)\)" % name, text)[1].split(","), float)

    f = schlick(triple("specularColor"), 1.0, light, view)
    roughness = float(re.search(r"roughness = (\S+)", text)[1])
    assert "useSpecularWorkflow = 1" in text
    diffuse = np.multiply.outer(light[:, 2] / math.pi, triple("diffuseColor"))
    return diffuse * (1 - f) + f * ggx(roughness ** 2, light, view)[:, None]


def by_materialx(text, light, view):
    out = np.zeros((len(light), 3))
    for node in xml.fromstring(text).find("nodegraph"):
        given = {one.get("name"): one.get("value") for one in node}
        if node.tag == "oren_nayar_diffuse_bsdf":
            out += np.multiply.outer(light[:, 2] / math.pi, np.array(given["color"].split(","), float))
        elif node.tag == "generalized_schlick_bsdf":
            alpha = float(given["roughness"].split(",")[0])
            f = schlick(*(np.array(given[one].split(","), float) for one in ("color0", "color90")), light, view)
            out += f * ggx(alpha, light, view)[:, None]
    return out


def by_cycles(text, light, view):
    """Nodes and connections of the XML."""
    shader = xml.fromstring(text).find("shader")
    made, links = {}, {}
    for node in shader:
        if node.tag == "connect":
            name, socket = node.get("to").rsplit(" ", 1)
            links[name, socket] = node.get("from").rsplit(" ", 1)[0]
        else:
            made[node.get("name")] = node

    def value(name):
        node = made[name]
        if node.tag == "add_closure":
            return value(links[name, "closure1"]) + value(links[name, "closure2"])
        if node.tag == "mix_closure":
            return float(node.get("fac")) * value(links[name, "closure2"])
        if node.tag == "diffuse_bsdf":
            return np.multiply.outer(light[:, 2] / math.pi, np.array(node.get("color").split(), float))
        g = ggx(float(node.get("roughness")) ** 2, light, view)[:, None]
        assert node.get("distribution") == "ggx"
        if node.tag == "glossy_bsdf":
            return g * np.array(node.get("color").split(), float)
        if node.get("fresnel_type") == "f82":
            assert node.get("edge_tint") == "1 1 1"
            return g * schlick(np.array(node.get("base_color").split(), float), 1.0, light, view)
        return g * np.stack([conductor(float(eta), float(k), geometry(light, view)[3])
                             for eta, k in zip(node.get("ior").split(), node.get("k").split())], 1)

    return value(links["output", "surface"])


READERS = {"pbrt": by_pbrt, "gltf": by_gltf, "usd": by_usd, "materialx": by_materialx, "cycles": by_cycles}


# ---- Tests -------------------------------------------------------------------------


EXACT = [("mitsuba", {"masking": "smith-separable"}), ("mitsuba", {"masking": "smith-separable", "f0": (0.9, 0.7, 0.4)}),
         ("cycles", {}), ("blender", {"f0": (0.9, 0.7, 0.4)}), ("materialx", {"f0": (0.04, 0.5, 0.2)}),
         ("osl", {"f0": (0.04, 0.5, 0.2)}), ("materialx", {"sigma": (0.1, 0.4)}),
         ("cycles", {"sigma": (0.1, 0.4), "f0": (0.9, 0.7, 0.4)})]


@pytest.mark.parametrize(("target", "members"), EXACT)
def test_exact_where_the_target_has_the_model(target, members, tmp_path):
    fit = model(**members)
    made = fit.export(target, tmp_path / ("fit" + TARGETS[target].ending))
    assert made.exact and made.certified and made.from_fit < 1e-12
    light, view = pairs()
    assert apart(made.shown.values(light, view), fit.predict(light, view, quantity="radiance")) < 1e-12
    assert any("exact" in line for line in made.lines)
    if target in READERS:  # nine digits are written
        text = (tmp_path / ("fit" + TARGETS[target].ending)).read_text()
        assert apart(READERS[target](text, light, view), fit.predict(light, view, quantity="radiance")) < 1e-7


@pytest.mark.parametrize("target", READERS)
@pytest.mark.parametrize("members", [{"distribution": "ward", "masking": "v-cavity"}, {"f0": (0.05, 0.04, 0.03)}])
def test_the_file_is_what_was_judged(target, members, tmp_path):
    fit, light, view = model(**members), *pairs()
    made = fit.export(target, tmp_path / "fit", samples=measured(fit))
    assert apart(READERS[target]((tmp_path / "fit").read_text(), light, view), made.shown.values(light, view)) < 1e-6
    words = (tmp_path / "fit").read_text()
    assert "%.4g" % made.error in words and TARGETS[target].title in words
    assert made.exact == ("exact:" in words)


@pytest.mark.parametrize("target", [one.name for one in TARGETS.values() if one.space in ("sum", "free", "conductor")])
def test_as_good_as_the_fit(target, tmp_path):
    """A dielectric with Schlick's F and unequal channels, by the measurement: what is fitted again is within 2 %; pbrt's
    conductors, of one weight for three channels, are not Schlick's F at grazing angles."""
    fit = model(f0=(0.05, 0.04, 0.03), y=(0.16, 0.15, 0.14))
    samples = measured(fit, 0.05)
    again = brdffit.fit(samples, distribution="ggx", masking="smith", fresnel="schlick")
    made = again.export(target, tmp_path / "fit", samples=samples)
    assert made.error <= (1.2 if target == "pbrt" else 1.02) * made.fit_error


def test_a_blend_is_of_one(tmp_path):
    """Weights of Mitsuba and pbrt sum to 1 and no colour is above it, whatever the fit's numbers."""
    fit = model(y=(0.4, 0.3, 0.2), x=(0.9, 0.8, 0.7))
    for target in ("mitsuba", "pbrt"):
        made = fit.export(target, tmp_path / "fit")
        assert not made.exact and made.shown.space.total(made.shown.parameters) <= 1 + 1e-12
        assert np.all(made.shown.values(*pairs()) >= 0)
    for colour in re.findall(r'(?:reflectance|base_color)" value="([^"]*)"', (tmp_path / "fit").read_text()):
        assert all(0 <= float(one) <= 1 for one in colour.split())


def test_two_lobes_become_one(tmp_path):
    fit = model(sigma=(0.1, 0.4))
    made = fit.export("gltf", tmp_path / "fit.gltf", samples=measured(fit))
    assert not made.exact and not made.certified and len(made.shown.base.sigma) == 1
    assert made.fit_error < made.error < 1


def test_anisotropic_lobes_are_told(tmp_path):
    """No target has them yet: a material is fitted again, as an isotropic one; functions and tables are refused."""
    light, view = pairs()
    base = model(masking="v-cavity", anisotropy=[0.5], tangent_angle=[0.0])
    values = base.predict(light, view, quantity="brdf")
    samples = brdffit.Samples.from_arrays(light, view, values)
    made = base.export("materialx", tmp_path / "one.mtlx", samples=samples)
    assert not made.exact and made.fit_error < 1e-12 < 0.01 < made.error
    turn = np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]])  # the same surface, told with its tangent
    turned = brdffit.Samples.from_arrays(light @ turn.T, view @ turn.T, values, tangent=turn @ [1.0, 0, 0])
    assert abs(base.export("materialx", tmp_path / "one.mtlx", samples=turned).error - made.error) < 1e-6
    for target in ("glsl", "merl"):
        with pytest.raises(brdffit.UnsupportedError, match="anisotropic"):
            base.export(target, tmp_path / "one")


def test_channels(tmp_path):
    grey = model(channels=["white"], channel_scale=[1.0], x=[0.3], y=[0.2])
    made = grey.export("materialx", tmp_path / "grey.mtlx")
    assert (np.ptp(made.shown.values(*pairs()), axis=1) == 0).all()
    four = model(channels=["a", "b", "c", "d"], channel_scale=[1.0] * 4, x=[0.1, 0.2, 0.3, 0.4], y=[0.1, 0.2, 0.1, 0.2])
    with pytest.raises(brdffit.UnsupportedError, match="--channels"):
        four.export("materialx", tmp_path / "four.mtlx")
    made = four.export("materialx", tmp_path / "four.mtlx", channels=["d", "b", "a"])
    light, view = pairs()
    assert apart(made.shown.values(light, view), four.predict(light, view, quantity="radiance")[:, [3, 1, 0]]) < 1e-12


def test_tables(tmp_path):
    fit = model()
    fit.export("merl", tmp_path / "fit.binary")
    light, view = brdffit.protocol84()
    table = brdffit.load_merl(tmp_path / "fit.binary")
    assert apart(table.lookup(light, view), fit.predict(light, view, quantity="brdf")) < 0.05  # the bins' width
    light, view = (np.stack([np.sin(t), 0 * t, np.cos(t)], 1) * sign for t, sign in (
        (np.radians([10.0, 30, 50]), [1, 1, 1]), (np.radians([10.0, 30, 50]), [-1, 1, 1])))  # on edges: theta_h = 0
    assert np.allclose(table.lookup(light, view), fit.predict(light, view, quantity="brdf"), rtol=1e-12)
    light, view = brdffit.protocol84()
    fit.export("rgl", tmp_path / "fit.bsdf")
    material = brdffit.load_rgl(tmp_path / "fit.bsdf")
    assert material.description.startswith("RGL tensor file")
    assert apart(material.eval(light, view), fit.predict(light, view, quantity="brdf")) < 0.01  # what interpolation makes of it


# ---- Functions -----------------------------------------------------------------------

PRELUDE = """
#include <cmath>
#include <cstdio>
static float sqrt(float x) { return std::sqrt(x); }  static float exp(float x) { return std::exp(x); }
static float log(float x) { return std::log(x); }    static float atan(float x) { return std::atan(x); }
static float sin(float x) { return std::sin(x); }    static float cos(float x) { return std::cos(x); }
static float abs(float x) { return std::fabs(x); }
struct vec3 { float c[3]; vec3(float a, float b, float d) : c{a, b, d} {}
  float operator[](int i) const { return c[i]; } };
static vec3 operator*(vec3 a, float b) { return vec3(a[0] * b, a[1] * b, a[2] * b); }
static vec3 operator*(float b, vec3 a) { return a * b; }
static vec3 operator+(vec3 a, vec3 b) { return vec3(a[0] + b[0], a[1] + b[1], a[2] + b[2]); }
static void operator+=(vec3 &a, vec3 b) { a = a + b; }
typedef vec3 float3;
"""
MAIN = """
    while (std::scanf("%%f %%f %%f %%f %%f %%f", l, l + 1, l + 2, v, v + 1, v + 2) == 6) {
        %s
    }
"""
VALUES = """{ vec3 o = m%d::brdffit_eval(vec3(l[0], l[1], l[2]), vec3(v[0], v[1], v[2]));
        float p = m%d::brdffit_pdf(vec3(l[0], l[1], l[2]), vec3(v[0], v[1], v[2]));
        vec3 d = m%d::brdffit_sample(vec3(v[0], v[1], v[2]), vec3(0.3f, 0.6f, 0.4f));
        std::printf("%%.9g %%.9g %%.9g %%.9g %%.9g %%.9g %%.9g\\n", o[0], o[1], o[2], p, d[0], d[1], d[2]); }"""

EVERY = [model(distribution=name, masking=masking, sigma=(0.25,), diffuse=diffuse, f0=f0,
               **({"x_more": [[0.1] * more] * 3} if more else {}))
         for name, masking, diffuse, more, f0 in (
             ("beckmann", "smith", "lambert", 0, None), ("beckmann", "smith-separable", "oren-nayar", 1, (0.1, 0.2, 0.3)),
             ("beckmann", "v-cavity", "burley", 2, None), ("ggx", "none", "none", 0, None),
             ("ggx", "v-cavity", "lambert", 0, (0.04,) * 3),
             ("ggx", "smith", "burley", 2, (0.04, 0.5, 0.9)), ("ggx", "smith-separable", "lambert", 0, None),
             ("torrance-sparrow", "v-cavity", "lambert", 0, None), ("ward", "v-cavity", "lambert", 0, None),
             ("blinn-phong", "v-cavity", "lambert", 0, None), ("ashikhmin-shirley", "v-cavity", "lambert", 0, None),
             ("lafortune", "v-cavity", "lambert", 0, None), ("retro", "v-cavity", "lambert", 0, None))]


@pytest.mark.skipif(shutil.which("g++") is None, reason="no g++ to run the shader's text with")
@pytest.mark.parametrize("target", ["glsl", "hlsl"])
def test_shaders_compute_the_fit(target, tmp_path):
    """The text, compiled as C++ that has the vectors of a shader: values of every model, to single precision."""
    bodies = []
    for i, fit in enumerate(EVERY):
        fit.export(target, tmp_path / "one")
        bodies.append("namespace m%d {\n%s\n}\n" % (i, (tmp_path / "one").read_text()))
    calls = "\n".join(VALUES % (i, i, i) for i in range(len(EVERY)))
    (tmp_path / "all.cc").write_text(PRELUDE + "".join(bodies) + "int main() { float l[3], v[3];" + MAIN % calls + "}\n")
    subprocess.run(["g++", "-O0", "-w", "-o", tmp_path / "all", tmp_path / "all.cc"], check=True)
    light, view = pairs(200)
    given = "\n".join("%.9g %.9g %.9g %.9g %.9g %.9g" % (*l, *v) for l, v in zip(light, view))
    out = subprocess.run([tmp_path / "all"], input=given, capture_output=True, text=True, check=True).stdout.split()
    found = np.array(out, float).reshape(200, len(EVERY), 7)
    for i, fit in enumerate(EVERY):
        exact = fit.predict(light, view, quantity="radiance")
        # Single precision of the directions, and what exp makes of an exponent of up to 60.
        assert np.allclose(found[:, i, :3], exact, rtol=2e-5, atol=1e-7), fit.distributions
        assert (found[:, i, 3] > 0).all() and np.allclose(np.linalg.norm(found[:, i, 4:], axis=1), 1, atol=1e-5)


@pytest.mark.skipif(shutil.which("glslangValidator") is None, reason="no glslangValidator (package glslang-tools)")
@pytest.mark.parametrize("target", ["glsl", "hlsl"])
def test_shaders_compile(target, tmp_path):
    for fit in EVERY:
        fit.export(target, tmp_path / "one")
        text = (tmp_path / "one").read_text()
        if target == "glsl":
            (tmp_path / "one.frag").write_text("#version 330\n" + text + "\nin vec3 l, v, u; out vec4 o;\nvoid main() { o = vec4("
                                               "brdffit_eval(brdffit_sample(v, u), v), brdffit_pdf(l, v)); }\n")
            command_line = ["glslangValidator", str(tmp_path / "one.frag")]
        else:
            (tmp_path / "one.hlsl").write_text(text + "\nfloat4 main(float3 l : A, float3 v : B, float3 u : C) : SV_Target {"
                                               " return float4(brdffit_eval(brdffit_sample(v, u), v), brdffit_pdf(l, v)); }\n")
            command_line = ["glslangValidator", "-D", "-V", "-S", "frag", "-e", "main", "-o", str(tmp_path / "o"),
                            str(tmp_path / "one.hlsl")]
        done = subprocess.run(command_line, capture_output=True, text=True)
        assert done.returncode == 0, done.stdout + text


# ---- The command, the table ------------------------------------------------------------


def test_command(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    line = brdffit.fit(measured(model()), distribution="ggx", masking="smith").to_json() + "\n"
    (tmp_path / "fit.json").write_text(line)
    assert command.main(["fit.json", "--to", "cycles"]) == 0
    out, err = capsys.readouterr()
    assert out == "fit.xml\n" and "exact" in err and (tmp_path / "fit.xml").exists()
    (tmp_path / "two.json").write_text(line * 2)
    assert command.main(["two.json", "--to", "usd"]) == 3
    assert "--select" in capsys.readouterr().err
    assert command.main(["two.json", "--to", "usd", "--select", "2", "-o", "b.usda", "-q"]) == 0
    assert command.main(["two.json", "--to", "usd", "--select", "3"]) == 3
    assert command.main(["absent.json", "--to", "usd"]) == 1
    assert command.main(["fit.json", "--to", "usd", "--scene"]) == 2
    with pytest.raises(SystemExit) as stopped:
        command.main(["fit.json", "--to", "maya"])
    assert stopped.value.code == 2


def test_an_unknown_target(tmp_path):
    with pytest.raises(brdffit.OptionError, match="mitsuba"):
        model().export("maya", tmp_path / "fit")


def test_the_documents_have_the_table():
    text = (ROOT / "docs" / "export.md").read_text(encoding="utf-8")
    for one in TARGETS.values():
        assert "| `%s` | %s | %s | %s | %s | %s |" % (
            one.name, one.title, one.alpha, one.masking, one.fresnel, one.weights) in text, one.name
