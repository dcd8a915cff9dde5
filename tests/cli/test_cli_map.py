"""brdffit map: results, and that tiles, threads and interruptions change nothing in them.

SPDX-License-Identifier: MIT
"""
import json
import os
import re
import signal
import subprocess
import time

import numpy as np
import pytest

import harness
import model
import stacks

CERTIFIED, OPEN, NO_SIGNAL, MASKED, BAD_VALUE, REFUSED, NO_SAMPLES = range(7)


@pytest.fixture
def desk(tmp_path):
    """A stack of 6 x 5 texels as stack.npy (float32), with directions as geometry.csv, lights.npy and views.npy."""
    stack, light, view = stacks.make(6, 5)
    np.save(tmp_path / "stack.npy", stack.astype("f4"))
    stacks.vectors_csv(tmp_path / "geometry.csv", light, view)
    np.save(tmp_path / "lights.npy", light)
    np.save(tmp_path / "views.npy", view)
    return tmp_path


def single(folder, light, view, values, *options, expect=0):
    """What `brdffit fit` says of one texel."""
    stacks.texel_csv(folder / "texel.csv", light, view, values)
    return harness.fit("texel.csv", *options, cwd=folder, expect=expect)[0]


@pytest.mark.parametrize("options", [(), ("--lobes", "2"), ("--distribution", "ggx", "--gap", "1e-5"),
                                     ("--distribution", "blinn-phong", "--values", "radiance"), ("--lobes", "3", "--gap", "0.05"),
                                     ("--lobes", "ward,blinn-phong", "--gap", "0.01")], ids=" ".join)
def test_as_fit(desk, options):
    """Each texel is what `brdffit fit` finds for it, and both proofs hold for both results."""
    stacks.run(desk, "stack.npy", "-g", "geometry.csv", "-o", "m", *options)
    maps, stack = stacks.maps(desk / "m"), np.load(desk / "stack.npy").astype(float)
    light, view = np.load(desk / "lights.npy"), np.load(desk / "views.npy")
    assert maps["status"].dtype == np.uint8 and (maps["status"] == CERTIFIED).all()
    for row, column in [(0, 0), (2, 3), (5, 4)]:
        line = single(desk, light, view, stack[:, row, column], *options)
        got = {name: m[row, column] for name, m in maps.items()}
        gap = float(options[-1]) if "--gap" in options else 1e-3
        assert got["lower_bound"] <= got["e2"] <= (1 + gap) * got["lower_bound"] * (1 + 1e-15)
        assert got["lower_bound"] <= line["e2"] and line["lower_bound"] <= got["e2"]
        if gap <= 1e-3:  # which optimum within a wide gap is open
            assert np.allclose(got["sigma"], line["sigma"], rtol=1e-4)
            assert np.allclose(got["x"], line["x"], rtol=1e-3, atol=1e-6)
        # E^2 as claimed, by arithmetic of its own.
        claim = dict(line, sigma=got["sigma"], x=got["x"], y=got["y"])
        samples = model.Samples(desk / "texel.csv", line["quantity"], 60.0, None, line["distributions"])
        assert np.isclose(samples.figures(claim)[0], got["e2"], rtol=1e-9)
        if "exponent" in maps:
            by_n = [name == "blinn-phong" for name in line["distributions"]]
            assert np.array_equal(np.isnan(got["exponent"]), np.logical_not(by_n))
            assert np.allclose(got["exponent"][by_n], 1 / got["sigma"][by_n] ** 2, rtol=1e-14)
    assert ("exponent" in maps) == ("blinn-phong" in " ".join(options))


@pytest.mark.parametrize("names", ["ggx,ward", "ward,ggx,ward", "ggx,blinn-phong", "torrance-sparrow,beckmann"])
def test_lobes_of_several_distributions(desk, names):
    """The very bits of `brdffit fit`, texel by texel, in its order; map.json says which lobe is which."""
    stacks.run(desk, "stack.npy", "-g", "geometry.csv", "-o", "m", "--lobes", names, "--gap", "0.05", "--tile", "2")
    maps, stack = stacks.maps(desk / "m"), np.load(desk / "stack.npy").astype(float)
    light, view = np.load(desk / "lights.npy"), np.load(desk / "views.npy")
    about = json.loads((desk / "m" / "map.json").read_text())
    for row, column in [(0, 0), (3, 1), (5, 4)]:
        line = single(desk, light, view, stack[:, row, column], "--lobes", names, "--gap", "0.05")
        assert about["distributions"] == line["distributions"] and about["distribution"] is None
        for name in ("sigma", "x", "y", "e2", "lower_bound"):
            assert np.array_equal(maps[name][row, column], line[name]), name


def test_general_path(desk):
    """Directions a texel and normal maps: the very bits of `brdffit fit`."""
    rng = np.random.default_rng(5)
    normals = np.concatenate([rng.uniform(-0.2, 0.2, (3, 4, 2)), np.ones((3, 4, 1))], 2)
    normals[2, 3] = (0, 0, -1)
    normals /= np.linalg.norm(normals, axis=2, keepdims=True)
    stack, light, view = stacks.make(3, 4, normals=normals)
    np.save(desk / "s.npy", stack)
    np.save(desk / "n.npy", normals)
    np.save(desk / "l4.npy", np.broadcast_to(light[:, None, None], (84, 3, 4, 3)))
    done = stacks.run(desk, "s.npy", "-g", "geometry.csv", "--normals", "n.npy", "-o", "a.npz", "--stats", expect=3)
    assert "1 with no sample left to fit" in " ".join(done.stdout.split()) and "incidence" in done.stdout
    stacks.run(desk, "s.npy", "--lights", "l4.npy", "--views", "views.npy", "--normals", "n.npy", "-o", "b.npz",
               expect=3)
    one = stacks.maps(desk / "a.npz")
    assert stacks.same(one, stacks.maps(desk / "b.npz"))
    assert one["status"][2, 3] == NO_SAMPLES and np.isnan(one["sigma"][2, 3])
    assert (one["status"].ravel()[:-1] == CERTIFIED).all()
    # In the frame of its normal a texel has other directions; `fit` takes the normal from the table.
    table = np.hstack([light, view, np.broadcast_to(normals[1, 2], light.shape), stack[:, 1, 2]])
    with open(desk / "texel.csv", "w") as file:
        file.write("lx,ly,lz,vx,vy,vz,nx,ny,nz,r,g,b\n")
        file.writelines(",".join(map(repr, row)) + "\n" for row in table.tolist())
    line = harness.fit("texel.csv", cwd=desk)[0]
    got = {name: m[1, 2] for name, m in one.items()}
    assert got["sigma"].tolist() == line["sigma"] and got["x"].tolist() == line["x"]
    assert got["y"].tolist() == line["y"]
    assert (got["e2"], got["lower_bound"]) == (line["e2"], line["lower_bound"])


def test_threads_and_tiles(desk):
    """The same bytes, whatever the number of threads and the size of the tiles."""
    wanted = None
    for threads, tile in [(1, 6), (2, 1), (7, 2), (2, 4), (1, 100)]:
        stacks.run(desk, "stack.npy", "-g", "geometry.csv", "--threads", threads, "--tile", tile, "-o", "m.npz", "-q")
        got = (desk / "m.npz").read_bytes()
        assert wanted is None or got == wanted, (threads, tile)
        wanted = got
    assert sorted(p.name for p in desk.iterdir() if "m.npz" in p.name) == ["m.npz"]


def test_statuses(desk):
    """Masked, without signal and bad texels: marked, counted, named, and nobody else's business."""
    stack = np.load(desk / "stack.npy")
    whole = stack.copy()
    stack[:, 1, 2] = 0
    stack[40, 3, 1, 2] = np.nan
    stack[7, 4, 4, 0] = np.inf
    stack[:, 0, 0] = np.nan
    np.save(desk / "bad.npy", stack)
    mask = np.ones((6, 5), bool)
    mask[0, 0] = mask[5, 1] = False
    np.save(desk / "mask.npy", mask)
    done = stacks.run(desk, "bad.npy", "-g", "geometry.csv", "--mask", "mask.npy", "-o", "m", expect=3)
    assert "2 texels with a bad value; the first: row 3, column 1, sample 40, channel 2" in done.stderr
    assert "30 texels: 25 certified, 1 without signal, 2 masked, 2 with a bad value." in " ".join(done.stdout.split())
    maps = stacks.maps(desk / "m")
    wanted = np.zeros((6, 5), int)
    wanted[1, 2], wanted[0, 0], wanted[5, 1], wanted[3, 1], wanted[4, 4] = NO_SIGNAL, MASKED, MASKED, BAD_VALUE, BAD_VALUE
    assert (maps["status"] == wanted).all()
    for name in ("sigma", "x", "y", "e2", "lower_bound"):
        unfitted = np.isnan(maps[name].reshape(6, 5, -1))
        assert (unfitted == (wanted >= MASKED)[..., None]).all(), name
    assert (maps["x"][1, 2] == 0).all() and maps["e2"][1, 2] == 0
    # The others are what they are without bad neighbours.
    np.save(desk / "whole.npy", whole)
    stacks.run(desk, "whole.npy", "-g", "geometry.csv", "-o", "w", "-q")
    good = wanted == 0
    for name, m in stacks.maps(desk / "w").items():
        assert np.array_equal(m[good], maps[name][good]), name
    # The same through the general path.
    np.save(desk / "n.npy", np.broadcast_to([0.0, 0, 1], (6, 5, 3)))
    stacks.run(desk, "bad.npy", "-g", "geometry.csv", "--mask", "mask.npy", "--normals", "n.npy", "-o", "g", expect=3)
    assert (np.load(desk / "g" / "status.npy") == wanted).all()


def test_open(desk):
    """A search that stops early: exit 4, status 1, and the bound still holds."""
    stacks.run(desk, "stack.npy", "-g", "geometry.csv", "--lobes", "2", "--box-budget", "3", "-o", "m.npz", expect=4)
    maps = stacks.maps(desk / "m.npz")
    assert (maps["status"] == OPEN).any()
    assert (maps["lower_bound"] <= maps["e2"]).all()


# ---- Runs that end early ---------------------------------------------------


def slow(folder):
    """A command that runs for a second or so, in many tiles."""
    stack, light, view = stacks.make(36, 12, lobes=2)
    np.save(folder / "slow.npy", stack)
    np.save(folder / "n.npy", np.broadcast_to([0.0, 0, 1], (36, 12, 3)))
    stacks.vectors_csv(folder / "geometry.csv", light, view)
    return ["slow.npy", "-g", "geometry.csv", "--normals", "n.npy", "--lobes", "2", "--gap", "1e-4", "--tile", "1"]


def end_early(folder, command, number):
    """Start, wait for the first finished tiles, send a signal. Returns the exit status, how many tiles are kept."""
    process = subprocess.Popen([harness.BRDFFIT, "map", *command], cwd=folder, env=harness.environment(),
                               stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    work = folder / "m.npz.brdffit-work"
    end = time.monotonic() + harness.PATIENCE
    while len(list(work.glob("tile-*"))) < 3:
        assert process.poll() is None and time.monotonic() < end, process.communicate()
        time.sleep(0.002)
    process.send_signal(number)
    _, errors = process.communicate(timeout=harness.PATIENCE)
    return process.returncode, errors.decode(), len(list(work.glob("tile-*")))


def test_killed(tmp_path):
    """kill -9, twice; the same command goes on, and the bytes are those of a run in one piece."""
    command = slow(tmp_path)
    stacks.run(tmp_path, *command, "-o", "whole.npz", "--threads", "2")
    command += ["-o", "m.npz", "--threads", "2"]
    code, _, kept = end_early(tmp_path, command, signal.SIGKILL)
    assert code == -signal.SIGKILL and 3 <= kept < 36 and not (tmp_path / "m.npz").exists()
    # Another fit may not go on with these tiles, and says why.
    done = stacks.run(tmp_path, *command, "--max-incidence", "50", expect=2)
    assert "then: --max-incidence 60" in done.stderr and "now:  --max-incidence 50" in done.stderr
    assert "--fresh" in done.stderr
    # One tile is damaged, one cut, one left half-written: these are fitted again.
    work = tmp_path / "m.npz.brdffit-work"
    tiles = sorted(work.glob("tile-*"))
    raw = bytearray(tiles[0].read_bytes())
    raw[-20] ^= 1
    tiles[0].write_bytes(raw)
    tiles[1].write_bytes(tiles[1].read_bytes()[:-5])
    (work / ".brdffit-1-0.tmp").write_bytes(b"half")
    done = stacks.run(tmp_path, *command)
    assert "%d of them from an earlier run" % (kept - 2) in " ".join(done.stdout.split())
    assert (tmp_path / "m.npz").read_bytes() == (tmp_path / "whole.npz").read_bytes()
    assert not work.exists()


def test_interrupted(tmp_path):
    """Ctrl-C: exit 4, a word about it, and the tiles stay; --fresh drops them."""
    command = [*slow(tmp_path), "-o", "m.npz", "--threads", "1"]
    code, errors, kept = end_early(tmp_path, command, signal.SIGINT)
    assert code == 4 and "interrupted; %d of 36 tiles are kept in m.npz.brdffit-work" % kept in errors
    np.save(tmp_path / "slow.npy", np.load(tmp_path / "slow.npy").astype("f4"))  # another file
    assert "then: stack slow.npy" in stacks.run(tmp_path, *command, expect=2).stderr
    done = stacks.run(tmp_path, *command, "--fresh", "--lobes", "1")
    assert "earlier" not in done.stdout and not (tmp_path / "m.npz.brdffit-work").exists()


def test_shards(desk):
    """Parts, in any order and twice, then the same command without --shard: the bytes of one run."""
    command = ["stack.npy", "-g", "geometry.csv", "--tile", "1"]
    stacks.run(desk, *command, "-o", "whole.npz")
    command += ["-o", "m.npz"]
    for part, there in [("3/4", 1), ("1/4", 3), ("1/4", 3), ("2/4", 5)]:
        done = stacks.run(desk, *command, "--shard", part)
        assert "part %s is done; %d of 6 tiles" % (part, there) in done.stdout and not (desk / "m.npz").exists()
    done = stacks.run(desk, *command)  # part 4 is made up for
    assert "5 of them from an earlier run" in " ".join(done.stdout.split())
    assert (desk / "m.npz").read_bytes() == (desk / "whole.npz").read_bytes()
    for bad in ("0/4", "5/4", "4", "1/", "x/2"):
        assert "--shard does not take '%s'" % bad in stacks.run(desk, *command, "--shard", bad, expect=2).stderr


def test_locked(desk):
    """Two at once on one output would overwrite each other's tiles."""
    fcntl = pytest.importorskip("fcntl")
    work = desk / "m.npz.brdffit-work"
    work.mkdir()
    with open(work / "lock", "w") as file:
        fcntl.lockf(file, fcntl.LOCK_EX)
        done = stacks.run(desk, "stack.npy", "-g", "geometry.csv", "-o", "m.npz", expect=1)
    assert "another brdffit map is at work" in done.stderr


# ---- Output ----------------------------------------------------------------


def test_folder(desk):
    """The default name, a folder that exists, what it tells about itself, and a file of one's own in it."""
    stacks.run(desk, "stack.npy", "-g", "geometry.csv")
    folder = desk / "stack-maps"
    (folder / "mine.txt").write_text("keep")
    (folder / "e2.npy").write_bytes(b"old")
    stacks.run(desk, "stack.npy", "-g", "geometry.csv")
    assert (folder / "mine.txt").read_text() == "keep" and np.load(folder / "e2.npy").shape == (6, 5)
    about = json.loads((folder / "map.json").read_text())
    assert about["schema"] == "brdffit.map/1" and about["texels"]["certified"] == 30
    assert about["status"]["4"] == "bad_value" and about["status"]["6"] == "no_samples"
    done = stacks.run(desk, "stack.npy", "-g", "geometry.csv", "-o", "stack-maps/e2.npy", expect=2)
    assert "e2.npy is a file, and no .npz" in done.stderr


def test_pfm(desk):
    """float32 maps whose claims are still true."""
    stacks.run(desk, "stack.npy", "-g", "geometry.csv", "--lobes", "2", "-o", "m")
    stacks.run(desk, "stack.npy", "-g", "geometry.csv", "--lobes", "2", "-o", "p", "--format", "pfm", "--tile", "4")
    maps = stacks.maps(desk / "m")
    got = {file.stem: stacks.read_pfm(file) for file in (desk / "p").glob("*.pfm")}
    assert sorted(got) == ["e2", "lower_bound", "sigma_1", "sigma_2", "status", "x", "y_1", "y_2"]
    assert (got["sigma_2"] == maps["sigma"][..., 1].astype("f4")).all()
    assert (got["x"] == maps["x"].astype("f4")).all()
    assert (got["y_1"] == maps["y"][..., 0].astype("f4")).all()
    assert (got["status"] == maps["status"]).all()
    assert (got["e2"] >= maps["e2"]).all() and (got["lower_bound"] <= maps["lower_bound"]).all()
    assert np.allclose(got["e2"], maps["e2"], rtol=2e-7) and np.allclose(got["lower_bound"], maps["lower_bound"], rtol=2e-7)


def test_terminal(tmp_path):
    """On a terminal a line tells how far it is, how fast, and how long it will take; it is gone at the end."""
    pty = pytest.importorskip("pty")
    command = slow(tmp_path)
    ours, theirs = pty.openpty()
    process = subprocess.Popen([harness.BRDFFIT, "map", *command, "--threads", "1"], cwd=tmp_path, stderr=theirs,
                               stdout=subprocess.PIPE, env=harness.environment(TERM="xterm"))
    os.close(theirs)
    work = tmp_path / "slow-maps.brdffit-work"
    while not list(work.glob("tile-*")):
        assert process.poll() is None, process.communicate()
        time.sleep(0.002)
    process.send_signal(signal.SIGSTOP)  # however fast the machine is, this run takes a while
    time.sleep(0.5)
    process.send_signal(signal.SIGCONT)
    seen = b""
    while True:
        try:
            block = os.read(ours, 4096)
        except OSError:  # the other side is closed
            break
        if not block:
            break
        seen += block
    os.close(ours)
    process.communicate(timeout=harness.PATIENCE)
    assert process.returncode == 0
    lines = seen.decode().split("\r")
    assert re.match(r"\d+ of 432 texels, [\d.e+]+ texels/s, \d+ s left\033\[K$", lines[1]), lines
    assert lines[-1] == "\033[K"


def test_full_disk(desk):
    """Nothing half-written under the output's name, and the reason."""
    resource = pytest.importorskip("resource")
    done = stacks.run(desk, "stack.npy", "-g", "geometry.csv", "-o", "m", expect=1,
                      preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (300, 300)))
    assert "cannot write" in done.stderr and not (desk / "m").exists()
    assert not list((desk / "m.brdffit-work").glob("tile-*"))
    stacks.run(desk, "stack.npy", "-g", "geometry.csv", "-o", "m", "--fresh")


def test_directions_a_texel(desk):
    """Lights and views that differ from texel to texel: each texel is that of a stack with its own directions."""
    rng = np.random.default_rng(8)
    light, view = np.load(desk / "lights.npy"), np.load(desk / "views.npy")
    stack = np.load(desk / "stack.npy")[:, :2, :2]
    lights = light[:, None, None] + rng.uniform(-0.02, 0.02, (84, 2, 2, 3))
    views = view[:, None, None] + rng.uniform(-0.02, 0.02, (84, 2, 2, 3))
    for name, array in {"s": stack, "l": lights, "v": views}.items():
        np.save(desk / (name + ".npy"), array)
    stacks.run(desk, "s.npy", "--lights", "l.npy", "--views", "v.npy", "-o", "m.npz")
    maps = stacks.maps(desk / "m.npz")
    for row, column in np.ndindex(2, 2):
        line = single(desk, lights[:, row, column], views[:, row, column], stack[:, row, column].astype(float))
        assert maps["sigma"][row, column].tolist() == line["sigma"]
        assert maps["x"][row, column].tolist() == line["x"] and maps["e2"][row, column] == line["e2"]


def test_weights(desk):
    """A geometry with weights: those of `fit`."""
    text = (desk / "geometry.csv").read_text().split()
    (desk / "geometry.csv").write_text("\n".join([text[0] + ",weight"] + [line + ",%d" % (i % 3)
                                                                         for i, line in enumerate(text[1:])]) + "\n")
    stacks.run(desk, "stack.npy", "-g", "geometry.csv", "-o", "m.npz")
    maps = stacks.maps(desk / "m.npz")
    stacks.texel_csv(desk / "texel.csv", np.load(desk / "lights.npy"), np.load(desk / "views.npy"),
                     np.load(desk / "stack.npy")[:, 3, 3].astype(float))
    text = (desk / "texel.csv").read_text().split()
    (desk / "texel.csv").write_text("\n".join([text[0] + ",weight"] + [line + ",%d" % (i % 3)
                                                                      for i, line in enumerate(text[1:])]) + "\n")
    line = harness.fit("texel.csv", cwd=desk)[0]
    assert line["samples_skipped"]["zero_weight"] == 28
    assert maps["lower_bound"][3, 3] <= line["e2"] and line["lower_bound"] <= maps["e2"][3, 3]
    assert np.allclose(maps["sigma"][3, 3], line["sigma"], rtol=1e-4)


def test_norm(desk):
    """Norms that linear programs prove: the bits of `fit`, or the reason."""
    mask = np.zeros((6, 5), bool)
    mask[4, 1] = True
    np.save(desk / "mask.npy", mask)
    command = ["stack.npy", "-g", "geometry.csv", "--mask", "mask.npy", "--norm", "l1", "-o", "m.npz"]
    if not harness.has_ecos():
        assert "ECOS" in stacks.run(desk, *command, expect=2).stderr
        return
    stacks.run(desk, *command)
    maps = stacks.maps(desk / "m.npz")
    line = single(desk, np.load(desk / "lights.npy"), np.load(desk / "views.npy"),
                  np.load(desk / "stack.npy")[:, 4, 1].astype(float), "--norm", "l1")
    assert maps["sigma"][4, 1].tolist() == line["sigma"] and maps["e2"][4, 1] == line["e2"]
    assert (maps["status"] == np.where(mask, CERTIFIED, MASKED)).all()
