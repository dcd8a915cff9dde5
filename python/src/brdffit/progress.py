"""How far a search is, and Ctrl-C. SPDX-License-Identifier: MIT"""
from __future__ import annotations

import dataclasses
import sys
import threading
import time
from collections.abc import Callable
from typing import Any

from . import _structs as structs
from .errors import OptionError


@dataclasses.dataclass(frozen=True)
class Progress:
    """A moment of a search: boxes bounded so far, best objective, proven lower bound.

    phase: "reduced" (once, the search starts) or "search"
    """

    phase: str
    boxes: int
    e2: float
    lower_bound: float


ProgressCallback = Callable[[Progress], bool | None]
ProgressArgument = ProgressCallback | bool | None


class Bar:
    """A line on standard error: tqdm's when it is installed, our own when not."""

    def __init__(self, total: int | None = None, unit: str = "box", description: str | None = None) -> None:
        self._total, self._unit, self._last = total, unit, 0
        self._bar: Any = None
        try:
            from tqdm.auto import tqdm
        except ImportError:
            self._name = "" if description is None else description + ": "
        else:
            self._bar = tqdm(total=total, unit=unit, desc=description)

    def update(self, done: int, note: str = "") -> None:
        if self._bar is not None:
            if note:
                self._bar.set_postfix_str(note, refresh=False)
            self._bar.update(done - self._last)
        elif sys.stderr is not None and sys.stderr.isatty():
            of = "" if self._total is None else " of %d" % self._total
            sys.stderr.write("\r\x1b[K%s%d%s %s %s" % (self._name, done, of, self._unit, note))
            sys.stderr.flush()
        self._last = done

    def close(self) -> None:
        if self._bar is not None:
            self._bar.close()
        elif sys.stderr is not None and sys.stderr.isatty() and self._last:
            sys.stderr.write("\r\x1b[K")
            sys.stderr.flush()


def _gap(progress: Progress) -> str:
    if progress.lower_bound > 0:
        return "gap %.2g %%" % (100 * (progress.e2 / progress.lower_bound - 1))
    return "E\u00b2 %.4g" % progress.e2


def check_progress(progress: object) -> None:
    if not (progress is None or isinstance(progress, bool) or callable(progress)):
        raise OptionError("progress must be True, False, None or a function, not %r" % (progress,), code="option")


class Observer:
    """Puts Python's callback into a brdffit_options for the time of a call.

    An exception from the callback, or from a signal's handler (Ctrl-C: Python runs it in the main thread as soon as
    the callback enters Python), stops the search; leaving the context raises it once the C library has returned.
    """

    def __init__(self, progress: ProgressArgument) -> None:
        check_progress(progress)
        self._bar = Bar() if progress is True else None
        self._call: ProgressCallback | None = progress if callable(progress) else None
        self._error: BaseException | None = None
        self._reduced: float | None = None
        # Without a listener only the main thread needs a callback, so that Ctrl-C ends a long search.
        self._main = threading.current_thread() is threading.main_thread()

    def attach(self, options: structs.Options) -> None:
        if self._main or self._call is not None or self._bar is not None:
            self._function = structs.ProgressFunction(self._receive)
            options.progress = self._function

    def __enter__(self) -> None:
        # A handler may raise before the first line of _receive, where nothing can catch it: ctypes hands such an
        # exception to this hook and goes on.
        self._hook = sys.unraisablehook
        if self._main:
            sys.unraisablehook = self._unraisable

    def __exit__(self, *error: object) -> None:
        if self._main:
            sys.unraisablehook = self._hook
        if self._bar is not None:
            self._bar.close()
        raised, self._error = self._error, None
        if raised is not None:
            raise raised

    def _unraisable(self, what: Any) -> None:
        here = threading.current_thread() is threading.main_thread()
        if here and what.exc_value is not None and "ctypes callback" in (what.err_msg or ""):
            self._error = what.exc_value
        else:
            self._hook(what)

    def _receive(self, user: object, progress: Any) -> int:
        try:
            if self._error is not None:
                return 1
            if self._reduced is None:
                self._reduced = time.perf_counter()
            if self._call is None and self._bar is None:
                return 0
            c = progress.contents
            now = Progress(structs.PHASE[c.phase], int(c.boxes), float(c.e2), float(c.lower_bound))
            if self._bar is not None:
                self._bar.update(now.boxes, _gap(now))
            return int(self._call is not None and bool(self._call(now)))
        except BaseException as error:  # KeyboardInterrupt too: raised again by __exit__
            self._error = error
            return 1

    def seconds(self, began: float, ended: float) -> dict[str, float]:
        """Of the reduction and the search; one figure for both where nobody listened."""
        if self._reduced is None:
            return {"search": ended - began}
        return {"reduce": self._reduced - began, "search": ended - self._reduced}
