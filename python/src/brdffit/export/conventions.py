"""What each target means by its numbers: the one table of docs/export.md and of the code. SPDX-License-Identifier: MIT

A fit has sigma (alpha of GGX and Beckmann), y with F = 4 y, F0 of Schlick's factor, x of Lambert's term, and a masking. A
target's `space` is which sums of BSDFs it can hold:

    sum         Lambert, GGX and Beckmann lobes, coloured, with F = 1 or, with one weight for all channels, Schlick's
    free        Lambert, GGX and Beckmann lobes with Schlick's F coloured at both ends: the fit itself
    conductor   Lambert, and GGX lobes with the exact Fresnel factor of a conductor
    principled  one GGX lobe and one base colour, as the target's own shading model ties them
    code        the model itself, as a function
    table       its values
"""
from __future__ import annotations

import dataclasses


@dataclasses.dataclass(frozen=True)
class Target:
    """One line of the table.

    alpha: what the target calls roughness, in terms of sigma
    masking: of its lobes; total: whether what it holds must sum to at most 1; lobes: most that it has
    sigma: largest that it takes; ending: of files
    """

    name: str
    title: str
    ending: str
    space: str
    distributions: tuple[str, ...]
    masking: str
    lobes: int
    alpha: str
    fresnel: str
    diffuse: str
    weights: str
    total: bool = False
    sigma: float = 6.0


_BOTH = ("ggx", "beckmann")
_WHOLE = ("any",)

TARGETS = {one.name: one for one in (
    Target("mitsuba", "Mitsuba 3", ".xml", "sum", _BOTH, "smith-separable", 3, "alpha = σ; principled: roughness = √σ",
           "4y in specular_reflectance; Schlick: principled, metallic 1, base_color F0, weight 4y; else eta and k",
           "reflectance = x",
           "blendbsdf: each part divided by its largest channel, which is its weight; x and 4y sum to at most 1", total=True),
    Target("pbrt", "pbrt-v4", ".pbrt", "conductor", ("ggx",), "smith", 3, "roughness = σ, remaproughness false",
           "conductor of eta and k: exact Fresnel factor", "reflectance = x", "mix: as blendbsdf; sum to at most 1",
           total=True),
    Target("cycles", "Cycles (XML of the stand-alone program)", ".xml", "sum", _BOTH, "smith", 3, "roughness = √σ, σ ≤ 1",
           "4y in the colour of glossy; Schlick: metallic, F82, edge tint white; else eta and k",
           "colour = x of diffuse, roughness 0",
           "add; metallic mixed with nothing by its weight", sigma=1.0),
    Target("blender", "Blender (Python, Cycles and EEVEE)", ".py", "sum", _BOTH, "smith", 3, "roughness = √σ, σ ≤ 1",
           "as Cycles", "colour = x of Diffuse BSDF, roughness 0", "as Cycles: Add Shader, Mix Shader", sigma=1.0),
    Target("materialx", "MaterialX", ".mtlx", "free", ("ggx",), "smith", 3, "roughness = (σ, σ)",
           "generalized_schlick_bsdf: color0 = 4y F0, color90 = 4y", "color = x of oren_nayar_diffuse_bsdf, roughness 0",
           "add"),
    Target("openpbr", "OpenPBR 1.1 (MaterialX)", ".mtlx", "principled", ("ggx",), "smith", 1, "specular_roughness = √σ, σ ≤ 1",
           "metal: F82, base_color = F0, specular_weight; dielectric: exact, specular_ior, specular_color",
           "base_color, less what the lobe reflects", "base_metalness mixes", sigma=1.0),
    Target("gltf", "glTF 2.0 (KHR_materials_specular)", ".gltf", "principled", ("ggx",), "smith", 1,
           "roughnessFactor = √σ, σ ≤ 1", "Schlick, F0 = 0.04 specularColorFactor, specularFactor times all of it",
           "baseColorFactor, less the largest channel of F", "metallicFactor mixes", sigma=1.0),
    Target("usd", "USD (UsdPreviewSurface)", ".usda", "principled", ("ggx",), "smith", 1, "roughness = √σ, σ ≤ 1",
           "Schlick, specularColor = F0, white at grazing angles", "diffuseColor, less what the lobe reflects",
           "useSpecularWorkflow 1", sigma=1.0),
    Target("osl", "Open Shading Language", ".osl", "free", ("ggx", "beckmann"), "smith", 3, "alpha = σ",
           "generalized_schlick_bsdf: f0 = F0, f90 = 1, tint 4y", "x times oren_nayar_diffuse_bsdf, roughness 0",
           "closures add"),
    Target("glsl", "GLSL", ".glsl", "code", _WHOLE, "any", 3, "σ", "any", "any", "values as they are"),
    Target("hlsl", "HLSL", ".hlsl", "code", _WHOLE, "any", 3, "σ", "any", "any", "values as they are"),
    Target("merl", "MERL table", ".binary", "table", _WHOLE, "any", 3, "–", "any", "any",
           "f_r at the edges of 90 x 90 x 180 bins"),
    Target("rgl", "RGL tensor file", ".bsdf", "table", _WHOLE, "any", 3, "–", "any", "any",
           "f_r (n.v) over 72 x 72 half vectors for each of 16 angles of light"),
)}
