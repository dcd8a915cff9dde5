"""All jobs of a map that are missing: on the workers of a distributed client, or in threads of this process.

SPDX-License-Identifier: MIT
"""
from __future__ import annotations

import concurrent.futures
import sys
import threading
import uuid
from collections.abc import Callable, Generator, Iterable
from typing import Any

from ..errors import OptionError
from ..maps.pool import Teller
from .job import Tile, TileJob, run_store

# How often a job whose input or output failed (OSError) is tried again, in threads; a client retries whatever failed.
_AGAIN = 2
# Jobs that wait for a thread, for each thread: their values may be views of an array, or to be computed.
_QUEUE = 2

Work = Iterable[tuple[Tile, Any]]  # tiles and their blocks


def find_client(client: Any) -> Any:
    """The client that is meant: the given one, or the active one; None: none, or False was given."""
    if client is False:
        return None
    if client is None:
        if "distributed" not in sys.modules:
            return None
        from distributed import default_client

        try:
            client = default_client()
        except ValueError:
            return None
    if getattr(client, "asynchronous", False):
        raise OptionError("client is asynchronous: make it with asynchronous=False", code="option")
    return client


def run(job: TileJob, work: Work, client: Any, threads: int, retries: int, done: int, teller: Teller,
        texels: Callable[[Tile], int]) -> None:
    """done: texels that were there already. Ends early when the listener wishes so; an error ends it too, and what was
    not begun is cancelled."""
    if teller.listens and teller.tell(done):
        return
    answers = _distributed(job, work, client, retries) if client is not None else _threads(job, work, threads)
    try:
        for tile in answers:
            more = texels(tile)
            done += more
            if more > 0 and teller.listens and teller.tell(done):
                return
    finally:
        answers.close()  # cancels what was not begun


def _distributed(job: TileJob, work: Work, client: Any, retries: int) -> Generator[Tile, None, None]:
    import dask
    from distributed import as_completed

    name = uuid.uuid4().hex[:12]
    # One task of its own, which every tile needs: it travels once, and is there again after a death.
    common = dask.delayed(job, name="brdffit-job-%s" % name, traverse=False)
    run_one = dask.delayed(run_store, pure=False)
    tiles, tasks = [], []
    for tile, block in work:
        tiles.append(tile)
        tasks.append(run_one(common, tile, block, dask_key_name="brdffit-tile-%s-%d" % (name, tile.number)))
    futures = client.compute(tasks, retries=retries)
    tile_of = {future.key: tile for future, tile in zip(futures, tiles)}
    try:
        for future in as_completed(futures):
            future.result()  # raises what the worker did
            yield tile_of[future.key]
            future.release()
    finally:
        client.cancel([future for future in futures if not future.done()])


def _try(job: TileJob, tile: Tile, block: Any, stop: threading.Event) -> None:
    for again in range(_AGAIN + 1):
        try:
            values = block.compute(scheduler="synchronous") if hasattr(block, "__dask_graph__") else block
            job.store(tile, values, stop.is_set)
            return
        except OSError:
            if again == _AGAIN or stop.is_set():
                raise


def _threads(job: TileJob, work: Work, threads: int) -> Generator[Tile, None, None]:
    pool = concurrent.futures.ThreadPoolExecutor(threads)
    waiting: dict[concurrent.futures.Future[None], Tile] = {}
    left = iter(work)
    stop = threading.Event()
    try:
        while True:
            for tile, block in left:
                waiting[pool.submit(_try, job, tile, block, stop)] = tile
                if len(waiting) >= _QUEUE * threads:
                    break
            if not waiting:
                return
            ended, _ = concurrent.futures.wait(waiting, return_when=concurrent.futures.FIRST_COMPLETED)
            for future in ended:
                future.result()
                yield waiting.pop(future)
    finally:
        stop.set()
        pool.shutdown(wait=True, cancel_futures=True)
