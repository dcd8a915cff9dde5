"""Exports in Cycles, which Blender's package bpy has: nodes, closures of OSL, and its functions, at tilted quads.

Skipped, with a word, where bpy is missing. SPDX-License-Identifier: MIT
"""
import sys
import types

import numpy as np
import pytest

import cycles_probe
from test_py_export import apart, measured, model

# The sun's direction goes through angles in single precision: 1e-7 of it turns lobes of width 0.1.
CLOSE = 1e-4
SUN = np.array([0.4, 0.3, 0.9]) / np.linalg.norm([0.4, 0.3, 0.9])
UP = np.array([0.0, 0.0, 1.0])


@pytest.fixture(scope="module")
def bpy():
    return pytest.importorskip("bpy")


@pytest.fixture(scope="module")
def normals():
    return cycles_probe.normals(np.random.default_rng(1), SUN)


def values(made, normals):
    return made.shown.values(cycles_probe.local(normals, SUN), cycles_probe.local(normals, UP))


MODELS = [{}, {"f0": (0.9, 0.7, 0.4)}, {"sigma": (0.1, 0.4)}, {"distribution": "beckmann"}, {"f0": (0.05, 0.04, 0.03)},
          {"distribution": "ward", "masking": "v-cavity"}]


@pytest.mark.parametrize("members", MODELS)
def test_nodes(bpy, normals, members, tmp_path):
    fit = model(**members)
    made = fit.export("blender", tmp_path / "one.py", samples=measured(fit))
    names = {"__name__": "one"}
    exec((tmp_path / "one.py").read_text(), names)
    theirs = cycles_probe.render(bpy, names["material"], normals, SUN, tmp_path)
    assert apart(theirs, values(made, normals)) < CLOSE
    if made.exact and made.from_fit < 1e-5:
        exact = fit.predict(cycles_probe.local(normals, SUN), cycles_probe.local(normals, UP), quantity="radiance")
        assert apart(theirs, exact) < CLOSE


def script(bpy, path, output, closure):
    """A material whose surface is a script's closure, or a colour that is emitted. The package lacks the module that reads a
    compiled script's parameters: it has one, which is known."""
    query = types.SimpleNamespace(parameters=[types.SimpleNamespace(
        name=output, isclosure=closure, isoutput=True, varlenarray=False, isstruct=False, metadata=[], value=(0.0, 0.0, 0.0),
        type=types.SimpleNamespace(arraylen=0, vecsemantics=types.SimpleNamespace(COLOR=1) if closure else _Colour()))])
    sys.modules["oslquery"] = types.ModuleType("oslquery")
    sys.modules["oslquery"].OSLQuery = lambda compiled: query

    def material():
        made = bpy.data.materials.new("script")
        tree = made.node_tree
        tree.nodes.clear()
        node, surface = tree.nodes.new("ShaderNodeScript"), tree.nodes.new("ShaderNodeOutputMaterial")
        node.mode, node.filepath = "EXTERNAL", str(path)
        if closure:
            tree.links.new(node.outputs[0], surface.inputs["Surface"])
        else:
            emission = tree.nodes.new("ShaderNodeEmission")
            tree.links.new(node.outputs[0], emission.inputs["Color"])
            tree.links.new(emission.outputs[0], surface.inputs["Surface"])
        return made

    return material


class _Colour:
    """A type that is a colour."""

    COLOR = 7

    def __eq__(self, other):
        return other == 7

    __hash__ = None


@pytest.mark.parametrize("members", MODELS)
def test_closures(bpy, normals, members, tmp_path):
    fit = model(**members)
    made = fit.export("osl", tmp_path / "one.osl", samples=measured(fit))
    theirs = cycles_probe.render(bpy, script(bpy, tmp_path / "one.osl", "BSDF", True), normals, SUN, tmp_path)
    assert apart(theirs, values(made, normals)) < CLOSE


@pytest.mark.parametrize("members", [*MODELS, {"distribution": "lafortune", "masking": "v-cavity"},
                                     {"distribution": "beckmann", "masking": "v-cavity"}])
def test_functions(bpy, normals, members, tmp_path):
    """brdffit_eval of the script, compiled by OSL's own compiler and run by Cycles, is the fit whatever its model."""
    fit = model(**members)
    fit.export("osl", tmp_path / "one.osl")
    text = (tmp_path / "one.osl").read_text()
    text = text[:text.index("\nsurface ") + 1] + """shader probe(output color C = 0)
{
    vector n = vector(N), x = normalize(cross(fabs(n[0]) < 0.5 ? vector(1, 0, 0) : vector(0, 1, 0), n)), y = cross(n, x);
    vector sun = vector(%.9g, %.9g, %.9g), up = vector(0, 0, 1);
    C = brdffit_eval(vector(dot(x, sun), dot(y, sun), dot(n, sun)), vector(dot(x, up), dot(y, up), dot(n, up)));
}
""" % tuple(SUN)
    (tmp_path / "one.osl").write_text(text)
    theirs = cycles_probe.render(bpy, script(bpy, tmp_path / "one.osl", "C", False), normals, SUN, tmp_path)
    light, view = cycles_probe.local(normals, SUN), cycles_probe.local(normals, UP)
    assert apart(theirs, fit.predict(light, view, quantity="radiance")) < CLOSE
