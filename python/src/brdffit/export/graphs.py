"""Materials as documents of standards: MaterialX, OpenPBR, glTF, USD. SPDX-License-Identifier: MIT"""
from __future__ import annotations

import json
import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from .._arrays import Floats
from .principled import Gltf, OpenPbr, Usd
from .spaces import Free


def _colour(values: Floats) -> str:
    return ", ".join("%.9g" % one for one in values)


def _document(body: str, comment: Sequence[str]) -> str:
    return '<?xml version="1.0"?>\n<!--\n%s\n-->\n<materialx version="1.39">\n%s\n</materialx>\n' % (
        "\n".join("  " + line for line in comment), body)


def materialx(space: Free, p: Floats, name: str, comment: Sequence[str]) -> str:
    """A surface of BSDF nodes that add."""
    out, last = [], ""

    def node(kind: str, title: str, inputs: Sequence[tuple[str, str, str]]) -> None:
        out.append('    <%s name="%s" type="BSDF">' % (kind, title))
        out.extend('      <input name="%s" type="%s" %s />' % (key, of, value if "=" in value else 'value="%s"' % value)
                   for key, of, value in inputs)
        out.append("    </%s>" % kind)

    node("oren_nayar_diffuse_bsdf", "diffuse", [("color", "color3", _colour(p[:3])), ("roughness", "float", "0")])
    last = "diffuse"
    for i, row in enumerate(p[3:].reshape(-1, 7)):
        title = "lobe%d" % (i + 1)
        node("generalized_schlick_bsdf", title, [
            ("color0", "color3", _colour(row[1:4])), ("color90", "color3", _colour(row[1:4] + row[4:])),
            ("exponent", "float", "5"), ("roughness", "vector2", "%.9g, %.9g" % (math.exp(row[0]), math.exp(row[0]))),
            ("distribution", "string", "ggx"), ("scatter_mode", "string", "R")])
        node("add", "sum%d" % (i + 1), [("in1", "BSDF", 'nodename="%s"' % last), ("in2", "BSDF", 'nodename="%s"' % title)])
        last = "sum%d" % (i + 1)
    body = ('  <nodegraph name="NG_%s">\n%s\n    <surface name="surface" type="surfaceshader">\n'
            '      <input name="bsdf" type="BSDF" nodename="%s" />\n    </surface>\n'
            '    <output name="out" type="surfaceshader" nodename="surface" />\n  </nodegraph>\n'
            '  <surfacematerial name="%s" type="material">\n'
            '    <input name="surfaceshader" type="surfaceshader" nodegraph="NG_%s" output="out" />\n  </surfacematerial>')
    return _document(body % (name, "\n".join(out), last, name, name), comment)


def openpbr(space: OpenPbr, p: Floats, name: str, comment: Sequence[str]) -> str:
    rows = [("base_weight", "float", "1"), ("base_color", "color3", _colour(p[1:4])), ("base_metalness", "float", "%.9g" % p[4]),
            ("base_diffuse_roughness", "float", "0"), ("specular_weight", "float", "%.9g" % p[5]),
            ("specular_color", "color3", _colour(p[6:9])), ("specular_roughness", "float", "%.9g" % math.exp(p[0] / 2)),
            ("specular_ior", "float", "%.9g" % (1 + p[9]))]
    inputs = "\n".join('    <input name="%s" type="%s" value="%s" />' % row for row in rows)
    return _document('  <open_pbr_surface name="SR_%s" type="surfaceshader">\n%s\n  </open_pbr_surface>\n'
                     '  <surfacematerial name="%s" type="material">\n'
                     '    <input name="surfaceshader" type="surfaceshader" nodename="SR_%s" />\n  </surfacematerial>' % (
                         name, inputs, name, name), comment)


def gltf(space: Gltf, p: Floats, name: str, comment: Sequence[str]) -> str:
    """A document with one material, for others to take."""
    def numbers(values: Floats) -> list[float]:
        return [float("%.9g" % one) for one in values]

    specular: dict[str, Any] = {"specularFactor": float("%.9g" % p[5]), "specularColorFactor": numbers(p[6:9] / 0.04)}
    return json.dumps({
        "asset": {"version": "2.0", "generator": "brdffit"}, "extensionsUsed": ["KHR_materials_specular"],
        "materials": [{"name": name, "pbrMetallicRoughness": {
            "baseColorFactor": [*numbers(p[1:4]), 1.0], "metallicFactor": float("%.9g" % p[4]),
            "roughnessFactor": float("%.9g" % math.exp(p[0] / 2))},
            "extensions": {"KHR_materials_specular": specular}, "extras": {"brdffit": list(comment)}}]}, indent=2) + "\n"


def usd(space: Usd, p: Floats, name: str, comment: Sequence[str]) -> str:
    def triple(values: Floats) -> str:
        return "(%s)" % _colour(np.asarray(values))

    return """#usda 1.0
(
    defaultPrim = "%s"
    doc = \"\"\"%s\"\"\"
)

def Material "%s"
{
    token outputs:surface.connect = </%s/surface.outputs:surface>

    def Shader "surface"
    {
        uniform token info:id = "UsdPreviewSurface"
        int inputs:useSpecularWorkflow = 1
        color3f inputs:diffuseColor = %s
        color3f inputs:specularColor = %s
        float inputs:roughness = %.9g
        token outputs:surface
    }
}
""" % (name, "\n".join(comment), name, name, triple(p[1:4]), triple(p[4:7]), math.exp(p[0] / 2))
