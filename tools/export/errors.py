"""make export-errors: what each target makes of materials, against the fit and against the measurement.

    python tools/export/errors.py [--results RESULTS.md] [--model NAME] FILE...

Every file is fitted (--model, default principled and paper), exported to every target that shows BSDFs, and judged by relative
RMS of radiance over the samples of the fit. Where the packages mitsuba and bpy can be imported, those renderers evaluate their
files themselves: Mitsuba at the measurement's directions, Cycles at tilted quads under a sun.

SPDX-License-Identifier: MIT
"""
import argparse
import importlib.util
import pathlib
import re
import sys
import tempfile

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "tools"), str(ROOT / "python" / "src"), str(ROOT / "python" / "tests")]

import brdffit  # noqa: E402
import results  # noqa: E402
from brdffit.export import TARGETS  # noqa: E402
from brdffit.export.places import places  # noqa: E402

BEGIN, END = "<!-- make export-errors: begin (written by tools/export; edit there) -->", "<!-- make export-errors: end -->"
EXACT_DATA = 1e-6  # a fit's relative RMS where the data are its model's own
SHOWN = [one.name for one in TARGETS.values() if one.space not in ("code", "table")]


WORDS = """`make export-errors DATA="dir ..."`: each file is fitted, exported with `--samples` to each target, and judged by
the target's own formulas at the measurement's directions. "fit" is the fit's relative RMS from the measurement; a target's column
has its RMS over that: 1.000 is as good as the fit, less is better. "=": the target has the fit's model, and in brackets is how far
its values are from `predict`. "*": not proven, parameters were moved from a proven fit; "abs.": the relative RMS itself, of data
that the fit's model made. "Itself": the renderer's own values from those that the export was judged by (single precision)."""


def by_mitsuba(path, made, at):
    """Relative RMS of Mitsuba's own values from those that the export was judged by."""
    import mitsuba as mi

    mi.set_variant("scalar_rgb")
    text = re.search(r"<bsdf.*</bsdf>", path.read_text(), re.DOTALL)[0]
    one = mi.load_string(text.replace("<bsdf", '<bsdf version="3.0.0"', 1))
    context, hit, theirs = mi.BSDFContext(), mi.SurfaceInteraction3f(), []
    light, view = at.light[:2000], at.view[:2000]
    for l, v in zip(light, view):
        hit.wi = mi.Vector3f(*v)
        theirs.append(np.array(one.eval(context, hit, mi.Vector3f(*l)), float))
    return apart(np.array(theirs), made.shown.values(light, view))


def by_cycles(path, made, folder):
    """The same of Cycles, at quads."""
    import bpy

    import cycles_probe

    sun = np.array([0.4, 0.3, 0.9]) / np.linalg.norm([0.4, 0.3, 0.9])
    normals = cycles_probe.normals(np.random.default_rng(1), sun)
    names = {"__name__": "one"}
    exec(path.read_text(), names)
    theirs = cycles_probe.render(bpy, names["material"], normals, sun, folder)
    return apart(theirs, made.shown.values(cycles_probe.local(normals, sun), cycles_probe.local(normals, np.array([0.0, 0, 1]))))


def apart(theirs, ours):
    return float(np.sqrt(((theirs - ours) ** 2).sum() / (ours ** 2).sum()))


def material(path, model, folder):
    """One row: the fit's own error, of each target its error and whether it is the fit, and what the renderers say."""
    samples = brdffit.Samples.from_file(path)
    fit = brdffit.fit(samples, model=model)
    at = places(fit, samples, [0, 1, 2])
    row = {"name": path.stem, "fit": at.rms(at.fitted, at.values)}
    for name in SHOWN:
        file = folder / ("one" + TARGETS[name].ending)
        made = fit.export(name, file, samples=samples)
        row[name] = made
        if name == "mitsuba" and importlib.util.find_spec("mitsuba"):
            row["by mitsuba"] = by_mitsuba(file, made, at)
        if name == "blender" and importlib.util.find_spec("bpy"):
            row["by cycles"] = by_cycles(file, made, folder)
    return row


def cell(made, fit):
    """The error over the fit's own; = where the target has the fit's model."""
    if made.exact:
        return "= (%.0e)" % made.from_fit
    return ("%.1e abs.%s" % (made.error, "" if made.certified else "*") if fit < EXACT_DATA else
            "%.3f%s" % (made.error / fit, "" if made.certified else "*"))


def table(rows, model):
    heads = ["material", "fit", *SHOWN, "Mitsuba itself", "Cycles itself"]
    lines = ["| %s |" % " | ".join(heads), "|%s" % ("---|" * len(heads))]
    for row in rows:
        own = ["%.1e" % row[one] if one in row else "–" for one in ("by mitsuba", "by cycles")]
        cells = [cell(row[one], row["fit"]) for one in SHOWN]
        lines.append("| %s |" % " | ".join([row["name"], "%.4f" % row["fit"], *cells, *own]))
    good = {one: sum(row[one].exact or row[one].error <= 1.02 * row["fit"] for row in rows) for one in SHOWN}
    lines += ["", "`%s`: the fit itself, or at most 1.02 of its error, in %d of %d; by target, of %d: %s." % (
        model, sum(good.values()), len(good) * len(rows), len(rows), ", ".join("%s %d" % one for one in good.items())), ""]
    return "\n".join(lines)


def text(tables):
    return "\n".join([BEGIN, "## Exports", "", WORDS, "", *tables, END, ""])


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--results", type=pathlib.Path)
    parser.add_argument("--model", action="append")
    parser.add_argument("paths", nargs="+", type=pathlib.Path)
    o = parser.parse_args()
    files = [file for path in o.paths for file in (sorted(path.glob("*.csv")) if path.is_dir() else [path])]
    tables = []
    with tempfile.TemporaryDirectory() as scratch:
        for model in o.model or ["principled", "paper"]:
            rows = []
            for file in files:
                rows.append(material(file, model, pathlib.Path(scratch)))
                print(model, rows[-1]["name"], file=sys.stderr, flush=True)
            tables.append(table(rows, model))
    print(text(tables))
    if o.results:
        results.put(o.results, text(tables), BEGIN, END)


if __name__ == "__main__":
    main()
