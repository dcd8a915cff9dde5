"""All jobs of a map that are missing: on the workers of a distributed client, or in threads of this process.

SPDX-License-Identifier: MIT
"""
from __future__ import annotations

import concurrent.futures
import sys
import threading
import uuid
from typing import Any, Callable, Iterator, Sequence

from ._pool import Teller
from ._tile_job import TileJob, run_store
from .errors import OptionError

# How often a job whose input or output failed (OSError) is tried again, in threads; a client retries whatever failed.
_AGAIN = 2
# Jobs that wait for a thread, for each thread: their values may be views of an array, or to be computed.
_QUEUE = 2

Work = tuple[TileJob, Any]  # a job and its block


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


def run(work: Sequence[Work], client: Any, threads: int, retries: int, done: int, teller: Teller,
        each: Callable[[TileJob, list[int]], int]) -> None:
    """`each` takes a job that ended with its row, and returns its texels. Ends early when the listener wishes so; an
    error ends it too, and the jobs that were not begun are cancelled."""
    answers = _distributed(work, client, retries) if client is not None else _threads(work, threads)
    try:
        stop = teller.tell(done) if teller.listens else False
        if stop:
            return
        for job, row in answers:
            done += each(job, row)
            if teller.listens and teller.tell(done):
                return
    finally:
        answers.close()  # type: ignore[attr-defined]  # a generator: cancels what was not begun


def _distributed(work: Sequence[Work], client: Any, retries: int) -> Iterator[tuple[TileJob, list[int]]]:
    import dask
    from distributed import as_completed

    run_name = uuid.uuid4().hex[:12]
    run_one = dask.delayed(run_store, pure=False)
    jobs = [run_one(job, block, dask_key_name="brdffit-tile-%s-%d" % (run_name, job.number)) for job, block in work]
    futures = client.compute(jobs, retries=retries)
    job_of = {future.key: job for future, (job, _) in zip(futures, work)}
    try:
        for future in as_completed(futures):
            yield job_of[future.key], future.result()
            future.release()
    finally:
        client.cancel([future for future in futures if not future.done()])


def _try(job: TileJob, block: Any, stop: threading.Event) -> list[int]:
    for again in range(_AGAIN + 1):
        try:
            values = block.compute(scheduler="synchronous") if hasattr(block, "__dask_graph__") else block
            return job.store(values, stop.is_set)
        except OSError:
            if again == _AGAIN or stop.is_set():
                raise
    raise AssertionError("not reached")


def _threads(work: Sequence[Work], threads: int) -> Iterator[tuple[TileJob, list[int]]]:
    pool = concurrent.futures.ThreadPoolExecutor(threads)
    waiting: dict[concurrent.futures.Future[list[int]], TileJob] = {}
    left = iter(work)
    stop = threading.Event()
    try:
        while True:
            for job, block in left:
                waiting[pool.submit(_try, job, block, stop)] = job
                if len(waiting) >= _QUEUE * threads:
                    break
            if not waiting:
                return
            ended, _ = concurrent.futures.wait(waiting, return_when=concurrent.futures.FIRST_COMPLETED)
            for future in ended:
                yield waiting.pop(future), future.result()
    finally:
        stop.set()
        pool.shutdown(wait=True, cancel_futures=True)
