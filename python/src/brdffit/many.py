"""Many fits at once. SPDX-License-Identifier: MIT"""
from __future__ import annotations

import concurrent.futures
import os
from collections.abc import Iterable
from typing import TYPE_CHECKING

from ._arguments import count_of, processors
from .errors import BrdffitError
from .fit import Fit, SamplesLike, run
from .options import FitOptions, Options
from .progress import Bar
from .samples import Samples

if TYPE_CHECKING:
    from typing_extensions import Unpack


def fit_many(samples: Iterable[SamplesLike], *, threads: int | None = None, errors: str = "raise",
             progress: bool = False, **options: Unpack[FitOptions]) -> list[Fit | BrdffitError]:
    """Fit each of many samples (or files) with the same options, in the order given. They may differ in everything;
    where they share their directions, `fit_map` fits one lobe some twenty times faster.

    threads: how many at a time; None: as many as there are processors for this process. The fits have the same bits as one by one.
    errors: "raise" the first one, or "return" the exception in the place of its fit
    progress: show a bar
    """
    if errors not in ("raise", "return"):
        raise ValueError('errors must be "raise" or "return", not %r' % (errors,))
    asked = Options(**options)
    asked._struct()  # wrong options fail here, once
    if isinstance(samples, (str, os.PathLike, Samples)):
        raise TypeError("fit_many takes a list of samples or files, not one %s" % type(samples).__name__)
    items = list(samples)

    def one(item: SamplesLike) -> Fit | BrdffitError:
        try:
            return run(item if isinstance(item, Samples) else Samples.from_file(item), asked, None, None, {})
        except BrdffitError as error:
            if errors == "raise":
                raise
            return error

    out: list[Fit | BrdffitError] = []
    bar = Bar(len(items), "fit") if progress else None
    workers = max(1, min(len(items), count_of("threads", threads, processors())))
    with concurrent.futures.ThreadPoolExecutor(workers) as pool:
        try:
            for done, fit in enumerate(pool.map(one, items), 1):
                out.append(fit)
                if bar is not None:
                    bar.update(done)
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise
        finally:
            if bar is not None:
                bar.close()
    return out
