"""Families of problems that strain double arithmetic: members are random, and the same from the same seed.

A case is the model's own a, b, c with radiance, so that every number of it is an exact double and the references
solve the very problem that the library is given. SPDX-License-Identifier: MIT
"""
import dataclasses
import zlib

import numpy as np

SIGMA_RANGE = (1e-12, 6.0)
EXPONENT_RANGE = (0.1, 1e7)


@dataclasses.dataclass
class Case:
    family: str
    name: str
    lobes: int
    distribution: str
    a: np.ndarray
    b: np.ndarray
    c: np.ndarray
    values: np.ndarray  # samples x channels
    weights: np.ndarray | None = None
    normalise: str = "max"
    truth: tuple = ()  # values of s = 1/sigma^2 or n, for starts of the reference
    twin: str = ""  # another case whose box count this one is compared with

    def write(self, path):
        with open(path, "w", encoding="ascii") as out:
            out.write("a,b,c" + (",weight" if self.weights is not None else "") +
                      "".join(f",v{k}" for k in range(self.values.shape[1])) + "\n")
            for i in range(len(self.a)):
                row = [self.a[i], self.b[i], self.c[i]] + ([] if self.weights is None else [self.weights[i]])
                out.write(",".join("%.17g" % v for v in [*row, *self.values[i]]) + "\n")


def by_exponent(distribution):
    return distribution == "blinn-phong"


def shape(distribution, c, s):
    """The lobe without b and without its scalar factor."""
    return (1 + c * s) ** -2.0 if distribution == "ggx" else np.exp(-np.minimum(c * s, 745.0))


class Maker:
    """Draws the members of one family."""

    def __init__(self, family, lobes, distribution, member, members):
        self.family, self.lobes, self.distribution = family, lobes, distribution
        self.member, self.members = member, members
        self.random = np.random.default_rng([zlib.crc32(family.encode()), lobes, zlib.crc32(distribution.encode()), member])
        self.channels = 1 + member % 3

    @property
    def share(self):
        """0 for the first member of the family, 1 for the last."""
        return self.member / max(self.members - 1, 1)

    def lobe_s(self):
        sigma = np.sort(np.exp(self.random.uniform(np.log(0.04), np.log(0.6), self.lobes)))
        return 1 / sigma ** 2

    def geometry(self, count=28):
        """Like a goniometer's: c from 0 to a few, some of them shared."""
        r = self.random
        alpha = np.concatenate([[0.0], r.uniform(0.01, 1.1, count - 5), [0.02, 0.02, 0.3, 0.3]])
        c = np.tan(alpha) ** 2
        return r.uniform(0.15, 0.32, count), r.uniform(0.2, 0.6, count) / np.cos(alpha) ** 4, c

    def values(self, a, b, c, s, noise, heights=None):
        """Data of lobes at s, each about as high as the diffuse term, with noise relative to the largest value."""
        r, out = self.random, []
        for _ in range(self.channels):
            v = a / a.max() * r.uniform(0.1, 0.5)
            for p, one in enumerate(s):
                g = b * shape(self.distribution, c, one)
                v = v + g / g.max() * (r.uniform(0.2, 1.0) if heights is None else heights[p])
            out.append(v + noise * v.max() * r.normal(size=len(v)))
        return np.stack(out, 1)

    def case(self, a, b, c, values, s=(), **more):
        name = f"{self.family}_{self.distribution}_{self.lobes}_{self.member:03d}"
        return Case(self.family, name, self.lobes, self.distribution, a, b, c, values, truth=tuple(s), **more)


def ordinary(m):
    a, b, c = m.geometry()
    s = m.lobe_s()
    return m.case(a, b, c, m.values(a, b, c, s, 10 ** m.random.uniform(-3, -1)), s)


def kappa(m):
    """The lobe's column within 1e-1 ... 1e-15 of the diffuse one (1 - kappa), all c alike but for that much."""
    a, b, c = m.geometry()
    apart = 10 ** (-1 - 14 * m.share)
    c = c / c.max() * np.sqrt(apart)
    b = a * m.random.uniform(0.5, 2)
    s = 1 / m.random.uniform(0.6, 3, m.lobes) ** 2
    return m.case(a, b, c, m.values(a, b, c, s, 10 ** m.random.uniform(-8, -2)), s)


def roughness(m):
    """True sigma from 1e-12 to 6 with directions that resolve it: c in proportion."""
    a, b, c = m.geometry()
    low, high = np.log(1e-12), np.log(6.0)
    sigma = np.exp(low + (high - low) * m.share) * np.array([1.0, m.random.uniform(2, 10)][:m.lobes])
    sigma = np.minimum(sigma, 6.0)
    c = c * sigma[0] ** 2 * 4
    s = 1 / sigma ** 2
    return m.case(a, b, c, m.values(a, b, c, s, 10 ** m.random.uniform(-4, -2)), s)


def equal_lobes(m):
    """Two lobes whose sigma agree to 1e-1 ... 1e-12."""
    a, b, c = m.geometry()
    s = m.lobe_s()
    s = s[0] * np.array([1.0, (1 + 10 ** (-1 - 11 * m.share)) ** -2][:m.lobes])
    noise = 10 ** m.random.uniform(-14, -2)
    return m.case(a, b, c, m.values(a, b, c, s, noise), s)


def scales(m):
    """Columns and data times 10^(-100 ... 100), each its own."""
    a, b, c = m.geometry()
    s = m.lobe_s()
    v = m.values(a, b, c, s, 10 ** m.random.uniform(-3, -1))
    e = m.random.choice([-100.0, 100.0], 2) if m.member % 2 else m.random.uniform(-100, 100, 2)
    v = v * 10.0 ** m.random.choice([-100.0, 100.0, m.random.uniform(-100, 100)], m.channels)
    return m.case(a * 10.0 ** e[0], b * 10.0 ** e[1], c, v, s)


def residuals(m):
    """Noise from 1 down to 1e-16 of the data, and 0."""
    a, b, c = m.geometry()
    s = m.lobe_s()
    noise = 0.0 if m.member == m.members - 1 else 10 ** (-16 * m.share)
    return m.case(a, b, c, m.values(a, b, c, s, noise), s)


def mirror(m):
    """One sample at the mirror direction 1e9 times the rest."""
    a, b, c = m.geometry()
    s = m.lobe_s()
    v = m.values(a, b, c, s, 10 ** m.random.uniform(-3, -1))
    v[0] *= 10.0 ** (9 if m.member % 2 else m.random.uniform(3, 9))
    return m.case(a, b, c, v, s)


def subnormal(m):
    """Subnormal values, coefficients or differences of c beside ordinary ones; data near the smallest allowed."""
    a, b, c = m.geometry()
    s = m.lobe_s()
    v = m.values(a, b, c, s, 10 ** m.random.uniform(-3, -1))
    where, kind = m.random.random(len(a)) < 0.3, m.member % 4
    tiny = m.random.uniform(0, 2e-308, len(a))
    if kind == 0:
        v[where] = tiny[where, None]
    elif kind == 1:
        v *= 1e-303
    elif kind == 2:
        c = np.where(where, tiny, c)
    else:
        a = np.where(where, tiny, a)
        c = np.where(m.random.random(len(a)) < 0.1, tiny, c)
    return m.case(a, b, c, v, s)


def goniometer():
    """The paper's 84 directions: a, b, c of Beckmann, which serve for every distribution here."""
    view, azimuth, light = (v.ravel() for v in np.meshgrid(*map(np.radians, (
        [0, 20, 40, 60], [0, 90, 180], [0, 10, 20, 30, 40, 50, 60])), indexing="ij"))
    h = np.stack([np.sin(light) * np.cos(azimuth) - np.sin(view), np.sin(light) * np.sin(azimuth),
                  np.cos(light) + np.cos(view)])
    nl, nv, nh, vh = np.cos(light), np.cos(view), h[2] / np.sqrt((h ** 2).sum(0)), np.sqrt((h ** 2).sum(0)) / 2
    masking = np.minimum(1, 2 * nh * np.minimum(nl, nv) / vh)
    c = (h[0] ** 2 + h[1] ** 2) / h[2] ** 2
    return nl / np.pi, masking / (np.pi * nv * nh ** 4), np.where(c < 1e-20, 0, c)


def near_exact(m):
    """Two lobes 3 to 30 % apart and E^2 of 1e-12 ... 1e-9 of the data: hardly above the absolute gap, hard to tell."""
    a, b, c = goniometer()
    m.channels = 3
    sigma = 10 ** m.random.uniform(-1.4, -0.9) * np.array([1.0, m.random.uniform(1.03, 1.3)])
    s = 1 / sigma[:m.lobes] ** 2
    return m.case(a, b, c, m.values(a, b, c, s, 10 ** m.random.uniform(-5.5, -4.2)), s)


def noisy_c(m):
    """c of 1e-33 where 0 is meant, beside a twin with 0: the domain is longer by far, the answer the same."""
    member, m.member = m.member, m.member // 2
    twin = Maker(m.family, m.lobes, m.distribution, m.member, m.members)
    a, b, c = twin.geometry()
    s = twin.lobe_s()
    v = twin.values(a, b, c, s, 10 ** twin.random.uniform(-3, -2))
    c[[3, 4]] = 0.0
    m.member = member
    if member % 2:
        c[[3, 4]] = twin.random.uniform(0.1, 1, 2) * 1e-33
    made = m.case(a, b, c, v, s)
    if member % 2:
        made.twin = made.name[:-3] + f"{member - 1:03d}"
    return made


def weights(m):
    """Weights over 10^(-60 ... 60), some zero; some data negative."""
    a, b, c = m.geometry()
    s = m.lobe_s()
    v = m.values(a, b, c, s, 10 ** m.random.uniform(-3, 0))
    w = 10.0 ** m.random.uniform(-6, 6, len(a)) * 10.0 ** m.random.uniform(-54, 54)
    w[m.random.random(len(a)) < 0.1] = 0.0
    return m.case(a, b, c, v, s, weights=w)


def no_mirror(m):
    """No sample near the mirror direction, and the one nearest to it bright: the best lobe sits at the end of finite y."""
    a, b, c = m.geometry()
    c = c + 10 ** m.random.uniform(-3, 0)
    s = m.lobe_s()
    v = m.values(a, b, c, s, 10 ** m.random.uniform(-3, -1))
    if m.member % 2:
        v[np.argmin(c)] *= 10 ** m.random.uniform(0.5, 3)
    return m.case(a, b, c, v, s)


def few(m):
    """Two to five samples, or all c equal: more unknowns than data, collinear columns."""
    count = 2 + m.member % 4
    a, b, c = m.geometry(8)
    c = np.full(8, c[2]) if m.member % 3 == 0 else c
    a, b, c = a[:count], b[:count], c[:count]
    s = m.lobe_s()
    return m.case(a, b, c, m.values(a, b, c, s, 0.1), s)


def own_units(m):
    """Minimised in the data's own units, 1e-100 ... 1e100, channels 1e30 apart."""
    a, b, c = m.geometry()
    s = m.lobe_s()
    v = m.values(a, b, c, s, 10 ** m.random.uniform(-3, -1)) * 10.0 ** m.random.uniform(-100, 100)
    return m.case(a, b, c, v * 10.0 ** m.random.uniform(-15, 15, m.channels), s, normalise="none")


FAMILIES = {
    "ordinary": (ordinary, "noise 10⁻³ to 10⁻¹"),
    "kappa": (kappa, "1 − κ from 10⁻¹ to 10⁻¹⁵"),
    "roughness": (roughness, "σ from 10⁻¹² to 6"),
    "equal_lobes": (equal_lobes, "lobes equal to 10⁻¹ … 10⁻¹²"),
    "scales": (scales, "columns and data × 10^±100"),
    "residuals": (residuals, "noise 1 down to 10⁻¹⁶, and 0"),
    "mirror": (mirror, "one mirror sample up to 10⁹ × the rest"),
    "subnormal": (subnormal, "subnormal values, a and c; data × 10⁻³⁰³"),
    "near_exact": (near_exact, "E²/T of 10⁻¹² to 10⁻⁹, close lobes"),
    "noisy_c": (noisy_c, "c = 10⁻³³ where 0 is meant"),
    "weights": (weights, "weights over 10^±60, some 0"),
    "no_mirror": (no_mirror, "no sample near the mirror, the nearest bright"),
    "few": (few, "2 to 5 samples, equal c"),
    "own_units": (own_units, "own units, 10^±115"),
}
DISTRIBUTIONS = ("beckmann", "ggx", "blinn-phong")


def make(families, members, lobes=(1, 2), distributions=DISTRIBUTIONS):
    return [FAMILIES[f][0](Maker(f, p, d, i, members))
            for f in families for d in distributions for p in lobes for i in range(members)]
