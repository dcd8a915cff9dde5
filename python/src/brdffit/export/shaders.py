"""The model as functions of GLSL, HLSL and OSL, made from the C header's own text. SPDX-License-Identifier: MIT

include/brdffit_shade/lobes.h and sample.h are written in what these languages share. Here their functions are cut apart, those
that a fit needs are kept, and REAL, FN(), LIT() and the names of the mathematical functions are replaced; what is written anew is
the sum over the fit's own columns. Draws choose a lobe by its estimated albedo, the same for every viewer.
"""
from __future__ import annotations

import importlib.resources
import math
import pathlib
import re
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from .fitted import Fit
from .spaces import Free


class Language(NamedTuple):
    """Words that differ."""

    colour: str
    vector: str
    erf: bool  # built in
    head: str
    argument: str  # how a vector is taken


LANGUAGES = {
    "glsl": Language("vec3", "vec3", False, "", "vec3"),
    "hlsl": Language("float3", "float3", False, "", "float3"),
    "osl": Language("color", "vector", True, '#include "stdosl.h"\n\n', "vector"),
}

# Abramowitz and Stegun 7.1.26: 1.5e-7.
_ERF = """float brdffit_erf(float x)
{
    float size = abs(x), t = 1.0 / (1.0 + 0.3275911 * size);
    float p = t * (0.254829592 + t * (-0.284496736 + t * (1.421413741 + t * (-1.453152027 + t * 1.061405429))));
    float value = 1.0 - p * exp(-(size * size));

    return x < 0.0 ? -value : value;
}
"""


def _source(name: str) -> str:
    """A header: in the package, or in the tree that it is run from."""
    packed = importlib.resources.files("brdffit") / "_shade" / name
    if packed.is_file():
        return packed.read_text(encoding="utf-8")
    return (pathlib.Path(__file__).resolve().parents[4] / "include" / "brdffit_shade" / name).read_text(encoding="utf-8")


def functions() -> dict[str, str]:
    """Structures and functions of the headers by name, in their order, in C."""
    out = {}
    for name in ("lobes.h", "sample.h"):
        for block in re.split(r"\n\n(?=(?:/\*.*?\*/\n)?(?:SHADE_|struct FN))", _source(name), flags=re.DOTALL):
            found = re.search(r"^(?:SHADE_\w+ (?:REAL|struct FN\(\w+\)) |struct )FN\((\w+)\)", block, re.MULTILINE)
            if found:
                start = block.index(found[0])
                out[found[1]] = block[start:block.index("\n}", start) + (3 if block[start:].startswith("struct") else 2)]
    return out


def translated(text: str, language: Language) -> str:
    """One of them in another language."""
    text = re.sub(r"^struct FN\((\w+)\) \{", r"struct brdffit_\1 {", text, flags=re.MULTILINE)
    text = re.sub(r"struct FN\((\w+)\)", r"brdffit_\1", text)
    text = re.sub(r"FN\((\w+)\)", r"brdffit_\1", re.sub(r"SHADE_\w+ ", "", text))
    text = re.sub(r"LIT\(([^()]*)\)", r"\1", text)
    words = {"REAL": "float", "SQRT": "sqrt", "EXP": "exp", "LOG": "log", "ATAN": "atan", "SIN": "sin", "COS": "cos",
             "ERF": "erf" if language.erf else "brdffit_erf"}
    return re.sub(r"\b(%s)\b" % "|".join(words), lambda m: words[m[1]], text)


def _needed(body: str) -> list[str]:
    """Names that a text calls, and what those call, in the headers' order."""
    known, found, queue = functions(), set(), [body]
    while queue:
        for name in re.findall(r"(?:brdffit_|FN\()(\w+)", queue.pop()):
            if name in known and name not in found:
                found.add(name)
                queue.append(known[name])
    return [name for name in known if name in found]


# ---- The fit's own columns -----------------------------------------------------


def _number(value: float) -> str:
    text = "%.9g" % value
    return text if "." in text or "e" in text else text + ".0"


class _Writer:
    """Expressions of one fit."""

    def __init__(self, fit: Fit, chosen: list[int], language: Language) -> None:
        self.fit, self.chosen, self.language = fit, chosen, language
        self.s = [_number(1 / one ** 2) for one in fit.sigma]

    def colour(self, values: Sequence[float]) -> str:
        return "%s(%s)" % (self.language.colour, ", ".join(map(_number, values)))

    def _side(self, name: str, p: int, which: str) -> str:
        return "brdffit_side_%s(a.n%s, a.sin2_%s, %s)" % (name, which, which, self.s[p])

    def lobe(self, p: int) -> str:
        name = self.fit.distributions[p].replace("-", "_")
        normals = "brdffit_%s(a, %s)" % (name, self.s[p])
        if name not in ("ggx", "beckmann"):
            return normals
        masking = {"v-cavity": "brdffit_v_cavity(a)", "none": "1.0 / a.nv"}.get(self.fit.masking)
        if masking is None:
            masking = "brdffit_%s(a, %s, %s)" % (
                self.fit.masking.replace("-", "_"), self._side(name, p, "l"), self._side(name, p, "v"))
        return "%s * (%s)" % (normals, masking)

    def pdf(self, p: int) -> str:
        name = self.fit.distributions[p].replace("-", "_")
        if name in ("ggx", "beckmann"):
            return "brdffit_pdf_visible(brdffit_%s(a, %s), a.nv, %s)" % (name, self.s[p], self._side(name, p, "v"))
        return "brdffit_pdf_%s(a, %s)" % ("cos_power" if name in ("blinn_phong", "ashikhmin_shirley") else name, self.s[p])

    def draw(self, p: int) -> str:
        name = self.fit.distributions[p].replace("-", "_")
        if name in ("lafortune", "retro"):
            return "brdffit_sample_%s(w, %s, u1, u2)" % (name, self.s[p])
        if name in ("ggx", "beckmann"):
            return "brdffit_mirrored(w, brdffit_visible_%s(w, %s, u1, u2))" % (name, self.s[p])
        kind = "cos_power" if name in ("blinn_phong", "ashikhmin_shirley") else name
        return "brdffit_mirrored(w, brdffit_half_%s(%s, u1, u2))" % (kind, self.s[p])

    def diffuse(self) -> list[tuple[str, list[float]]]:
        x = [float(one) for one in np.asarray(self.fit.x)[self.chosen]]
        if self.fit.diffuse == "none":
            return []
        names = {"lambert": ["lambert"], "oren-nayar": ["lambert", "oren_nayar"],
                 "burley": ["burley_0", "burley_1", "burley_2"]}[self.fit.diffuse]
        more = [] if self.fit.x_more is None else np.asarray(self.fit.x_more)[self.chosen].T.tolist()
        return list(zip(names, [x, *more]))

    def shares(self) -> list[float]:
        """Of draws: each lobe, and the diffuse term."""
        y = np.asarray(self.fit.y)[self.chosen]
        f0 = np.ones_like(y) if self.fit.f0 is None else np.asarray(self.fit.f0)[self.chosen]
        factor = [4.0 if name in ("ggx", "beckmann") else 4 * s * s if name == "torrance-sparrow" else 1.0
                  for name, s in zip(self.fit.distributions, self.fit.sigma)]
        part = [*((y * (f0 + (1 - f0) / 21)).sum(0) * factor), sum(sum(x) for _, x in self.diffuse())]
        total = sum(part)
        return [one / total if total > 0 else float(i == len(y[0])) for i, one in enumerate(part)]


def _body(writer: _Writer, of: Language) -> str:
    fit = writer.fit
    take = "brdffit_angles a = brdffit_angles_of(%s, %s);" % tuple(
        "brdffit_direction_of(%s[0], %s[1], %s[2])" % ((one,) * 3) for one in "lv")
    adds = ["        sum += %s * brdffit_%s(a);" % (writer.colour(x), name) for name, x in writer.diffuse()]
    for p in range(fit.lobes):
        y = np.asarray(fit.y)[writer.chosen, p]
        f0 = np.ones_like(y) if fit.f0 is None else np.asarray(fit.f0)[writer.chosen, p]
        grazing = " + %s * w" % writer.colour([float(one) for one in y * (1 - f0)]) if fit.f0 is not None else ""
        adds.append("        sum += (%s%s) * (%s);" % (writer.colour([float(one) for one in y * f0]), grazing, writer.lobe(p)))
    shares = writer.shares()
    density = ["        sum += %s * %s;" % (_number(share), writer.pdf(p)) for p, share in enumerate(shares[:-1])]
    draws, edge = [], 0.0
    for p, share in enumerate(shares[:-1]):
        edge += share
        draws.append("    %sif (u[0] < %s) {\n        d = %s;\n    }" % ("else " if p else "", _number(edge), writer.draw(p)))
    zero = writer.colour([0.0, 0.0, 0.0])
    return """/* f_r (n.l) of unit vectors around +z. */
%(colour)s brdffit_eval(%(argument)s l, %(argument)s v)
{
    %(colour)s sum = %(zero)s;

    if (l[2] > 0.0 && v[2] > 0.0) {
        %(take)s
        float w = brdffit_fifth(a.versine);

%(adds)s
    }
    return sum;
}

/* Density of brdffit_sample, per solid angle. */
float brdffit_pdf(%(argument)s l, %(argument)s v)
{
    float sum = 0.0;

    if (l[2] > 0.0 && v[2] > 0.0) {
        %(take)s

        sum = %(last)s * brdffit_lambert(a);
%(density)s
    }
    return sum;
}

/* A direction of light from three numbers in [0, 1); below the surface nothing is reflected. */
%(vector)s brdffit_sample(%(argument)s v, %(argument)s u)
{
    brdffit_direction w = brdffit_direction_of(v[0], v[1], v[2]);
    float u1 = u[1], u2 = u[2];
    brdffit_direction d = brdffit_sample_diffuse(u1, u2);

%(draws)s
    return %(vector)s(d.x, d.y, d.z);
}
""" % {"colour": of.colour, "vector": of.vector, "argument": of.argument, "zero": zero, "take": take, "adds": "\n".join(adds),
       "last": _number(shares[-1]), "density": "\n".join(density), "draws": "\n".join(draws)}


def code(fit: Fit, chosen: list[int], name: str, comment: Sequence[str]) -> str:
    """The functions brdffit_eval, brdffit_pdf and brdffit_sample of a fit."""
    language = LANGUAGES[name]
    body = _body(_Writer(fit, chosen, language), language)
    parts = [translated(functions()[one], language) for one in _needed(body)]
    if not language.erf and any("brdffit_erf(" in part for part in parts):
        parts.insert(0, _ERF.rstrip())
    head = "/* %s */\n\n" % "\n * ".join(comment)
    return head + language.head + "\n\n".join([*parts, body])


def closures(space: Free, p: object, name: str) -> str:
    """A surface of OSL: closures that path tracers draw from, as Ci and as an output, which Blender's script node takes."""
    values = np.asarray(p)

    def colour(row: object) -> str:
        return "color(%s)" % ", ".join(_number(float(one)) for one in np.asarray(row))

    terms = ["%s * oren_nayar_diffuse_bsdf(N, color(1.0), 0.0)" % colour(values[:3])]
    for distribution, row in zip(space.distributions, values[3:].reshape(-1, 7)):
        total = row[1:4] + row[4:]
        alpha = _number(math.exp(row[0]))
        terms.append("%s * generalized_schlick_bsdf(N, vector(0.0), color(1.0), color(0.0), %s, %s,\n             %s, color(1.0), "
                     '5.0, "%s")' % (colour(total), alpha, alpha, colour(row[1:4] / np.maximum(total, 1e-30)), distribution))
    return "surface %s(output closure color BSDF = 0)\n{\n    BSDF = %s;\n    Ci = BSDF;\n}\n" % (
        re.sub(r"\W", "_", name), "\n         + ".join(terms))


