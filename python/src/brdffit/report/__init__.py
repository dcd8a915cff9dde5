"""brdffit report FILE...: pages that show a fit, its proof and its residuals.

SPDX-License-Identifier: MIT
"""
from __future__ import annotations

import argparse
import os
import pathlib
import re
import sys
import tempfile
from collections.abc import Sequence
from typing import Any
from urllib.parse import quote, unquote

import numpy as np

from .. import _lobes, _terms
from .. import _structs as structs
from .._ffi import library
from .._forms import MODELS
from .._version import __version__
from .._words import readable
from ..errors import BrdffitError, FileError, OptionError
from ..options import Options
from ..progress import Bar
from ..samples import Samples
from ._analysis import Material, measure
from ._index import Failure, Row, index_page, row
from ._page import material_page

__all__ = ["Material", "main", "measure", "page"]

CERTIFIED, FAILURE, USAGE, DATA, OPEN = 0, 1, 2, 3, 4


def page(samples: Samples, name: str, *, lobes: int | Sequence[str] = 1, index: str | None = None,
         models: Sequence[str | Sequence[str]] | None = None, **options: Any) -> str:
    """One material's page as HTML that needs no other file. models: forms to compare on it as well, as of `brdffit.compare`."""
    return material_page(measure(name, samples, options, lobes, models), index)


def _parser() -> argparse.ArgumentParser:
    defaults = Options()
    p = argparse.ArgumentParser(
        prog="brdffit report", description="Fit materials and write HTML pages that show the fits, their proofs and their "
        "residuals: one page a material, and an index. The pages need no other file.",
        epilog="Exit status: 0 every fit is certified, 4 a search stopped before its gap closed, 1 a file or page cannot be "
        "read or written, 2 wrong usage, 3 data that cannot be used.")
    p.add_argument("files", nargs="+", metavar="FILE", help="CSV, TSV or MERL .binary, also .gz; RGL .bsdf; HDF5; zarr")
    p.add_argument("-o", "--output", default="brdffit-report", metavar="DIR", help="where the pages go (%(default)s)")
    p.add_argument("--lobes", type=_lobes_of, default=1, metavar="1|2|3|NAME,...",
                   help="the fit that is shown in detail: how many of --distribution, or what each is (%(default)s)")
    p.add_argument("--distribution", choices=tuple(_lobes.distributions()), default=defaults.distribution)
    for kind, default in _terms.DEFAULTS.items():
        p.add_argument("--" + kind, choices=library().terms[kind], default=default)
    p.add_argument("--norm", choices=structs.NORM, default=defaults.norm)
    p.add_argument("--gap", type=float, default=defaults.relative_gap, metavar="G", help="relative gap on E² (%(default)s)")
    p.add_argument("--max-incidence", default=None, metavar="DEG", type=_degrees,
                   help="skip light further from the normal; off: use all (60; with --fresnel schlick off)")
    p.add_argument("--merl-samples", choices=("84", "table"), default="84",
                   help="which of a MERL table is fitted (%(default)s); of a .bsdf file, table is what was measured; spheres "
                   "always show all of it")
    p.add_argument("--merl-bins", choices=structs.MERL_BINS, default="edge")
    p.add_argument("--values", choices=structs.QUANTITY, help="what a CSV holds")
    p.add_argument("--weight", choices=structs.WEIGHTING,
                   help="what samples count for (those that the file gives, of what a .bsdf file measured solid-angle)")
    p.add_argument("--box-budget", type=int, default=defaults.box_budget, metavar="N")
    p.add_argument("--compare", dest="models", action="store_const", const=",".join(MODELS),
                   help="also say which form of model the data support, of the dozen of brdffit compare")
    p.add_argument("--models", metavar="NAME,...", help="the same, of these forms")
    p.add_argument("-q", "--quiet", action="store_true", help="say nothing but errors")
    p.add_argument("--version", action="version", version="brdffit-report " + __version__)
    return p


def _lobes_of(text: str) -> int | tuple[str, ...]:
    """A number, or names."""
    try:
        found: int | tuple[str, ...] = int(text)
        if found not in range(1, _lobes.MOST + 1):
            raise argparse.ArgumentTypeError("must be 1 to %d, not %s" % (_lobes.MOST, text))
    except ValueError:
        found = tuple(text.split(","))
        try:
            return _lobes.asked(found, None)
        except OptionError as error:
            raise argparse.ArgumentTypeError(str(error)) from error
    return found


def _degrees(text: str) -> float:
    return 90.0 if text == "off" else float(text)


def _read(path: str, arguments: argparse.Namespace) -> Samples:
    samples = _read_unweighted(path, arguments)
    return samples if arguments.weight is None else samples.weighted(arguments.weight)


def _read_unweighted(path: str, arguments: argparse.Namespace) -> Samples:
    samples = Samples.from_file(path)
    if samples.format == "merl":
        return Samples.from_merl(path, samples=arguments.merl_samples, bins=arguments.merl_bins)
    if samples.format == "rgl":
        return samples if arguments.merl_samples == "table" else Samples.from_rgl(path, samples="84")
    if arguments.values is None:
        return samples
    readers = {"hdf5": Samples.from_hdf5, "zarr": Samples.from_zarr}
    return readers.get(samples.format or "", Samples.from_csv)(path, quantity=arguments.values)


def _write(path: pathlib.Path, text: str) -> None:
    """Whole or not at all."""
    handle, name = tempfile.mkstemp(dir=path.parent, prefix=".brdffit-")
    try:
        with open(handle, "w", encoding="utf-8") as file:
            file.write(readable(text))
        os.chmod(name, 0o666 & ~_umask())
        os.replace(name, path)
    except BaseException:
        os.unlink(name)
        raise


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask


def _page_name(name: str, taken: set[str]) -> str:
    """A file name that any server takes; never one twice, never the index's."""
    base = re.sub(r"[^\w.-]+", "_", name) or "material"
    candidate, count = base, 1
    while candidate.lower() in taken:
        count += 1
        candidate = "%s-%d" % (base, count)
    taken.add(candidate.lower())
    return candidate + ".html"


def _material_name(path: str) -> str:
    name = os.path.basename(path)
    return re.sub(r"\.(csv|tsv|txt|binary|bsdf|h5|hdf5|zarr)$", "", re.sub(r"\.gz$", "", name)) or name


def main(argv: Sequence[str] | None = None) -> int:
    parser = _parser()
    arguments = parser.parse_args(argv)
    try:
        names = _lobes.asked(arguments.lobes, arguments.distribution)
    except OptionError as error:
        parser.error(str(error))
    many = len(arguments.files) > 1
    bar = Bar(len(arguments.files), "page") if not arguments.quiet and sys.stderr.isatty() else None
    batch = _Batch(arguments, pathlib.Path(arguments.output))
    try:
        batch.folder.mkdir(parents=True, exist_ok=True)
        for done, path in enumerate(arguments.files, 1):
            batch.take(path)
            if bar is not None:
                bar.update(done)
        if many:
            _write(batch.folder / "index.html", index_page(batch.rows, batch.failures, _lobes.letters(names)))
    except OSError as error:
        print("brdffit report: %s" % error, file=sys.stderr)
        return FAILURE
    finally:
        if bar is not None:
            bar.close()
    if (batch.rows or many) and not arguments.quiet:
        print(readable(str(batch.folder / ("index.html" if many else unquote(batch.rows[0].link)))))
    return batch.code


class _Batch:
    """File after file; one that cannot be read or fitted does not stop the others."""

    def __init__(self, arguments: argparse.Namespace, folder: pathlib.Path) -> None:
        self._arguments, self.folder = arguments, folder
        self._options = {"distribution": arguments.distribution, "norm": arguments.norm, "relative_gap": arguments.gap,
                         "max_incidence": arguments.max_incidence, "box_budget": arguments.box_budget,
                         **{kind: getattr(arguments, kind) for kind in _terms.DEFAULTS}}
        self.code, self._taken = CERTIFIED, {"index"}
        self.rows: list[Row] = []
        self.failures: list[Failure] = []

    def take(self, path: str) -> None:
        name = _material_name(path)
        try:
            material = measure(name, _read(path, self._arguments), self._options, self._arguments.lobes,
                               None if self._arguments.models is None else self._arguments.models.split(","))
            text = material_page(material, "index.html" if len(self._arguments.files) > 1 else None)
            kept = row("", name, material)
        except BrdffitError as error:
            self._fail(path, str(error), FAILURE if isinstance(error, FileError) else USAGE if error.code == "option" else DATA)
        except (ArithmeticError, LookupError, MemoryError, ValueError, np.linalg.LinAlgError) as error:
            # A page that cannot be drawn is our mistake, and still no reason to withhold the others.
            self._fail(path, "%s: its page could not be made: %s: %s" % (path, type(error).__name__, error), FAILURE)
        else:
            link = _page_name(name, self._taken)
            kept.link = quote(link)
            _write(self.folder / link, text)
            self.rows.append(kept)
            self.code = _worse(self.code, CERTIFIED if kept.certified else OPEN)

    def _fail(self, path: str, message: str, code: int) -> None:
        print("brdffit report: %s" % readable(message), file=sys.stderr)
        self.failures.append(Failure(path, message.removeprefix(path + ": ")))
        self.code = _worse(self.code, code)


def _worse(a: int, b: int) -> int:
    order = (FAILURE, USAGE, DATA, OPEN, CERTIFIED)
    return min(a, b, key=order.index)
