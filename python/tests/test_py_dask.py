"""fit_map on zarr, Dask and xarray arrays: the bits of the local call, on a cluster whose worker is killed, too.

SPDX-License-Identifier: MIT
"""
import json
import os
import shutil
import signal
import subprocess
import sys
import time
import warnings

import numpy as np
import pytest

import brdffit
import brdffit.dask
import stacks
from brdffit.outofcore import tiles
from brdffit.outofcore.call import prepare
from brdffit.outofcore.job import TileJob
from brdffit.outofcore.sources import source_of
from brdffit.outofcore.store import fields
from places import BUILD, ROOT

dask = pytest.importorskip("dask")
pytest.importorskip("dask.array")  # which `import dask` alone does not bring
distributed = pytest.importorskip("distributed")
xarray = pytest.importorskip("xarray")
zarr = pytest.importorskip("zarr")

FIELDS = ("sigma", "x", "y", "channel_scale", "e2", "lower_bound", "sum_of_squares", "status", "stop", "where", "boxes",
          "sigma_floor")
PATIENCE = 120


def same_bits(one, other, names=FIELDS):
    for name in names:
        a, b = np.asarray(getattr(one, name)), np.asarray(getattr(other, name))
        assert a.dtype == b.dtype and a.shape == b.shape and a.tobytes() == b.tobytes(), name


@pytest.fixture(scope="module")
def stack():
    """84 x 20 x 24 x 3, with texels that are bad, black, and equal across the edges of tiles."""
    values, light, view = stacks.make(20, 24)
    values = values.astype("f4")
    values[3, 2, 2] = np.nan
    values[:, 5, 5] = 0
    values[:, 7, 8] = values[:, 7, 9] = values[:, 7, 7]
    values[:, 8, 8] = values[:, 7, 8]
    return values, light, view


@pytest.fixture(scope="module")
def local(stack):
    return brdffit.fit_map(*stack)


def stored(path, values, chunks):
    array = zarr.create_array(str(path), shape=values.shape, chunks=chunks, dtype=values.dtype)
    array[...] = values
    return array


@pytest.fixture(scope="module")
def cluster():
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None, memory_limit=0) as cluster:
        yield cluster


@pytest.fixture
def client(cluster):
    with distributed.Client(cluster) as client:
        client.wait_for_workers(2, timeout=PATIENCE)
        yield client


# ---- Here ------------------------------------------------------------------------------------------------------------


def test_zarr_to_zarr(stack, local, tmp_path):
    values, light, view = stack
    seen = []
    maps = brdffit.fit_map(stored(tmp_path / "s.zarr", values, (84, 8, 8, 3)), light, view, output=tmp_path / "m.zarr",
                           tile=64, progress=seen.append)
    same_bits(maps.load(), local)
    assert maps["sigma"].chunks == (8, 8, 1) and maps.group["specular"].chunks == (8, 8, 3, 1)
    assert [p.done for p in seen] == sorted(p.done for p in seen) and seen[-1].done == seen[-1].total == 480
    assert len(seen) == 1 + 3 * 3
    stats = maps.load().stats
    assert {k: stats[k] for k in ("texels", "certified", "bad_value", "no_signal")} == {
        "texels": 480, "certified": 478, "bad_value": 1, "no_signal": 1} == {k: local.stats[k] for k in (
            "texels", "certified", "bad_value", "no_signal")}
    again = brdffit.dask.open_maps(tmp_path / "m.zarr")
    same_bits(again.load(), local)
    assert again.load().options == local.options and (again.quantity, again.samples) == ("brdf", 84)
    with pytest.raises(brdffit.DataError, match="holds no maps"):
        brdffit.dask.open_maps(zarr.open_group(str(tmp_path / "other.zarr"), mode="w"))
    # Named for whoever opens the store without this package.
    opened = xarray.open_zarr(tmp_path / "m.zarr", consolidated=False)
    assert opened.specular.dims == ("row", "column", "channel", "lobe") and opened.e2.dims == ("row", "column")
    assert opened.status.attrs["flag_meanings"].split()[int(opened.status[2, 2])] == "bad_value"
    assert opened.sigma.attrs == opened.specular.attrs == {"distributions": "beckmann", "parameters": "sigma"}
    assert json.loads(opened.attrs["brdffit"])["options"]["lobes"] == 1


def test_dask_arrays(stack, local):
    """Chunks along every axis; fitted when computed, and only then."""
    values, light, view = stack
    array = dask.array.from_array(values, chunks=(20, 7, 8, 2))
    maps = brdffit.fit_map(array, light, view, tile=64)
    assert all(isinstance(maps[name], dask.array.Array) for name in FIELDS) and len(maps) == len(FIELDS)
    same_bits(maps.load(), local)
    assert maps.load().stats["certified"] == 478
    assert maps.sigma[:4, :4].compute(scheduler="synchronous").tobytes() == local.sigma[:4, :4].tobytes()
    moved = brdffit.fit_map(array.transpose(1, 0, 3, 2), light, view, tile=(9, 24), sample_axis=1, channel_axis=-2)
    assert moved.e2.chunks == ((9, 9, 2), (24,))
    same_bits(moved.load(), local)
    grey = brdffit.fit_map(array[..., 1], light, view, tile=100, channel_axis=None)
    same_bits(grey.load(), brdffit.fit_map(values[..., 1], light, view, channel_axis=None))


@pytest.mark.parametrize("way", ["memory", "dask", "zarr", "written", "read late"])
def test_xarray(stack, local, tmp_path, way):
    """Dimensions and coordinates stay, but for those along the samples."""
    values, light, view = stack
    array = xarray.DataArray(values, dims=("light", "y", "x", "rgb"), coords={
        "y": np.arange(20) * 0.5, "rgb": ["r", "g", "b"], "light": np.arange(84), "angle": ("light", np.arange(84.0)),
        "height": (("y", "x"), np.arange(480.0).reshape(20, 24)), "scan": 7}).transpose("y", "light", "rgb", "x")
    axes = {"sample_axis": "light", "channel_axis": "rgb"}
    more = {"output": tmp_path / "m.zarr", "tile": 64} if way in ("written", "read late") else {"tile": 64}
    if way == "dask":
        array = array.chunk({"light": 10, "x": 5})
    elif way in ("zarr", "read late"):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # strings have no type in zarr's specification yet
            array.to_dataset(name="v").to_zarr(tmp_path / "s.zarr", consolidated=False)
        array = xarray.open_zarr(tmp_path / "s.zarr", consolidated=False, chunks={} if way == "zarr" else None).v
    got = brdffit.fit_map(array, light, view, **axes, **({} if way == "memory" else more))
    assert isinstance(got, xarray.Dataset)
    assert (got.chunks == {}) == (way == "memory")
    got = got.compute()
    assert got.specular.dims == ("y", "x", "rgb", "lobe") and set(got.coords) == {"y", "rgb", "height", "scan"}
    assert got.rgb.values.tolist() == ["r", "g", "b"] and got.y.values[3] == 1.5 and got.height.values[1, 2] == 26
    assert got.diffuse.sel(rgb="g").values.tobytes() == local.x[..., 1].tobytes()
    for field in fields(3, ("beckmann",)):
        assert got[field.stored].values.tobytes() == getattr(local, field.name).tobytes(), field.name
    if "output" in more:  # all there: nothing is fitted again
        told = []
        again = brdffit.fit_map(array, light, view, **axes, **more, progress=told.append)
        assert [p.done for p in told] == [480] and again.compute().identical(got)
    with pytest.raises(brdffit.DataError, match="none named 'samples'"):
        brdffit.fit_map(array, light, view, sample_axis="samples")
    with pytest.raises(brdffit.DataError, match="coordinate 'e2', as a map is called"):
        brdffit.fit_map(array.rename(scan="e2"), light, view, **axes)


def test_a_texels_own(stack, tmp_path):
    """Masks and directions travel with their tiles."""
    values, light, view = stack
    values = values[:, :6, :7]
    rng = np.random.default_rng(3)
    mask = rng.uniform(size=(6, 7)) < 0.7
    normal = np.concatenate([rng.uniform(-0.2, 0.2, (6, 7, 2)), np.ones((6, 7, 1))], 2)
    lights = light[:, None, None] + rng.uniform(-0.05, 0.05, (84, 6, 1, 3))
    for i, own in enumerate([{"normal": normal}, {"mask": mask, "weights": rng.uniform(0.5, 1, 84)}]):
        source = stored(tmp_path / ("s%d.zarr" % i), values, (84, 2, 3, 3))
        maps = brdffit.fit_map(source, light, view, **own, output=tmp_path / ("m%d.zarr" % i), tile=(4, 3), scale=2.0)
        same_bits(maps.load(), brdffit.fit_map(values, light, view, **own, scale=2.0))
    maps = brdffit.fit_map(values, lights, view, normal=normal[0, 0], output=tmp_path / "l.zarr", tile=(4, 4))
    same_bits(maps.load(), brdffit.fit_map(values, lights, view, normal=normal[0, 0]))
    skipped = brdffit.fit_map(values, lights, view, normal=normal[0, 0]).samples_skipped
    assert maps.load().samples_skipped == skipped and sum(skipped.values()) > 0


def test_resume(stack, local, tmp_path):
    """A run that was stopped reads as not reached where it was not, and goes on with what is missing, and no more."""
    values, light, view = stack
    source = stored(tmp_path / "s.zarr", values, (84, 8, 8, 3))
    ask = {"output": tmp_path / "m.zarr", "tile": (8, 8), "threads": 1}
    part = brdffit.fit_map(source, light, view, progress=lambda p: p.done >= 200, **ask)
    there = part.load()
    reached = there.status != 7
    assert 200 <= reached.sum() < 480 and np.isnan(there.e2[~reached]).all() and there.stats["not_reached"] == (~reached).sum()
    assert there.e2[reached].tobytes() == local.e2[reached].tobytes()
    files = {f: os.stat(f).st_mtime_ns for f in (tmp_path / "m.zarr" / "e2" / "c").rglob("*") if f.is_file()}

    class Halt(Exception):
        pass

    def halt(progress):
        if progress.done > reached.sum():
            raise Halt

    with pytest.raises(Halt):
        brdffit.fit_map(source, light, view, progress=halt, **ask)
    told = []
    same_bits(brdffit.fit_map(source, light, view, progress=told.append, **ask).load(), local)
    assert told[0].done > reached.sum() and told[-1].done == 480
    assert {f: os.stat(f).st_mtime_ns for f in files} == files
    told.clear()
    brdffit.fit_map(source, light, view, progress=told.append, **ask)
    assert [p.done for p in told] == [480]  # nothing left


def test_failures_that_pass(stack, local, tmp_path, monkeypatch):
    """A file system that fails now and then is asked again; one that fails for good ends the run, which goes on later."""
    values, light, view = stack
    whole, failed = TileJob.fit, []

    def flaky(self, tile, block, stopped=None):
        if failed.count(tile.number) < times[0]:
            failed.append(tile.number)
            raise OSError("the disk is away")
        return whole(self, tile, block, stopped)

    monkeypatch.setattr(TileJob, "fit", flaky)
    times = [2]
    ask = {"output": tmp_path / "m.zarr", "tile": (10, 24), "threads": 1}
    same_bits(brdffit.fit_map(values, light, view, **ask).load(), local)
    assert sorted(failed) == [0, 0, 1, 1]
    failed.clear()
    times = [3]
    with pytest.raises(OSError, match="the disk is away"):
        brdffit.fit_map(values, light, view, **dict(ask, output=tmp_path / "n.zarr"))
    same_bits(brdffit.fit_map(values, light, view, **dict(ask, output=tmp_path / "n.zarr")).load(), local)


def test_what_may_not_go_on(stack, tmp_path):
    values, light, view = stack
    values = values[:, :4, :4]
    output = str(tmp_path / "m.zarr")
    ask = {"output": output, "tile": 4}
    brdffit.fit_map(values, light, view, **ask)
    other = values.copy()
    other[0, 3, 3, 2] *= 2
    for change, says in [({"lobes": 2}, "lobes was 1, and is 2"), ({"relative_gap": 1e-4}, "relative_gap"), ({"scale": 2}, "scale"),
                         ({"tile": 8}, "tile"), ({"mask": np.ones((4, 4))}, "mask"), ({"weights": np.full(84, 0.5)}, "directions"),
                         ({"values": other}, "values"), ({"values": values.astype("f8")}, "type was"),
                         ({"values": values[:, :, :3]}, "spatial")]:
        changed = dict(ask, values=values, light=light, view=view) | change
        with pytest.raises(brdffit.DataError, match="maps of another run: .*" + says):
            brdffit.fit_map(changed.pop("values"), changed.pop("light"), changed.pop("view"), **changed)
    maps = brdffit.fit_map(other, light, view, lobes=2, overwrite=True, **ask)
    same_bits(maps.load(), brdffit.fit_map(other, light, view, lobes=2))
    assert brdffit.fit_map(other, light, view, lobes=2, isa="base", **ask).load().stats["certified"] == 15
    zarr.open_group(str(tmp_path / "mine.zarr"), mode="w").create_array("data", shape=(3,), dtype="f8")[:] = 1
    for overwrite in (False, True):
        with pytest.raises(brdffit.DataError, match="something else"):
            brdffit.fit_map(values, light, view, output=tmp_path / "mine.zarr", overwrite=overwrite)
    assert zarr.open_group(str(tmp_path / "mine.zarr"))["data"][:].tolist() == [1, 1, 1]
    source = stored(tmp_path / "m.zarr" / "inside", values, (84, 4, 4, 3))
    with pytest.raises(brdffit.DataError, match="inside"):
        brdffit.fit_map(source, light, view, output=output, overwrite=True)
    assert source[0, 0, 0, 0] == values[0, 0, 0, 0]
    with pytest.raises(brdffit.DataError, match="zarr format 2"):
        brdffit.fit_map(values, light, view, output=zarr.open_group(str(tmp_path / "two.zarr"), mode="w", zarr_format=2))


def test_nothing_of_others_is_removed(stack, tmp_path, monkeypatch):
    """Files that are not zarr's are things, too: overwrite once removed a folder with all that was in it."""
    values, light, view = stack
    values = values[:, :4, :4]
    mine = tmp_path / "mine"
    mine.mkdir()
    (mine / "notes.txt").write_text("precious")
    monkeypatch.chdir(mine)
    for output in (mine, str(mine), "", "file://%s" % mine):
        for overwrite in (False, True):
            with pytest.raises(brdffit.DataError, match="something else"):
                brdffit.fit_map(values, light, view, output=output, overwrite=overwrite)
    assert (mine / "notes.txt").read_text() == "precious"
    output = tmp_path / "m.zarr"
    scan = xarray.DataArray(values, dims=("light", "v", "u", "rgb"), coords={
        "v": np.arange(4.), "rgb": list("rgb"), "place": (("v", "u"), np.ones((4, 4)))})
    axes = {"sample_axis": "light", "channel_axis": "rgb", "output": output}
    brdffit.fit_map(scan, light, view, **axes)
    brdffit.fit_map(scan, light, view, lobes=2, overwrite=True, **axes)  # coordinates are of the maps
    for path in (output / "notes.txt", output / "analysis" / "zarr.json"):
        path.parent.mkdir(exist_ok=True)
        path.write_text("precious")
        with pytest.raises(brdffit.DataError, match="beside maps.*: " + path.relative_to(output).parts[0]):
            brdffit.fit_map(scan, light, view, overwrite=True, **axes)
        assert path.read_text() == "precious"
        shutil.rmtree(path.parent) if path.parent != output else path.unlink()
    again = brdffit.fit_map(scan, light, view, overwrite=True, **axes)
    assert again.place.sum() == 16 and again.sizes["lobe"] == 1
    for store in (zarr.storage.MemoryStore(), zarr.open_group(zarr.storage.MemoryStore(), path="deep/down")):
        for lobes in (1, 2):
            brdffit.fit_map(values, light, view, lobes=lobes, overwrite=True, output=store)


def test_wrong_arguments(stack):
    values, light, view = stack
    array = dask.array.from_array(values)
    for more, error in [({"lobes": 4}, brdffit.OptionError), ({"tile": (4,)}, brdffit.OptionError),
                        ({"tile": 0}, brdffit.OptionError), ({"progress": True}, brdffit.OptionError),
                        ({"sample_axis": 4}, brdffit.DataError),
                        ({"channel_axis": 0}, brdffit.DataError), ({"mask": np.ones(3)}, brdffit.DataError),
                        ({"errors": "no"}, brdffit.OptionError), ({"sample_axis": "light"}, brdffit.DataError)]:
        with pytest.raises(error):
            brdffit.fit_map(array, light, view, **more)
    with pytest.raises(brdffit.DataError):
        brdffit.fit_map(array, light[:-1], view)
    with pytest.raises(brdffit.DataError, match="masked array"):
        brdffit.fit_map(dask.array.ma.masked_greater(array, 0.5), light, view).load()
    with pytest.raises(brdffit.DataError, match="a block of values"):
        wrong = array.rechunk(-1).map_blocks(lambda block: block[:, :1], dtype="f4")  # not the shape that it says
        brdffit.fit_map(wrong, light, view, output=zarr.storage.MemoryStore())
    with pytest.raises(brdffit.DataError, match="unknown size"):
        brdffit.fit_map(array[:, array[0, :, 0, 0] > 0], light, view)
    with pytest.raises(brdffit.DataError) as raised:
        brdffit.fit_map(values, light, view, tile=(3, 8), errors="raise", output=zarr.storage.MemoryStore(), threads=1)
    assert raised.value.texel == (2, 2) and raised.value.sample == 3


def test_tiles():
    """At least as many texels as asked, in whole chunks, and no more bytes than is wise."""
    cut = tiles.tile_shape
    assert cut((4096, 4096), (64, 64), 1008, None) == (64, 1024)
    assert cut((512, 512), (512, 512), 1008, None) == (512, 512)
    assert cut((100, 100), (64, 64), 1008, None) == (100, 100)
    assert cut((1000, 300), None, 1008, None) == (219, 300)
    assert cut((8192, 8192), (8192, 8192), 1008, None) == (1024, 1024)
    assert 65536 <= 1024 * 1024 and 1024 * 1024 * 1008 <= 2**30 < 1024 * 2048 * 1008
    assert cut((7, 9, 11), (2, 3, 4), 8, 100) == (2, 6, 11)
    regions = tiles.regions((5, 4), (2, 3))
    assert len(regions) == 6 and sum(np.prod(tiles.shape_of(r)) for r in regions) == 20


def test_chunks_that_are_read_often_are_told(stack, tmp_path):
    values, light, view = stack
    source = stored(tmp_path / "s.zarr", values, (1, 20, 24, 3))
    with pytest.warns(brdffit.dask.ChunkWarning, match="84 of them along the samples: each chunk is read about 6 times"):
        brdffit.fit_map(source, light, view, tile=(10, 8))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        brdffit.fit_map(source, light, view, tile=100)


# ---- On a cluster ----------------------------------------------------------------------------------------------------


def events(client):
    """(tile, "begin" or "end", pid) in the order in which they reached the scheduler."""
    return [(event["tile"], event["what"], event["pid"]) for _, event in client.get_events(brdffit.dask.TOPIC)]


class Murder:
    """A listener that kills a worker with SIGKILL once it is seen in the middle of a tile."""

    def __init__(self, client, output):
        self.client, self.output, self.before = client, output, len(events(client))
        self.pid = self.tile = None
        self.told = []

    def in_the_middle(self):
        """A pid and the tile that it has begun and not ended."""
        at = {}
        for tile, what, pid in events(self.client)[self.before:]:
            at[pid] = tile if what == "begin" else None
        return [(pid, tile) for pid, tile in at.items() if tile is not None]

    def __call__(self, progress):
        self.told.append(progress.done)
        if progress.done == 0:
            return  # nothing was sent yet
        done = zarr.open_group(self.output, mode="r")["tiles/done"]
        until = time.monotonic() + PATIENCE
        while self.pid is None and time.monotonic() < until and (done[:, 0] < 0).any():
            for pid, tile in self.in_the_middle():
                os.kill(pid, signal.SIGSTOP)  # it may have ended since: now it stays as it is
                if (done[tile] < 0).all():
                    os.kill(pid, signal.SIGKILL)
                    self.pid, self.tile = pid, tile
                    break
                os.kill(pid, signal.SIGCONT)


def test_a_killed_worker_costs_its_tile(stack, tmp_path, client):
    values, light, view = stack
    source, output = stored(tmp_path / "s.zarr", values, (84, 4, 8, 3)), str(tmp_path / "m.zarr")
    ask = {"lobes": 2, "relative_gap": 1e-6}
    alone = brdffit.fit_map(values, light, view, **ask)
    pids = set(client.run(os.getpid).values())
    assert len(pids) == 2
    murder = Murder(client, output)
    maps = brdffit.fit_map(source, light, view, output=output, tile=32, progress=murder, **ask)
    same_bits(maps.load(), alone)
    assert murder.pid in pids and murder.told[-1] == 480
    seen = events(client)[murder.before:]
    begun = [tile for tile, what, _ in seen if what == "begin"]
    assert sorted(begun) == sorted([*range(15), murder.tile])  # each once, but for the one
    assert [pid for tile, what, pid in seen if tile == murder.tile and what == "begin"].count(murder.pid) == 1
    assert (murder.tile, "end", murder.pid) not in seen
    assert sorted(tile for tile, what, _ in seen if what == "end") == list(range(15))
    client.wait_for_workers(2, timeout=PATIENCE)
    now = set(client.run(os.getpid).values())
    assert len(now) == 2 and murder.pid not in now and len(now & pids) == 1  # its nanny has put another in its place


def test_on_a_cluster(stack, local, tmp_path, client):
    """Whatever the stack is; the active client is found; workers read zarr themselves."""
    values, light, view = stack
    source = stored(tmp_path / "s.zarr", values, (84, 8, 8, 3))
    array = xarray.DataArray(values, dims=("light", "y", "x", "rgb"), coords={"rgb": list("rgb")})
    for i, one in enumerate([values, dask.array.from_zarr(source), array]):
        before = len(events(client))
        maps = brdffit.fit_map(one, light, view, output=tmp_path / ("m%d.zarr" % i), tile=(10, 12))
        if i < 2:
            same_bits(maps.load(), local)
        else:
            assert maps.specular.values.tobytes() == local.y.tobytes() and maps.specular.dims == ("y", "x", "rgb", "lobe")
        assert sorted(e[:2] for e in events(client)[before:]) == sorted((t, w) for t in range(4) for w in ("begin", "end"))
    same_bits(brdffit.fit_map(source, light, view, tile=64).load(), local)  # Dask arrays, computed by the client
    here = len(events(client))
    same_bits(brdffit.fit_map(source, light, view, client=False, output=tmp_path / "h.zarr", tile=64).load(), local)
    assert len(events(client)) == here
    with pytest.raises(brdffit.OptionError, match="in this process's memory"):
        brdffit.fit_map(source, light, view, client=client, output=zarr.storage.MemoryStore())
    with pytest.raises(brdffit.OptionError, match="threads are those"):
        brdffit.fit_map(source, light, view, client=client, output=tmp_path / "t.zarr", threads=2)
    with pytest.raises(brdffit.DataError) as raised:
        brdffit.fit_map(source, light, view, client=client, output=tmp_path / "e.zarr", tile=64, errors="raise")
    assert raised.value.texel == (2, 2) and raised.value.sample == 3


def test_little_travels(stack, tmp_path):
    import pickle

    values, light, view = stack
    source = stored(tmp_path / "s.zarr", values, (84, 20, 24, 3))
    call = prepare(source_of(source, 0, -1), light, view, None, None, None, None, 1.0, "status", None,
                                 brdffit.Options())
    block, = call.source.blocks(call.tile, call.regions)
    job = TileJob(call.arguments(), call.fields, zarr.open_group(str(tmp_path / "g")))
    assert len(pickle.dumps(job)) < 20000 < values.nbytes and len(pickle.dumps((call.tile_of(0), block))) < 5000
    assert pickle.loads(pickle.dumps(block)).load().tobytes() == values.tobytes()


def test_only_dask_needs_dask(tmp_path):
    """The package without it; and who is to be asked for it."""
    program = ("import sys\nfor name in ('dask', 'distributed', 'zarr', 'xarray'): sys.modules[name] = None\n"
               "import numpy as np, brdffit\nl, v = brdffit.protocol84()\n"
               "s = np.ones((84, 2, 2, 3)); print(brdffit.fit_map(s, l, v).shape)\n"
               "try: brdffit.fit_map(s, l, v, output='m.zarr')\nexcept ImportError as error: print(error)")
    done = subprocess.run([sys.executable, "-c", program], cwd=tmp_path, capture_output=True, text=True, timeout=PATIENCE,
                          env={**os.environ, "PYTHONPATH": str(ROOT / "python" / "src"),
                               "BRDFFIT_LIBRARY": str(BUILD / "libbrdffit.so")})
    assert done.stdout.splitlines() == ["(2, 2)", "zarr is needed here: pip install 'brdffit[dask]'"], done.stderr
