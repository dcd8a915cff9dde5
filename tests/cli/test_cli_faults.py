"""What goes wrong around a run: an input that cannot be read, files that change or were planted, a death before. Nothing
that was there is lost, nothing is mixed, and no string from a file steers the terminal.

SPDX-License-Identifier: MIT
"""
import os
import signal
import subprocess
import time

import numpy as np
import pytest

import harness
import stacks

ESCAPE = "\x1b]0;x\x07\x1b[31m"
BIDI = "\u202e\u2066"


@pytest.fixture
def desk(tmp_path):
    stack, light, view = stacks.make(6, 5)
    np.save(tmp_path / "stack.npy", stack)
    stacks.vectors_csv(tmp_path / "geometry.csv", light, view)
    (tmp_path / "mixed.csv").write_bytes((harness.DATA / "mixed.csv").read_bytes())
    return tmp_path


def left_behind(folder):
    return sorted(str(path.relative_to(folder)) for path in folder.rglob(".brdffit-*"))


# ---- Outputs stay as they were ---------------------------------------------


@pytest.mark.parametrize("command", [["fit"], ["compare", "--models", "beckmann"], ["info"], ["fit", "--quiet"]])
@pytest.mark.parametrize("bad", ["absent.csv", "bad_words.csv"])
def test_output_is_not_emptied(desk, command, bad):
    (desk / "bad_words.csv").write_text("theta_i,theta_o,r\n1,2,word\n")
    (desk / "OUT").write_text("results of yesterday\n")
    done = harness.run(*command, bad, "-o", "OUT", cwd=desk)
    assert done.returncode in (1, 3) and done.stderr
    assert (desk / "OUT").read_text() == "results of yesterday\n"
    assert harness.run(*command, bad, "-o", "NEW", cwd=desk).returncode in (1, 3)
    assert not (desk / "NEW").exists() and left_behind(desk) == []


def test_part_without_files_is_an_empty_one(desk):
    """What a job array expects of each of its tasks, also where there was another run's."""
    (desk / "part").write_text("old\n")
    assert harness.run("fit", "--json", "--shard", "2/2", "mixed.csv", "-o", "part", cwd=desk).returncode == 0
    assert (desk / "part").read_text() == ""


def kill_while_writing(folder, *command):
    """A run that is killed while its temporary file is there. Returns that file's path."""
    process = subprocess.Popen([harness.BRDFFIT, *command], cwd=folder, env=harness.environment(),
                               stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    end = time.monotonic() + harness.PATIENCE
    while not left_behind(folder):
        assert process.poll() is None and time.monotonic() < end
        time.sleep(0.001)
    process.send_signal(signal.SIGKILL)
    process.wait()
    return left_behind(folder)


def test_what_a_dead_run_left_goes(desk):
    os.mkfifo(desk / "pipe")  # nobody writes: the run waits, with its output open
    assert kill_while_writing(desk, "fit", "pipe", "-o", "OUT") != []
    assert harness.run("fit", "mixed.csv", "-o", "OUT", cwd=desk).returncode == 0
    assert left_behind(desk) == [] and (desk / "OUT").read_text()


def test_what_a_live_run_writes_stays(desk):
    os.mkfifo(desk / "pipe")
    process = subprocess.Popen([harness.BRDFFIT, "fit", "pipe", "-o", "OUT"], cwd=desk, env=harness.environment(),
                               stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    while not left_behind(desk):
        assert process.poll() is None
        time.sleep(0.001)
    before = left_behind(desk)
    assert harness.run("fit", "mixed.csv", "-o", "OTHER", cwd=desk).returncode == 0
    assert left_behind(desk) == before
    (desk / "pipe").write_bytes((desk / "mixed.csv").read_bytes())
    assert process.wait(harness.PATIENCE) == 0
    assert left_behind(desk) == [] and (desk / "OUT").read_text()


def test_only_our_own_names_are_swept(desk):
    """Neither a name that only looks like it, nor a link, nor a folder."""
    names = [".brdffit-1-0.tmp.bak", ".brdffit-x-0.tmp", ".brdffit-1.tmp"]
    for name in names:
        (desk / name).write_text("mine")
    (desk / "victim").write_text("mine")
    (desk / ".brdffit-1-1.tmp").symlink_to("victim")
    (desk / ".brdffit-1-2.tmp").mkdir()
    (desk / ".brdffit-1-3.tmp").write_text("a dead run's")
    assert harness.run("fit", "mixed.csv", "-o", "OUT", cwd=desk).returncode == 0
    assert left_behind(desk) == sorted([*names, ".brdffit-1-1.tmp", ".brdffit-1-2.tmp"])
    assert (desk / "victim").read_text() == "mine"


def test_leftovers_do_not_end_up_among_the_maps(desk):
    stacks.run(desk, "stack.npy", "-g", "geometry.csv", "-o", "whole")
    stacks.run(desk, "stack.npy", "-g", "geometry.csv", "-o", "m", "--shard", "1/1")
    (desk / "m.brdffit-work" / "out").mkdir()
    (desk / "m.brdffit-work" / "out" / ".brdffit-1-0.tmp").write_text("half a map")
    (desk / "m.brdffit-work" / ".brdffit-1-0.tmp").write_text("half a tile")
    stacks.run(desk, "stack.npy", "-g", "geometry.csv", "-o", "m")
    assert sorted(os.listdir(desk / "m")) == sorted(os.listdir(desk / "whole"))


# ---- Files that change -----------------------------------------------------


def rewrite_in_place(path, data):
    """The same size and, by the hands of who wants so, time."""
    about = path.stat()
    with open(path, "r+b") as file:
        file.write(data)
    os.utime(path, ns=(about.st_atime_ns, about.st_mtime_ns))


def npy(array):
    import io

    file = io.BytesIO()
    np.save(file, array)
    return file.getvalue()


@pytest.mark.parametrize("what", ["stack", "normals", "mask"])
def test_resume_looks_at_the_data(desk, what):
    """Size and time restored: tiles that were fitted to other data are fitted again, and that is said."""
    stack = np.load(desk / "stack.npy")
    np.save(desk / "n.npy", np.broadcast_to([0.0, 0, 1], (6, 5, 3)))
    np.save(desk / "mask.npy", np.ones((6, 5)))
    command = ["stack.npy", "-g", "geometry.csv", "--normals", "n.npy", "--mask", "mask.npy", "--tile", "1"]
    stacks.run(desk, *command, "-o", "m.npz", "--shard", "1/2")
    if what == "stack":
        stack[:, 2] *= 1.5
        rewrite_in_place(desk / "stack.npy", npy(stack))
    elif what == "normals":
        normals = np.array(np.broadcast_to([0.0, 0, 1], (6, 5, 3)))
        normals[2, :, 0] = 0.1
        rewrite_in_place(desk / "n.npy", npy(normals))
    else:
        mask = np.ones((6, 5))
        mask[2, 3] = 0
        rewrite_in_place(desk / "mask.npy", npy(mask))
    done = stacks.run(desk, *command, "-o", "m.npz")
    assert "1 kept tile was of other data than the files have now" in done.stderr
    assert "2 of them from an earlier run" in " ".join(done.stdout.split())
    stacks.run(desk, *command, "-o", "whole.npz")
    assert (desk / "m.npz").read_bytes() == (desk / "whole.npz").read_bytes()


@pytest.mark.parametrize("name", ["geometry.csv", "lights.npy"])
def test_resume_looks_at_the_geometry(desk, name):
    """All texels share it: nothing that was kept is any good."""
    _, light, view = stacks.make(1, 1)
    np.save(desk / "lights.npy", light)
    command = ["stack.npy", *(["-g", name] if name.endswith("csv") else ["--lights", name]), "-o", "m.npz"]
    stacks.run(desk, *command, "--shard", "1/2")
    raw = (desk / name).read_bytes()
    at, new = (raw.rindex(b"0.1"), b"0.2") if name.endswith("csv") else (len(raw) - 8, b"\0")
    rewrite_in_place(desk / name, raw[:at] + new + raw[at + len(new):])
    done = stacks.run(desk, *command, expect=2)
    assert "holds an unfinished run that differs" in done.stderr and "content of" in done.stderr


def test_times_are_a_matter_of_parts(desk):
    """A run goes on with a file that was only touched. Parts of different times are not put together unseen."""
    command = ["stack.npy", "-g", "geometry.csv", "-o", "m.npz", "--tile", "1"]
    stacks.run(desk, *command, "--shard", "1/2")
    os.utime(desk / "stack.npy")
    assert "then: time of stack stack.npy" in stacks.run(desk, *command, "--shard", "2/2", expect=2).stderr
    assert "3 of them from an earlier run" in " ".join(stacks.run(desk, *command).stdout.split())


def test_a_stack_that_changes_under_a_run(tmp_path):
    """No maps of two stacks; the same command then gives those of the second."""
    stack, light, view = stacks.make(40, 12, lobes=2)
    other = stacks.make(40, 12, lobes=2, seed=2)[0]
    np.save(tmp_path / "stack.npy", stack)
    np.save(tmp_path / "n.npy", np.broadcast_to([0.0, 0, 1], (40, 12, 3)))
    stacks.vectors_csv(tmp_path / "geometry.csv", light, view)
    command = ["stack.npy", "-g", "geometry.csv", "--normals", "n.npy", "--lobes", "2", "--tile", "1", "--threads", "1"]
    process = subprocess.Popen([harness.BRDFFIT, "map", *command, "-o", "m.npz"], cwd=tmp_path,
                               env=harness.environment(), stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    while not list((tmp_path / "m.npz.brdffit-work").glob("tile-?")):
        assert process.poll() is None
        time.sleep(0.001)
    rewrite_in_place(tmp_path / "stack.npy", npy(other))
    _, errors = process.communicate(timeout=harness.PATIENCE)
    assert process.returncode == 1 and b"stack.npy: the file changed while it was read" in errors
    assert not (tmp_path / "m.npz").exists()
    assert "of other data" in stacks.run(tmp_path, *command, "-o", "m.npz").stderr
    stacks.run(tmp_path, *command, "-o", "whole.npz")
    assert (tmp_path / "m.npz").read_bytes() == (tmp_path / "whole.npz").read_bytes()


# ---- Planted files ---------------------------------------------------------

WORK = "m.npz.brdffit-work"


@pytest.mark.parametrize("name", ["lock", "manifest", "tile-0", "images.npy", "out"])
def test_links_in_the_work_folder_lead_nowhere(desk, name):
    victim = desk / "victim"
    victim.mkdir() if name == "out" else victim.write_text("mine")
    (desk / WORK).mkdir()
    (desk / WORK / name).symlink_to(victim)
    output = "m.npz"
    if name == "images.npy":
        for i in range(84):
            stacks.png(desk / ("%02d.png" % i), np.full((2, 2, 3), 100 + i, np.uint8))
        (desk / "images").mkdir()
        for path in desk.glob("*.png"):
            path.rename(desk / "images" / path.name)
    if name == "out":
        (desk / WORK).rename(desk / "m.brdffit-work")
        output = "m"
    harness.run("map", "images" if name == "images.npy" else "stack.npy", "-g", "geometry.csv", "-o", output, cwd=desk)
    assert (list(victim.iterdir()) == []) if name == "out" else (victim.read_text() == "mine")


def test_a_work_folder_that_is_a_link(desk):
    (desk / "elsewhere").mkdir()
    (desk / WORK).symlink_to("elsewhere")
    done = stacks.run(desk, "stack.npy", "-g", "geometry.csv", "-o", "m.npz", expect=1)
    assert "it is a link, and no work folder of yours" in done.stderr
    assert list((desk / "elsewhere").iterdir()) == []


@pytest.mark.skipif(os.geteuid() != 0, reason="only root can give a folder away")
def test_a_work_folder_of_another_user(desk):
    (desk / WORK).mkdir()
    os.chown(desk / WORK, 12345, 12345)
    done = stacks.run(desk, "stack.npy", "-g", "geometry.csv", "-o", "m.npz", expect=1)
    assert "it belongs to another user" in done.stderr and list((desk / WORK).iterdir()) == []


def test_one_part_twice_at_once(desk):
    """Each writes under names of its own: whoever is last, the tiles are whole."""
    np.save(desk / "n.npy", np.broadcast_to([0.0, 0, 1], (6, 5, 3)))
    command = ["stack.npy", "-g", "geometry.csv", "--normals", "n.npy", "--tile", "1"]
    runs = [subprocess.Popen([harness.BRDFFIT, "map", *command, "-o", "m.npz", "--shard", "1/1"], cwd=desk,
                             env=harness.environment(), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
            for _ in range(6)]
    for process in runs:
        _, errors = process.communicate(timeout=harness.PATIENCE)
        assert process.returncode == 0, errors
    assert harness.run("merge", "m.npz", cwd=desk).returncode == 0
    stacks.run(desk, *command, "-o", "whole.npz")
    assert (desk / "m.npz").read_bytes() == (desk / "whole.npz").read_bytes()


# ---- Strings from outside --------------------------------------------------


def terminal_safe(text):
    return not any(c < " " and c not in "\n\t" or "\x7f" <= c < "\xa0" or c in BIDI for c in text)


def harmless(done):
    assert terminal_safe(done.stdout) and terminal_safe(done.stderr), (done.stdout, done.stderr)
    assert done.returncode != 0 and done.stderr.startswith("brdffit")
    assert not any(line.startswith("brdffit: all") for line in done.stderr.splitlines()), done.stderr
    return done


EVIL = "e" + ESCAPE + BIDI + "\nbrdffit: all certified"


def test_names_that_do_not_exist(desk):
    for command in (["fit", EVIL], ["info", EVIL], ["eval", EVIL, "mixed.csv"], ["eval", "mixed.csv", EVIL], ["merge", EVIL],
                    ["map", EVIL, "-g", "geometry.csv"], ["map", "stack.npy", "-g", EVIL], ["compare", EVIL],
                    ["fit", "mixed.csv", "-o", EVIL + "/x"], ["map", "stack.npy", "--lights", EVIL],
                    ["map", "stack.npy", "-g", "geometry.csv", "--mask", EVIL],
                    ["fit", "mixed.csv", "--" + EVIL], ["fit", "mixed.csv", "-" + ESCAPE], ["--" + EVIL], [EVIL],
                    ["fit", "mixed.csv", "--norm", EVIL], ["fit", "mixed.csv", "--lobes", EVIL],
                    ["fit", "mixed.csv", "--distribution", EVIL], ["fit", "mixed.csv", "--gap", EVIL],
                    ["fit", "mixed.csv", "--shard", EVIL], ["compare", "mixed.csv", "--models", EVIL],
                    ["fit", "mixed.csv", "--model", EVIL], ["fit", "mixed.csv", "--merl-samples", EVIL]):
        harmless(harness.run(*command, cwd=desk))


def test_words_of_files(desk):
    import json

    said = {"schema": "brdffit.fit/1", "status": "error", "error": {"code": "x", "message": EVIL}}
    (desk / "fit.json").write_text(json.dumps(said))
    harmless(harness.run("eval", "fit.json", "mixed.csv", cwd=desk))
    _, light, view = stacks.make(1, 1)
    stacks.vectors_csv(desk / "list.csv", light, view, files=["e\x1b[31m%d.pfm" % i for i in range(84)])
    harmless(harness.run("map", "list.csv", cwd=desk))
    (desk / "evil.csv").write_text("theta_i,theta_o,r\x1b[31m\n1,2,x\n")
    harmless(harness.run("fit", "evil.csv", cwd=desk))


def test_output_that_exists_under_a_foreign_name(desk):
    """On standard output, too."""
    name = "s" + ESCAPE + ".npy"
    (desk / "stack.npy").rename(desk / name)
    for more in (["--shard", "1/2"], []):
        done = stacks.run(desk, name, "-g", "geometry.csv", "-o", "o" + ESCAPE, *more)
        assert terminal_safe(done.stdout) and "s?]0;x??[31m.npy" in done.stdout
