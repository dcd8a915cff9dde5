"""fit_map() as a run: threads, progress, interrupts, tiles for schedulers, mapped files. SPDX-License-Identifier: MIT"""
import dataclasses
import pickle
import signal
import subprocess
import sys
import threading

import numpy as np
import pytest

import brdffit
from brdffit.maps import batch
from brdffit.maps.geometry import geometry as geometry_of
from map_case import ARRAYS, NOT_REACHED, desk, mask, same, whole  # noqa: F401 (fixtures)
from places import SOURCES


def test_progress(desk, whole, mask, capsys):
    stack, light, view = desk
    big = np.tile(stack, (1, 40, 10, 1))
    seen, threads = [], set()

    def listen(now):
        seen.append(now)
        threads.add(threading.current_thread())

    brdffit.fit_map(big, light, view, tile=50, threads=2, progress=listen)
    assert all(a.done <= b.done for a, b in zip(seen, seen[1:]))
    assert (seen[-1].done, seen[-1].total) == (25200, 25200) and seen[-1].rate > 0
    assert threads == {threading.current_thread()}
    brdffit.fit_map(stack, light, view, progress=True)
    assert "texel" in capsys.readouterr().err


def test_a_listener_stops_the_run(hard_stack):
    fits = brdffit.fit_map(*hard_stack, lobes=2, relative_gap=1e-9, tile=2, threads=2, progress=lambda now: now.done >= 2)
    done = fits.status != NOT_REACHED
    assert 2 <= done.sum() < fits.status.size and fits.counts["not_reached"] == fits.stats["not_reached"] > 0
    assert np.isfinite(fits.e2[done]).all() and np.isnan(fits.e2[~done]).all() and (fits.where == -1).all()
    assert "not reached" in repr(fits)


@pytest.fixture
def hard_stack(hard):
    """Texels of some milliseconds each, for more than a minute."""
    return np.broadcast_to(hard.values[:, None], (84, 20000, 3)) * np.linspace(1, 2, 20000)[:, None], hard.light, hard.view


class Alarm(Exception):
    pass


@pytest.mark.parametrize("own", [False, True])
def test_interrupts_end_the_run(hard_stack, own):
    def ring(number, frame):
        raise Alarm

    normal = np.broadcast_to([0, 0, 1.0], (20000, 3)) if own else None
    before, threads = signal.signal(signal.SIGALRM, ring), threading.active_count()
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.3)
        with pytest.raises(Alarm):
            brdffit.fit_map(*hard_stack, normal=normal, lobes=2, relative_gap=1e-8)
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)
    assert threading.active_count() == threads  # none goes on


def test_an_exception_in_the_listener_ends_the_run(hard_stack):
    def fail(now):
        raise RuntimeError("enough")

    threads = threading.active_count()
    with pytest.raises(RuntimeError, match="enough"):
        brdffit.fit_map(*hard_stack, lobes=2, relative_gap=1e-8, progress=fail)
    assert threading.active_count() == threads


def test_a_tile_for_schedulers(desk, whole, mask):
    """What a scheduler does with a piece: everything that goes in travels, and pieces make the whole."""
    stack, light, view = desk
    geometry = geometry_of(light, view, None, None, None, 84, (9, 7)).shared
    geometry, options = pickle.loads(pickle.dumps((geometry, dataclasses.asdict(brdffit.Options()))))
    parts = [brdffit.fit_map(stack[:, rows], geometry, mask=mask[rows], **options) for rows in (slice(0, 4), slice(4, 9))]
    for name in ARRAYS:
        assert np.array_equal(np.concatenate([getattr(part, name) for part in parts]), getattr(whole, name), equal_nan=True)
    assert sum(part.counts["certified"] for part in parts) == whole.counts["certified"]
    plans = [batch.plan_for(geometry, 3, brdffit.Options(lobes=lobes)) for lobes in (1, 1, 2)]
    assert plans[0] is plans[1] is not plans[2]
    with pytest.raises(brdffit.DataError, match="samples"):
        brdffit.fit_map(stack[:80], geometry, **options)


def test_mapped_files(desk, whole, mask, tmp_path):
    stack, light, view = desk
    np.save(tmp_path / "stack.npy", stack)
    mapped = np.load(tmp_path / "stack.npy", mmap_mode="r")
    assert same(whole, brdffit.fit_map(mapped, light, view, mask=mask))


def test_memory_of_a_mapped_stack_stays_small(tmp_path):
    """Pages of the file aside, which the system may take back, what a run needs does not grow with the stack: 48 MB of it
    in another byte order, which are converted tile by tile."""
    program = """if True:
        import numpy as np, brdffit
        def own(): return [int(l.split()[1]) for l in open("/proc/self/status") if l.startswith("RssAnon")][0]
        light, view = brdffit.protocol84()
        made = np.lib.format.open_memmap("s.npy", "w+", ">f4", (84, 220, 220, 3))
        made[...] = 0  # no signal: the fits take no time
        made.flush()
        stack = np.load("s.npy", mmap_mode="r")
        brdffit.fit_map(stack[:, :20, :20], light, view, threads=2)
        before = own()
        fits = brdffit.fit_map(stack, light, view, threads=2)
        print((own() - before) / 1024, fits.counts["no_signal"])"""
    done = subprocess.run([sys.executable, "-c", program], cwd=tmp_path, stdout=subprocess.PIPE, text=True, check=True,
                          env={"PYTHONPATH": str(SOURCES), "BRDFFIT_LIBRARY": brdffit.library_path(), "PATH": ""})
    grown, texels = done.stdout.split()
    # The results are 48400 x 146 bytes: 7 MB.
    assert int(texels) == 48400 and float(grown) < 7 + 10


def test_many_threads_share_plans(desk):
    """Calls from several threads at once, with plans that push each other out."""
    stack, light, view = desk
    gaps = [10.0 ** -k for k in range(2, 9)]
    expected = [brdffit.fit_map(stack[:, 0], light, view, relative_gap=gap) for gap in gaps]
    results = []

    def work(start):
        for i in range(7):
            k = (i + start) % 7
            results.append(same(expected[k], brdffit.fit_map(stack[:, 0], light, view, relative_gap=gaps[k], threads=2)))

    threads = [threading.Thread(target=work, args=(i,)) for i in range(6)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert results == [True] * 42
