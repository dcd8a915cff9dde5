"""Tiles shared out among threads, with progress told and Ctrl-C heard in the thread of the caller.

SPDX-License-Identifier: MIT
"""
from __future__ import annotations

import dataclasses
import threading
import time
from collections.abc import Callable, Sequence
from typing import Protocol

from ..progress import Bar, check_progress

# Seconds between two looks at how far the threads are.
_PERIOD = 0.1


@dataclasses.dataclass(frozen=True)
class MapProgress:
    """A moment of a map's fit: texels done, of how many, and texels a second so far."""

    done: int
    total: int
    rate: float


MapCallback = Callable[[MapProgress], bool | None]
MapProgressArgument = MapCallback | bool | None


class TileWorker(Protocol):
    """One thread's memory. `fit` may be called by one thread at a time, and returns whether the tile is done."""

    def fit(self, first: int, count: int) -> bool: ...


class Teller:
    """Tells the listener, if there is one; whether it wants to stop."""

    def __init__(self, progress: MapProgressArgument, total: int) -> None:
        check_progress(progress)
        self._call = progress if callable(progress) else None
        self._bar = Bar(total, "texel") if progress is True else None
        self._total, self._began = total, time.perf_counter()
        self.listens = self._call is not None or self._bar is not None

    def tell(self, done: int) -> bool:
        seconds = time.perf_counter() - self._began
        if self._bar is not None:
            self._bar.update(done)
        if self._call is None:
            return False
        return bool(self._call(MapProgress(done, self._total, done / seconds if seconds > 0 else 0.0)))

    def close(self) -> None:
        if self._bar is not None:
            self._bar.close()


class Pool:
    """Threads that take tiles in order. Once stopped, each ends with the tile that it has."""

    def __init__(self, tiles: Sequence[tuple[int, int]]) -> None:
        self.done = [False] * len(tiles)
        self.texels = 0
        self.tiles = tiles
        self._next, self._running = 0, 0
        self._stop = False
        self._error: BaseException | None = None
        self._changed = threading.Condition()

    def stop(self) -> None:
        self._stop = True

    def stopped(self) -> bool:
        return self._stop

    def _work(self, worker: TileWorker) -> None:
        try:
            while True:
                with self._changed:
                    tile = self._next
                    if self._stop or tile >= len(self.tiles):
                        break
                    self._next += 1
                if worker.fit(*self.tiles[tile]):
                    with self._changed:
                        self.done[tile] = True
                        self.texels += self.tiles[tile][1]
        except BaseException as error:  # raised again by run(), in the thread of the caller
            self._error = self._error or error
            self._stop = True
        finally:
            with self._changed:
                self._running -= 1
                self._changed.notify_all()

    def run(self, workers: Sequence[TileWorker], teller: Teller) -> None:
        """Until every tile is done, an error, an exception in the caller's thread (Ctrl-C), or the listener's wish."""
        threads = [threading.Thread(target=self._work, args=(worker,), daemon=True) for worker in workers]
        self._running = len(threads)
        started = 0
        try:
            for thread in threads:
                thread.start()
                started += 1
            self._watch(teller)
        except BaseException:
            self._stop = True
            raise
        finally:
            for thread in threads[:started]:
                thread.join()
        if self._error is not None:
            raise self._error

    def _watch(self, teller: Teller) -> None:
        while True:
            with self._changed:
                if self._running > 0:
                    self._changed.wait(_PERIOD)
                running, done = self._running, self.texels
            if teller.listens and teller.tell(done):
                self._stop = True
            if running == 0:
                return


def tiles_of(count: int, size: int) -> list[tuple[int, int]]:
    return [(first, min(size, count - first)) for first in range(0, count, size)]
