"""Small plots as SVG text that follows the page's colours. SPDX-License-Identifier: MIT"""
from __future__ import annotations

import html
import math
from collections.abc import Callable, Sequence

import numpy as np

from .._arrays import Floats

WIDTH, HEIGHT = 360.0, 240.0
LEFT, RIGHT, TOP, BOTTOM = 52.0, 10.0, 12.0, 36.0


def number(value: float) -> str:
    """A coordinate: tenths of a unit are finer than any screen."""
    return ("%.1f" % value).rstrip("0").rstrip(".") or "0"


def label(value: float) -> str:
    if value == 0:
        return "0"
    text = "%.4g" % value
    return text.replace("e-0", "e-").replace("e+0", "e").replace("-", "−")


def _linear_ticks(low: float, high: float, count: int = 5) -> list[float]:
    step = 10.0 ** math.floor(math.log10((high - low) / count))
    step *= next(m for m in (1, 2, 5, 10) if (high - low) / (step * m) <= count)
    first = math.ceil(low / step - 1e-9)
    return [k * step for k in range(first, math.floor(high / step + 1e-9) + 1)]


def _log_ticks(low: float, high: float) -> list[float]:
    first, last = math.ceil(math.log10(low) - 1e-9), math.floor(math.log10(high) + 1e-9)
    step = max(1, (last - first) // 5 + 1 if last - first > 5 else 1)
    ticks = [10.0**k for k in range(first, last + 1, step)]
    if len(ticks) < 3:
        ticks = [m * 10.0**k for k in range(first - 1, last + 1) for m in (1, 2, 5) if low <= m * 10.0**k <= high]
    return ticks if len(ticks) > 2 else [t for t in _linear_ticks(low, high) if t > 0]


class Axis:
    """Data to screen, linear or logarithmic. `shown` and `back`: another scale to write at the ticks, and its inverse."""

    def __init__(self, low: float, high: float, log: bool = False, shown: Callable[[float], float] | None = None,
                 back: Callable[[float], float] | None = None) -> None:
        if log:
            if not high > low > 0:
                low, high = (low / 2, low * 2) if low > 0 else (0.1, 1.0)
        elif not high > low:
            low, high = low - 0.5, low + 0.5
        self.low, self.high, self.log = low, high, log
        self.start, self.end = 0.0, 1.0
        self._shown, self._back = shown, back

    def place(self, values: Floats | float) -> Floats:
        v = np.asarray(values, dtype=np.float64)
        if self.log:
            with np.errstate(divide="ignore", invalid="ignore"):
                part = (np.log(v) - math.log(self.low)) / (math.log(self.high) - math.log(self.low))
        else:
            part = (v - self.low) / (self.high - self.low)
        return np.asarray(self.start + part * (self.end - self.start))

    def ticks(self) -> list[tuple[float, str]]:
        """Where, and what is written there."""
        make = _log_ticks if self.log else _linear_ticks
        if self._shown is None or self._back is None:
            return [(t, label(t)) for t in make(self.low, self.high)]
        ends = sorted((self._shown(self.low), self._shown(self.high)))
        return [(self._back(t), label(t)) for t in make(*ends)]


class Plot:
    """One set of axes. Everything added is clipped to them."""

    def __init__(self, x: Axis, y: Axis, x_label: str, y_label: str, description: str, height: float = HEIGHT) -> None:
        self.x, self.y, self.height = x, y, height
        x.start, x.end = LEFT, WIDTH - RIGHT
        y.start, y.end = height - BOTTOM, TOP
        self._x_label, self._y_label, self._description = x_label, y_label, description
        self._parts: list[str] = []

    def line(self, x: Floats, y: Floats, kind: str) -> None:
        px, py = self.x.place(x), self.y.place(y)
        good = np.isfinite(px) & np.isfinite(py)
        py = np.clip(py, -1e4, 1e4)
        path, pen = [], "M"
        for i in range(len(px)):
            if good[i]:
                path.append("%s%s %s" % (pen, number(px[i]), number(py[i])))
                pen = "L"
            else:
                pen = "M"
        if path:
            self._parts.append("<path class='%s' d='%s'/>" % (kind, "".join(path)))

    def dots(self, x: Floats, y: Floats, kind: str, radius: float = 2.2) -> None:
        px, py = self.x.place(x), self.y.place(y)
        good = np.isfinite(px) & np.isfinite(py)
        # A dot is a line without length and with round ends: one path for all of them.
        path = "".join("M%s %sh0" % (number(a), number(b)) for a, b in zip(px[good], py[good]))
        if path:
            self._parts.append("<path class='dot %s' stroke-width='%s' d='%s'/>" % (kind, number(2 * radius), path))

    def band(self, low: float, high: float, kind: str) -> None:
        a, b = float(self.x.place(low)), float(self.x.place(high))
        a, b = max(LEFT, a), min(WIDTH - RIGHT, b)
        if b >= a:
            self._parts.append("<rect class='%s' x='%s' y='%s' width='%s' height='%s'/>" % (
                kind, number(a), number(TOP), number(max(b - a, 1)), number(self.height - TOP - BOTTOM)))

    def raw(self, text: str) -> None:
        self._parts.append(text)

    def svg(self) -> str:
        frame = []
        right, bottom = WIDTH - RIGHT, self.height - BOTTOM
        for t, words in self.x.ticks():
            p = number(float(self.x.place(t)))
            frame.append("<path class='grid' d='M%s %sV%s'/><text x='%s' y='%s' text-anchor='middle'>%s</text>" % (
                p, number(TOP), number(bottom), p, number(bottom + 14), words))
        for t, words in self.y.ticks():
            q = float(self.y.place(t))
            frame.append("<path class='grid' d='M%s %sH%s'/><text x='%s' y='%s' text-anchor='end'>%s</text>" % (
                number(LEFT), number(q), number(right), number(LEFT - 5), number(q + 4), words))
        middle = number((TOP + bottom) / 2)
        return ("<svg viewBox='0 0 %s %s' role='img' aria-label='%s'>%s"
                "<svg x='%s' y='%s' width='%s' height='%s' viewBox='%s %s %s %s'>%s</svg>"
                "<path class='frame' d='M%s %sH%sV%sH%sZ'/>"
                "<text x='%s' y='%s' text-anchor='middle'>%s</text>"
                "<text transform='translate(12 %s) rotate(-90)' text-anchor='middle'>%s</text></svg>") % (
            number(WIDTH), number(self.height), html.escape(self._description, quote=True), "".join(frame),
            number(LEFT), number(TOP), number(right - LEFT), number(bottom - TOP), number(LEFT), number(TOP),
            number(right - LEFT), number(bottom - TOP), "".join(self._parts),
            number(LEFT), number(TOP), number(right), number(bottom), number(LEFT),
            number((LEFT + right) / 2), number(self.height - 6), html.escape(self._x_label), middle,
            html.escape(self._y_label))


def polar(curves: Sequence[tuple[Floats, Floats, str]], dots: Sequence[tuple[Floats, Floats, str]], view: float,
          description: str) -> str:
    """Half a disc: angle in degrees from the normal (up), radius in units of the largest; a line towards the viewer, at
    `view` degrees to the left."""
    top = max([float(np.nanmax(r)) for _, r, _ in [*curves, *dots] if len(r)] or [1.0]) or 1.0
    cx, cy, size = WIDTH / 2, 182.0, 150.0
    parts = []

    def at(angle: float, radius: float) -> str:
        a = math.radians(angle)
        return "%s %s" % (number(cx + radius * math.sin(a)), number(cy - radius * math.cos(a)))

    for part in (0.25, 0.5, 0.75, 1.0):
        arc = number(part * size)
        parts.append("<path class='grid' d='M%sA%s %s 0 0 1 %s'/>" % (at(-90, part * size), arc, arc, at(90, part * size)))
    for angle in range(-90, 91, 30):
        x, y = at(angle, size + 15).split()
        parts.append("<path class='grid' d='M%sL%s'/><text x='%s' y='%s' text-anchor='middle'>%s°</text>" % (
            at(angle, 0), at(angle, size), x, number(float(y) + 4), label(angle)))
    # Beside its line, on the side that is free: of a low one above, of a steep one to the left.
    x, y = at(-view + 7 if view > 30 else -view - 6, size * 0.8).split()
    parts.append("<path class='line faint dash' d='M%sL%s'/><text x='%s' y='%s' text-anchor='%s'>view</text>" % (
        at(-view, 0), at(-view, size), x, y, "middle" if view > 30 else "end"))
    for angles, radii, kind in curves:
        points = [at(float(p), float(q)) for p, q in zip(angles, radii / top * size) if math.isfinite(q)]
        if points:
            parts.append("<path class='%s' d='M%s'/>" % (kind, "L".join(points)))
    for angles, radii, kind in dots:
        path = "".join("M%sh0" % at(float(p), float(q)) for p, q in zip(angles, np.maximum(radii, 0) / top * size))
        if path:
            parts.append("<path class='dot %s' stroke-width='4.4' d='%s'/>" % (kind, path))
    parts.append("<text x='%s' y='%s' text-anchor='middle'>outer circle: f_r = %s sr⁻¹</text>" % (
        number(cx), number(cy + 24), label(top)))
    return "<svg viewBox='0 0 %s 214' role='img' aria-label='%s'>%s</svg>" % (
        number(WIDTH), html.escape(description, quote=True), "".join(parts))
