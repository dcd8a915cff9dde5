#!/usr/bin/env python3
"""A map on a cluster of processes, one of which is killed, beside the same map in one process: the same bits?

    map_cluster.py [--size 512] [--lobes 1|2] [--tile 65536] [--workers 2] [--folder DIR]

Makes a synthetic stack, 84 samples RGB, float32, in a zarr array; fits it in this process from memory and from zarr to
zarr in threads, then from zarr to zarr on a LocalCluster of single-threaded workers. As soon as a worker is seen in the
middle of a tile it is killed (SIGKILL). Prints how far it is, times, which tiles were fitted again, and compares every
bit of every map. Ends with status 1 when one differs or more than the dead worker's tile was fitted again.

Needs the package with its extra: pip install './python[dask]'. SPDX-License-Identifier: MIT
"""
import argparse
import collections
import functools
import os
import pathlib
import shutil
import signal
import sys
import tempfile
import time

import numpy as np
import zarr

import brdffit
import brdffit.dask
from brdffit.outofcore.tiles import TILE_TEXELS

FIELDS = ("sigma", "x", "y", "channel_scale", "e2", "lower_bound", "sum_of_squares", "status", "stop", "where", "boxes")
CHUNK = 64
PATIENCE = 120


def lobe(light, view, sigma):
    """Beckmann's lobe of every sample and texel, as f_r."""
    half = light + view
    half /= np.linalg.norm(half, axis=1, keepdims=True)
    cos, nl, nv, vh = half[:, 2], light[:, 2], view[:, 2], (view * half).sum(1)
    shadow = np.minimum(1, 2 * cos * np.minimum(nv, nl) / vh)
    factor, tan2 = shadow / (np.pi * nv * nl * cos**4), 1 / cos**2 - 1
    return factor[:, None] / sigma**2 * np.exp(-tan2[:, None] / sigma**2)


def make(path, size, lobes):
    """Materials that vary from texel to texel, with 1 % noise; written a row of chunks at a time."""
    light, view = brdffit.protocol84()
    stack = zarr.create_array(path, shape=(len(light), size, size, 3), chunks=(len(light), CHUNK, CHUNK, 3), dtype="f4")
    rng = np.random.default_rng(1)
    for row in range(0, size, CHUNK):
        texels = min(CHUNK, size - row) * size
        values = np.broadcast_to(rng.uniform(0.1, 0.5, (texels, 3)) / np.pi, (len(light), texels, 3)).copy()
        for p in range(lobes):
            sigma = rng.uniform(0.08, 0.2, texels) if p == 0 else rng.uniform(0.35, 0.6, texels)
            values += lobe(light, view, sigma)[:, :, None] * rng.uniform(0.02, 0.1, (texels, 3))
        values *= 1 + 0.01 * rng.standard_normal(values.shape, np.float32)
        stack[:, row:row + CHUNK] = values.astype("f4").reshape(len(light), -1, size, 3)
    return stack, light, view


class Listener:
    """Prints how far it is and, with a client, kills the first worker that it finds in the middle of a tile."""

    def __init__(self, client=None, output=None):
        self.client, self.output, self.pid, self.tile = client, output, None, None

    def __call__(self, progress):
        print("    %9s of %s texels, %s texels/s" % tuple(
            format(int(n), ",") for n in (progress.done, progress.total, progress.rate)), flush=True)
        until = time.monotonic() + PATIENCE
        while self.client is not None and self.pid is None and progress.done > 0 and time.monotonic() < until:
            if not self.kill():
                break

    def kill(self):
        """False when there is nothing left to wait for."""
        done = zarr.open_group(self.output, mode="r")["tiles/done"]
        at = {pid: tile for tile, what, pid in events(self.client) if what == "begin"}
        for pid, tile in at.items():
            try:
                os.kill(pid, signal.SIGSTOP)  # it may have ended the tile since: now it stays as it is
            except ProcessLookupError:
                continue
            if (done[tile] < 0).all():
                os.kill(pid, signal.SIGKILL)
                self.pid, self.tile = pid, tile
                print("    killed worker %d in the middle of tile %d" % (pid, tile), flush=True)
                return False
            os.kill(pid, signal.SIGCONT)
        return bool((done[:, 0] < 0).any())


def events(client):
    return [(event["tile"], event["what"], event["pid"]) for _, event in client.get_events(brdffit.dask.TOPIC)]


def timed(name, call):
    print("  %s" % name, flush=True)
    began = time.perf_counter()
    result = call()
    print("    %.2f s" % (time.perf_counter() - began), flush=True)
    return result


def differences(one, other):
    return [name for name in FIELDS if np.asarray(getattr(one, name)).tobytes() != np.asarray(getattr(other, name)).tobytes()]


def on_cluster(stack, light, view, output, asked, workers):
    """The map, and whether no tile but the dead worker's was begun twice."""
    from distributed import Client, LocalCluster

    with LocalCluster(n_workers=workers, threads_per_worker=1, dashboard_address=None) as cluster, Client(cluster) as client:
        client.wait_for_workers(workers, timeout=PATIENCE)
        listener = Listener(client, output)
        maps = timed("zarr to zarr, %d processes, one of them killed" % workers, lambda: brdffit.fit_map(
            stack, light, view, output=output, client=client, progress=listener, **asked))
        begun = collections.Counter(tile for tile, what, _ in events(client) if what == "begin")
    again = [tile for tile, times in begun.items() if times > 1]
    print("    %d tiles; begun more than once: %s" % (len(begun), again))
    return maps.load(), listener.pid is not None and again == [listener.tile]


def run(folder, options):
    asked = {"lobes": options.lobes, "tile": options.tile}
    stack, light, view = timed("making the stack", lambda: make(str(folder / "stack.zarr"), options.size, options.lobes))
    print("    %s %s, chunks %s, %.0f MB" % (stack.shape, stack.dtype, stack.chunks, stack.nbytes / 1e6))
    values = stack[:]
    local = timed("from memory, %d threads" % options.workers, functools.partial(
        brdffit.fit_map, values, light, view, lobes=options.lobes, threads=options.workers))
    del values
    threads = timed("zarr to zarr, %d threads" % options.workers, lambda: brdffit.fit_map(
        stack, light, view, output=str(folder / "threads.zarr"), client=False, threads=options.workers, progress=Listener(),
        **asked)).load()
    cluster, only_its_tile = on_cluster(stack, light, view, str(folder / "cluster.zarr"), asked, options.workers)
    print("  %s" % ", ".join("%s %d" % item for item in local.stats.items() if item[0] in ("texels", "certified", "open")))
    different = sorted({*differences(local, threads), *differences(local, cluster)})
    print("  bits: %s" % ("all the same in %d maps" % len(FIELDS) if not different else "DIFFERENT in %s" % different))
    if not only_its_tile:
        print("  NOT only the dead worker's tile was fitted again, or none could be killed")
    return int(bool(different) or not only_its_tile)


def main():
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--size", type=int, default=512, help="texels along a side")
    parser.add_argument("--lobes", type=int, default=1, choices=(1, 2))
    parser.add_argument("--tile", type=int, default=TILE_TEXELS, help="texels of a tile, at least")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--folder", type=pathlib.Path, help="where stack and maps are left; default: nowhere")
    options = parser.parse_args()
    folder = options.folder or pathlib.Path(tempfile.mkdtemp(prefix="brdffit-"))
    try:
        return run(folder, options)
    finally:
        if options.folder is None:
            shutil.rmtree(folder, ignore_errors=True)


if __name__ == "__main__":
    sys.exit(main())
