"""Materials that are sums of BSDFs: Mitsuba, pbrt, Cycles, Blender. SPDX-License-Identifier: MIT

Mitsuba's blendbsdf and pbrt's mix take shares of 1: the diffuse part takes what the others leave, and its colour is divided by it.
Cycles adds, and mixes a white-edged lobe with nothing by its weight.
"""
from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from .._arrays import Floats
from .microfacet import extinction
from .spaces import Conductors, Lobe, Sum


def numbers(values: Floats) -> str:
    return " ".join("%.9g" % one for one in values)


# ---- Mitsuba -----------------------------------------------------------------


class _Part(NamedTuple):
    share: float
    text: str


def _mitsuba_lobe(one: Lobe) -> list[_Part]:
    out = []
    rough = '<string name="distribution" value="%s"/><float name="alpha" value="%.9g"/>' % (one.distribution, one.sigma)
    if (most := float(one.colour.max())) > 0:
        out.append(_Part(most, '<bsdf type="roughconductor"><string name="material" value="none"/>%s'
                               '<rgb name="specular_reflectance" value="%s"/></bsdf>' % (rough, numbers(one.colour / most))))
    if (most := float(one.weight.max())) > 0 and one.fresnel == "schlick":
        out.append(_Part(most, '<bsdf type="principled"><float name="metallic" value="1"/><float name="roughness" value="%.9g"/>'
                               '<rgb name="base_color" value="%s"/></bsdf>' % (math.sqrt(one.sigma), numbers(one.base))))
    elif most > 0:
        out.append(_Part(most, '<bsdf type="roughconductor">%s<rgb name="eta" value="%s"/><rgb name="k" value="%s"/>'
                               '<rgb name="specular_reflectance" value="%s"/></bsdf>' % (
                                   rough, numbers(one.eta), numbers(one.k), numbers(one.weight / most))))
    return out


def mitsuba(space: Sum, p: Floats, name: str) -> str:
    """A <bsdf id="name">."""
    parts = [part for one in space.lobes(p) for part in _mitsuba_lobe(one)]
    left = max(0.0, 1 - sum(part.share for part in parts))
    colour = p[:3] / left if left > 0 else np.zeros(3)
    parts.append(_Part(left, '<bsdf type="diffuse"><rgb name="reflectance" value="%s"/></bsdf>' % numbers(np.minimum(colour, 1))))
    text, total = "", 0.0
    for part in parts:
        if part.share <= 0:
            continue
        total += part.share
        text = part.text if not text else '<bsdf type="blendbsdf"><float name="weight" value="%.9g"/>\n%s\n%s</bsdf>' % (
            part.share / total, text, part.text)
    return text.replace("<bsdf ", '<bsdf id="%s" ' % name, 1)


# ---- pbrt ----------------------------------------------------------------------


def pbrt(space: Conductors, p: Floats, name: str) -> str:
    """MakeNamedMaterial lines; the last is the material."""
    parts = [(float(row[1]), '"string type" "conductor" "rgb eta" [ %s ] "rgb k" [ %s ] "float roughness" %.9g '
              '"bool remaproughness" false' % (
                  numbers(row[5:]), numbers(extinction(row[5:], row[2:5])), math.exp(row[0])))
             for row in p[3:].reshape(-1, 8)]
    left = max(0.0, 1 - sum(share for share, _ in parts))
    colour = p[:3] / left if left > 0 else np.zeros(3)
    parts.append((left, '"string type" "diffuse" "rgb reflectance" [ %s ]' % numbers(np.minimum(colour, 1))))
    out, total, last = [], 0.0, ""
    for i, (share, text) in enumerate(parts):
        if share <= 0:
            continue
        total += share
        one = "%s-part%d" % (name, i + 1)
        out.append('MakeNamedMaterial "%s" %s' % (one, text))
        if last:
            mixed = "%s-mix%d" % (name, i)
            out.append('MakeNamedMaterial "%s" "string type" "mix" "string materials" [ "%s" "%s" ] "float amount" %.9g' % (
                mixed, last, one, share / total))
            one = mixed
        last = one
    return "\n".join(out).replace('MakeNamedMaterial "%s"' % last, 'MakeNamedMaterial "%s"' % name)


# ---- Cycles, Blender -----------------------------------------------------------


def nodes(space: Sum, p: Floats) -> list[dict[str, Any]]:
    """The closures to add, in Blender's words."""
    out: list[dict[str, Any]] = []
    if p[:3].max() > 0:
        out.append({"node": "Diffuse", "Color": _list(p[:3])})
    for one in space.lobes(p):
        rough = {"distribution": one.distribution.upper(), "Roughness": math.sqrt(one.sigma)}
        if one.colour.max() > 0:
            out.append({"node": "Glossy", **rough, "Color": _list(one.colour)})
        if one.weight.max() > 0 and one.fresnel == "schlick":
            out.append({"node": "Metallic", **rough, "fresnel_type": "F82", "Base Color": _list(one.base),
                        "Edge Tint": [1.0, 1.0, 1.0], "share": float(one.weight[0])})
        elif one.weight.max() > 0:
            out += [{"node": "Metallic", **rough, "fresnel_type": "PHYSICAL_CONDUCTOR", "IOR": _list(np.where(seen, one.eta, 1)),
                     "Extinction": _list(np.where(seen, one.k, 0)), "share": share} for seen, share in _weights(one.weight)]
    return out


def _weights(weight: Floats) -> list[tuple[Floats, float]]:
    """Channels that have one weight, as 0 and 1, and the weight. With eta 1 and k 0 a channel reflects nothing, so that others'
    weights do not touch it."""
    if np.ptp(weight) == 0:
        return [(np.ones(3), float(weight[0]))]
    return [(one, float("%.9g" % share)) for one, share in zip(np.eye(3), weight) if share > 0]


def _list(values: Floats) -> list[float]:
    return [float("%.9g" % one) for one in values]


_BLENDER = '''
import bpy

PARTS = %s


def material(name="%s"):
    """The sum of PARTS as a material of nodes."""
    made = bpy.data.materials.new(name)
    if made.node_tree is None:
        made.use_nodes = True
    tree = made.node_tree
    tree.nodes.clear()
    total = None
    for part in PARTS:
        node = tree.nodes.new("ShaderNodeBsdf" + part["node"])
        for key, value in part.items():
            if key in ("distribution", "fresnel_type"):
                setattr(node, key, value)
            elif key not in ("node", "share"):
                socket = node.inputs[key]
                socket.default_value = (*value, 1.0) if socket.type == "RGBA" else value
        shader = node.outputs[0]
        if "share" in part:  # mixed with nothing
            mix = tree.nodes.new("ShaderNodeMixShader")
            mix.inputs[0].default_value = part["share"]
            tree.links.new(shader, mix.inputs[2])
            shader = mix.outputs[0]
        if total is not None:
            add = tree.nodes.new("ShaderNodeAddShader")
            tree.links.new(total, add.inputs[0])
            tree.links.new(shader, add.inputs[1])
            shader = add.outputs[0]
        total = shader
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    if total is not None:
        tree.links.new(total, output.inputs["Surface"])
    return made
'''


def blender(space: Sum, p: Floats, name: str) -> str:
    """Python for Blender 4.3 and later (its Metallic BSDF)."""
    rows = ",\n    ".join(repr(one) for one in nodes(space, p))
    return (_BLENDER % ("[\n    %s,\n]" % rows if rows else "[]", name)).lstrip("\n")


def cycles(space: Sum, p: Floats, name: str) -> str:
    """<shader> of Cycles' stand-alone program."""
    out, links, last = [], [], ""
    for i, part in enumerate(nodes(space, p)):
        one = "part%d" % (i + 1)
        inputs = "".join(' %s="%s"' % (_CYCLES.get(key, key.lower()), _cycles_value(value))
                         for key, value in part.items() if key not in ("node", "share"))
        out.append('  <%s_bsdf name="%s"%s/>' % (part["node"].lower(), one, inputs))
        socket = one + " bsdf"
        if "share" in part:
            out.append('  <mix_closure name="%s-mix" fac="%.9g"/>' % (one, part["share"]))
            links.append('  <connect from="%s" to="%s-mix closure2"/>' % (socket, one))
            socket = one + "-mix closure"
        if last:
            out.append('  <add_closure name="%s-add"/>' % one)
            links += ['  <connect from="%s" to="%s-add closure1"/>' % (last, one),
                      '  <connect from="%s" to="%s-add closure2"/>' % (socket, one)]
            socket = one + "-add closure"
        last = socket
    links.append('  <connect from="%s" to="output surface"/>' % last)
    return '<shader name="%s">\n%s\n</shader>' % (name, "\n".join(out + links))


_CYCLES = {"Base Color": "base_color", "Edge Tint": "edge_tint", "Extinction": "k", "IOR": "ior"}


def _cycles_value(value: Any) -> str:
    if isinstance(value, str):
        return value.lower()
    return numbers(np.atleast_1d(value))
