"""brdffit fit --shard, map --shard and merge: parts, together again as one run. SPDX-License-Identifier: MIT"""
import os
import re
import shutil
import signal
import subprocess
import zlib

import numpy as np
import pytest

import harness
import stacks

FILES = ["matte.csv", "infinite.csv", "two_lobe_table.binary", "missing.csv", "single.csv", "lying.binary", "ggx_metal.csv",
         "mis.csv", "two_lobe_satin.csv", "./mis.csv", "gone.csv"]


def timeless(text):
    """The bytes without the seconds that each file took: nothing else may depend on the run."""
    return re.sub(r'"seconds":(\{[^}]*\}|[-+.0-9e]+)', '"seconds":0', text)


def fit_parts(folder, count, *options, files=FILES):
    """Exit codes of the parts, which become part-I.json."""
    return [harness.run("fit", "--json", "-q", "--shard", "%d/%d" % (i, count), "-o", "part-%d.json" % i, *options, *files,
                        cwd=folder).returncode for i in range(1, count + 1)]


def merge(folder, *arguments, expect=0, **more):
    done = harness.run("merge", *arguments, cwd=folder, **more)
    assert done.returncode == expect, (done.returncode, done.stdout, done.stderr)
    return done


# ---- Fits ------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("count", [1, 3, 11, 14])
@pytest.mark.parametrize("options", [(), ("--lobes", "2", "--merl-samples", "matte.csv"),
                                     ("--lobes", "ggx,lafortune", "--gap", "0.1")], ids=" ".join)
def test_the_bytes_of_one_run(desk, count, options):
    whole = harness.run("fit", "--json", *options, *FILES, cwd=desk)
    codes = fit_parts(desk, count, *options)
    assert max(codes) > 0 and whole.returncode == 1
    if count == 14:
        assert codes[11:] == [0, 0, 0] and (desk / "part-13.json").read_text() == ""
    parts = ["part-%d.json" % i for i in range(1, count + 1)]
    done = merge(desk, *parts[::-1], expect=whole.returncode)
    assert timeless(done.stdout) == timeless(whole.stdout)
    assert "shard" not in done.stdout
    merge(desk, *parts, "-o", "merged.json", expect=whole.returncode)
    assert timeless((desk / "merged.json").read_text()) == timeless(whole.stdout)


def test_one_stream_of_lines(desk):
    """As GNU parallel collects them: any order, one stream; and a summary on standard error."""
    whole = harness.run("fit", "--json", *FILES, cwd=desk)
    fit_parts(desk, 3)
    lines = [line for i in (2, 3, 1) for line in (desk / ("part-%d.json" % i)).read_text().splitlines(True)]
    np.random.default_rng(1).shuffle(lines)
    done = merge(desk, "-", stdin="".join(lines).encode(), expect=1)
    assert timeless(done.stdout) == timeless(whole.stdout)
    assert done.stderr == "brdffit: 11 files: 7 certified, 0 open, 4 failed\n"
    assert merge(desk, "-q", "-", stdin="".join(lines).encode(), expect=1).stderr == ""


def test_the_exit_status_is_that_of_one_run(desk):
    for files, options in [(["single.csv", "matte.csv"], ()), (["single.csv", "infinite.csv"], ()),
                           (["infinite.csv", "missing.csv"], ()),
                           (["mis.csv", "single.csv"], ("--lobes", "2", "--box-budget", "1")),
                           (["mis.csv", "infinite.csv"], ("--lobes", "2", "--box-budget", "1"))]:
        wanted = harness.run("fit", "--json", "-q", *options, *files, cwd=desk).returncode
        fit_parts(desk, 2, *options, files=files)
        merge(desk, "part-1.json", "part-2.json", expect=wanted)


@pytest.mark.skipif(not harness.has_ecos(), reason="this build is without ECOS")
def test_a_proof_that_failed_counts(desk):
    options = ["--verify", "socp=1e-3", "--box-budget", "60"]
    wanted = harness.run("fit", "--json", "-q", *options, "mis.csv", cwd=desk)
    assert wanted.returncode == 4 and harness.lines(wanted.stdout)[0]["status"] == "certified"
    fit_parts(desk, 1, *options, files=["mis.csv"])
    done = merge(desk, "part-1.json", expect=4)
    assert timeless(done.stdout) == timeless(wanted.stdout)


def test_parts_are_lines_of_fit(desk):
    """Every Nth file from the Ith, in order; eval reads a part as it is."""
    fit_parts(desk, 3)
    for i in (1, 2, 3):
        lines = harness.lines((desk / ("part-%d.json" % i)).read_text())
        assert [line["file"] for line in lines] == FILES[i - 1::3]
        assert [line["shard"]["position"] for line in lines] == list(range(i, len(FILES) + 1, 3))
        assert {(line["shard"]["part"], line["shard"]["of"], line["shard"]["files"]) for line in lines} == {(i, 3, 11)}
    assert harness.run("eval", "part-1.json", "matte.csv", cwd=desk).returncode == 0


@pytest.mark.parametrize("name", ['a",shard":{.csv', 'a,"shard":{"part":1,"of":1.csv', "a\nb.csv", "caf\udce9.csv"])
def test_names_that_look_like_stamps(desk, name):
    shutil.copy(desk / "matte.csv", desk / name)
    files = [name, "single.csv"]
    whole = harness.run("fit", "--json", *files, cwd=desk)
    fit_parts(desk, 2, files=files)
    assert timeless(merge(desk, "part-2.json", "part-1.json").stdout) == timeless(whole.stdout)


def refuse(folder, *arguments, says, **more):
    """Nothing is written: what was there stays."""
    (folder / "out.json").write_text("old")
    before = sorted(p.name for p in folder.iterdir())
    done = merge(folder, *arguments, "-o", "out.json", expect=3, **more)
    assert says in done.stderr and done.stdout == "", done.stderr
    assert (folder / "out.json").read_text() == "old" and sorted(p.name for p in folder.iterdir()) == before


def test_what_does_not_go_together(desk):
    files = ["single.csv", "infinite.csv", "grey.csv", "needle.csv", "missing.csv"]
    fit_parts(desk, 3, files=files)
    one, two, three = "part-1.json", "part-2.json", "part-3.json"
    refuse(desk, one, two, says="1 of 5 files are missing: part 3/3\n")
    refuse(desk, three, says="4 of 5 files are missing: part 1/3, part 2/3\n")
    refuse(desk, one, two, three, one, says="file 1 of the run, in part 1/3, is there twice: part-1.json, line 1, and "
                                             "part-1.json, line 1\n")
    text = (desk / two).read_text()
    (desk / "short.json").write_text(text.splitlines(True)[0])
    refuse(desk, one, "short.json", three, says="1 of 5 files are missing: part 2/3 (only 1 of 2)\n")
    for cut in (1, 2, 9, 40, len(text) // 3):  # a part that was killed, or copied in part
        (desk / "cut.json").write_text(text[:-cut])
        refuse(desk, one, "cut.json", three, says="cut.json: line")
    fit_parts(desk, 2, files=files)
    shutil.copy(desk / "part-2.json", desk / "half.json")
    fit_parts(desk, 3, files=files)
    refuse(desk, one, "half.json", three, says="half.json: line 1: part 2/2, but the lines before are of parts N/3")
    for other in (["--lobes", "2", *files], [*files[:3], "empty.csv", "missing.csv"], [*files[1:], files[0]]):
        harness.run("fit", "--json", "--shard", "2/3", "-o", "other.json", *other, cwd=desk)
        refuse(desk, one, "other.json", three, says="other.json: line 1: of another run than the lines before")
    harness.run("fit", "--json", "--shard", "2/3", "-o", "other.json", *files, "empty.csv", cwd=desk)
    refuse(desk, one, "other.json", says="of a run on 6 files, but the lines before are of one on 5")
    harness.run("fit", "--json", "-o", "plain.json", *files, cwd=desk)
    refuse(desk, one, "plain.json", says="plain.json: line 1: this is not a line of 'brdffit fit --json --shard'")


def test_changed_lines(desk):
    """Whatever byte of a line is changed, it is noticed."""
    fit_parts(desk, 1, files=["single.csv"])
    line = (desk / "part-1.json").read_bytes()
    rng = np.random.default_rng(7)
    for at in [0, 1, len(line) - 2, len(line) - 3, *rng.integers(0, len(line) - 1, 60)]:
        changed = bytearray(line)
        changed[at] ^= 1 << int(rng.integers(0, 7))
        done = merge(desk, "-", stdin=bytes(changed), expect=3)
        assert done.stdout == "" and "line 1" in done.stderr
    for stamp in ['"part":2', '"part":01', '"of":0', '"position":0', '"files":0', '"files":99999999999999999999']:
        name = stamp.split(":")[0]
        merge(desk, "-", stdin=re.sub(name + r':\d+', stamp, line.decode()).encode(), expect=3)


def stamped(line, part, of, position, files):
    """The line with another stamp, and its checksum."""
    head = line.partition(',"shard":')[0] + ',"shard":{"part":%d,"of":%d,"position":%d,"files":%d,"run":"%016x"' % (
        part, of, position, files, 7)
    return head + ',"crc32":"%08x"}}\n' % zlib.crc32(head.encode())


def test_claims_beyond_reason(desk):
    """Stamps that are in order but tell of more than there could be."""
    fit_parts(desk, 1, files=["single.csv"])
    line = (desk / "part-1.json").read_text()
    huge = 2**64 - 1
    for numbers, says in [((1, 1, 1, huge), "%d of %d files are missing: part 1/1 (only 1 of %d)\n" % (huge - 1, huge, huge)),
                          ((1, huge, 1, huge), "part 2/%d, part 3/" % huge),
                          ((huge, huge, huge, huge), "part 1/%d, part 2/" % huge),
                          ((2, 1, 1, 3), "not as it was written"), ((2, 3, 4, 9), "not as it was written"),
                          ((1, 1, 4, 3), "not as it was written")]:
        assert says in merge(desk, "-", stdin=stamped(line, *numbers).encode(), expect=3).stderr, numbers
    assert merge(desk, "-", stdin=stamped(line, 1, 1, 1, 1).encode()).stdout == line.partition(',"shard":')[0] + "}\n"


def test_an_interrupted_part(desk):
    """Its files that were not begun are told, as one run would; the exit status says that it is not all."""
    os.mkfifo(desk / "pipe.csv")
    process = subprocess.Popen([harness.BRDFFIT, "fit", "--json", "--shard", "1/2", "-o", "part-1.json", "pipe.csv",
                                "infinite.csv", "single.csv"], cwd=desk, stderr=subprocess.PIPE, env=harness.environment())
    with open(desk / "pipe.csv", "wb") as pipe:
        pipe.write(b"# " + b"x" * 500000 + b"\n")  # more than a pipe holds: the reader is at work
        pipe.flush()
        process.send_signal(signal.SIGINT)
        pipe.write((desk / "matte.csv").read_bytes())
    assert process.wait(harness.PATIENCE) == 4 and b"1 file was not begun" in process.communicate()[1]
    harness.run("fit", "--json", "--shard", "2/2", "-o", "part-2.json", "pipe.csv", "single.csv", "single.csv", cwd=desk)
    refuse(desk, "part-1.json", "part-2.json", says="of another run")
    harness.run("fit", "--json", "--shard", "2/2", "-o", "part-2.json", "pipe.csv", "infinite.csv", "single.csv", cwd=desk)
    done = merge(desk, "part-1.json", "part-2.json", expect=3)
    assert [line["file"] for line in harness.lines(done.stdout)] == ["pipe.csv", "infinite.csv", "single.csv"]
    assert harness.lines(done.stdout)[2]["error"]["code"] == "interrupted"
    assert "a part was interrupted; 1 file was not begun" in done.stderr


# ---- Maps ------------------------------------------------------------------------------------------------------------


@pytest.fixture
def stack(tmp_path):
    """A stack of 6 x 5 texels, and the command that maps it in tiles of a row."""
    values, light, view = stacks.make(6, 5)
    values[3, 2, 2] = np.nan
    np.save(tmp_path / "stack.npy", values.astype("f4"))
    stacks.vectors_csv(tmp_path / "geometry.csv", light, view)
    return tmp_path


COMMAND = ["stack.npy", "-g", "geometry.csv", "--tile", "1"]


@pytest.mark.parametrize("options", [("--lobes", "2"), ("--lobes", "ggx,blinn-phong", "--gap", "0.05"),
                                     ("--distribution", "blinn-phong", "--gap", "1e-5", "--values", "radiance",
                                      "--exponent-max", "1e5", "--absolute-gap", "1e-9", "--normalise", "none"),
                                     ("--sigma-min", "0.02", "--sigma-max", "3", "--max-incidence", "50", "--resolution",
                                      "1e-9", "--box-budget", "99999")],
                         ids=" ".join)
@pytest.mark.parametrize("target", ["m.npz", "m", "pfm"])
def test_maps(stack, target, options):
    """Parts in any order; merge without the stack gives the bytes, the words and the exit status of one run."""
    form = ["--format", "pfm"] if target == "pfm" else []
    whole = stacks.run(stack, *COMMAND, *options, *form, "-o", "whole" + target, expect=3)
    for part in ("2/3", "3/3", "1/3"):
        stacks.run(stack, *COMMAND, *options, "-o", target, "--shard", part)
        assert not (stack / target).exists()
    (stack / "stack.npy").rename(stack / "elsewhere.npy")
    done = merge(stack, target, *form, expect=3)
    if target == "m.npz":
        assert (stack / target).read_bytes() == (stack / ("whole" + target)).read_bytes()
    else:
        names = sorted(p.name for p in (stack / target).iterdir())
        assert names == sorted(p.name for p in (stack / ("whole" + target)).iterdir()) and "map.json" in names
        for name in names:
            assert (stack / target / name).read_bytes() == (stack / ("whole" + target) / name).read_bytes(), name

    def words(text):
        return [line for line in text.splitlines() if not line.startswith(("  Run:", "  Maps:"))]

    assert words(done.stdout)[:2] == words(whole.stdout)[:2] and done.stderr == whole.stderr
    assert not (stack / (target + ".brdffit-work")).exists()
    assert "the maps are together already" in " ".join(merge(stack, target + ".brdffit-work", expect=1).stderr.split())


def test_maps_of_names_with_lines(stack):
    """A line of a file's name is no option of the run."""
    (stack / "stack.npy").rename(stack / "st\n--lobes 2\n--tile 3\n.npy")
    (stack / "geometry.csv").rename(stack / "g\n--lobes 2\n--gap 0.5.csv")
    command = ["st\n--lobes 2\n--tile 3\n.npy", "-g", "g\n--lobes 2\n--gap 0.5.csv"]
    stacks.run(stack, *command, "-o", "whole", expect=3)
    for part in ("1/2", "2/2"):
        stacks.run(stack, *command, "--tile", "1", "-o", "m", "--shard", part)
    merge(stack, "m", expect=3)
    for path in (stack / "whole").iterdir():
        assert path.read_bytes() == (stack / "m" / path.name).read_bytes(), path.name


def test_maps_that_are_not_all_there(stack):
    work = stack / "m.brdffit-work"
    for part in ("1/4", "4/4"):
        stacks.run(stack, *COMMAND, "-o", "m", "--shard", part)
    done = merge(stack, "m", expect=3)
    assert "m.brdffit-work: 3 of 6 tiles are missing or damaged: 2, 3, 6\nOf N parts" in done.stderr
    for part in ("2/4", "3/4"):
        stacks.run(stack, *COMMAND, "-o", "m", "--shard", part)
    good = (work / "tile-4").read_bytes()
    for bad in (good[:-20], good[:200] + bytes([good[200] ^ 1]) + good[201:], (work / "tile-3").read_bytes()):
        (work / "tile-4").write_bytes(bad)
        assert "1 of 6 tiles are missing or damaged: 5\n" in merge(stack, "m", expect=3).stderr
    (work / "tile-4").write_bytes(good)
    assert "they go where 'brdffit map' was told" in merge(stack, "m", "-o", "n", expect=2).stderr
    assert "one at a time" in merge(stack, "m", "m", expect=2).stderr
    manifest = (work / "manifest").read_text()
    for old, new, says in [("brdffit map 1", "another thing", "is not one of 'brdffit map'"),
                           ("version ", "version 9", "version 9"), ("--lobes 1", "--lobes 4", "damaged"),
                           ("--lobes 1", "--lobes ggx,phong", "damaged"), ("--lobes 1", "--lobes ", "damaged"),
                           ("maps of", "of", "damaged"), ("--tile 1", "--tile 0", "damaged"),
                           ("--gap", "--gag", "damaged"), ("6 x 5 x", "6 x 99999999999999 x", "damaged"),
                           ("6 x 5 x", "5 x 6 x", "5 of 5 tiles are missing or damaged"),
                           ("beckmann", "blinn-phong", "6 of 6 tiles are missing or damaged")]:
        (work / "manifest").write_text(manifest.replace(old, new))
        assert says in merge(stack, "m", expect=3).stderr, (old, new)
    assert not (stack / "m").exists()
    (work / "manifest").write_text(manifest)
    merge(stack, "./m.brdffit-work/", "-q", expect=3)
    assert (np.load(stack / "m" / "status.npy") == 4).sum() == 1


def test_maps_at_work(stack):
    """Not while a part runs: its tiles are still to come."""
    fcntl = pytest.importorskip("fcntl")
    stacks.run(stack, *COMMAND, "-o", "m", "--shard", "1/1")
    with open(stack / "m.brdffit-work" / "lock", "rb") as file:
        fcntl.lockf(file, fcntl.LOCK_SH)
        assert "another brdffit map is at work" in merge(stack, "m", expect=1).stderr
    merge(stack, "m", expect=3)
