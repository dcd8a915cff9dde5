"""brdffit export: a fit as a material of a renderer. SPDX-License-Identifier: MIT"""
from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Sequence

from ..errors import BrdffitError, DataError, FileError
from ..fit import Fit
from ..samples import Samples
from .conventions import TARGETS

FAILURE, USAGE, DATA = 1, 2, 3


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="brdffit export", formatter_class=argparse.RawDescriptionHelpFormatter,
        description="Write a fit as a material. Where the target has the fit's model the export is exact; where it has not,\n"
                    "its own model is fitted to the measurement (--samples), or to the fit, and the error is told here and in\n"
                    "the file. Conventions of each target: docs/export.md.",
        epilog="targets:\n" + "\n".join("  %-10s %s" % (one.name, one.title) for one in TARGETS.values()) +
               "\n\nExit status: 0 done; 1 a file cannot be read or written; 2 wrong usage; 3 the data or the fit cannot be used.")
    parser.add_argument("fit", metavar="FIT.json", help="lines written by 'brdffit fit --json'; - is standard input")
    parser.add_argument("--to", required=True, choices=tuple(TARGETS), metavar="TARGET", help="see below")
    parser.add_argument("-o", "--output", metavar="FILE", help="(default: FIT with the target's ending, in this folder)")
    parser.add_argument("--samples", metavar="FILE", help="the measurement, to fit again where the target lacks the model, and to "
                                                          "tell the error from")
    parser.add_argument("--select", type=int, metavar="N", help="which fit of FIT.json, from 1")
    parser.add_argument("--channels", metavar="R,G,B", help="the channels that are red, green and blue")
    parser.add_argument("--scene", action="store_true", help="mitsuba, blender: a whole scene that renders a sphere of it")
    parser.add_argument("-q", "--quiet", action="store_true", help="write only, say nothing")
    return parser


def main(argv: Sequence[str] | None = None) -> int:
    """Run it, and return the exit status."""
    arguments = _parser().parse_args(argv)
    target = TARGETS[arguments.to]
    output = arguments.output
    if output is None:
        stem = "material" if arguments.fit == "-" else os.path.basename(arguments.fit).split(".")[0]
        output = stem + target.ending
    try:
        fit = _read(arguments.fit, arguments.select)
        samples = None if arguments.samples is None else Samples.from_file(arguments.samples)
        if samples is not None and fit.weighting not in ("none", "column"):
            samples = samples.weighted(fit.weighting)
        names = None if arguments.channels is None else tuple(arguments.channels.split(","))
        made = fit.export(arguments.to, output, samples=samples, channels=names, scene=arguments.scene)
    except BrdffitError as error:
        print("brdffit export: %s" % error, file=sys.stderr)
        return FAILURE if isinstance(error, FileError) else USAGE if error.code == "option" else DATA
    if not arguments.quiet:
        for line in made.lines:
            print("brdffit: " + line, file=sys.stderr)
        print(made.path)
    return 0


def _read(path: str, select: int | None) -> Fit:
    try:
        if path == "-":
            text = sys.stdin.read()
        else:
            with open(path, encoding="utf-8") as file:
                text = file.read()
    except OSError as error:
        raise FileError("cannot be read: %s" % error.strerror, code="open", path=path) from error
    lines = [line for line in text.splitlines() if line.strip()]
    if select is None and len(lines) != 1:
        raise DataError("%d fits: say which one with --select N" % len(lines), code="format", path=path)
    if select is not None and not 1 <= select <= len(lines):
        raise DataError("there is no fit %d among %d" % (select, len(lines)), code="format", path=path)
    return Fit.from_json(lines[(select or 1) - 1])


if __name__ == "__main__":
    sys.exit(main())
