"""Faults at every place where they can happen: allocations that fail, disks that are full or broken, deaths, files that are
cut short while they are read. The rule: whatever happens, an output is the old one or a new one, whole; the reason is
said and is the true one; and the same command, once more, does what it does without the fault.

    python tests/faults/campaign.py [--long] [--only KIND] [SCENE ...]

prints a table; exit status 1 when a rule was broken. tests/faults/test_faults.py plays a part of it in `make check`.

SPDX-License-Identifier: MIT
"""
import argparse
import os
import pathlib
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

import scenes
from scenes import SCENES, Stage, harness

PROGRAMS = harness.BUILD / "tests" / "faults"
INJECT, FAIL_ALLOC = PROGRAMS / "inject", PROGRAMS / "fail_alloc.so"
UNABLE = 77


def spread(count, most):
    """`most` of the numbers from 1 to count, the first and the last among them."""
    if count <= most:
        return range(1, count + 1)
    return sorted({1 + i * (count - 1) // max(1, most - 1) for i in range(most)})


def play(stage, faults, codes):
    """Each fault, then the same command without. Yields what went wrong, or None."""
    for words, wrapper, variables in faults:
        stage.reset()
        run = stage.play(wrapper, **variables)
        killed = run.code in (128 + 9, -9)
        wrong = stage.torn(run) if killed else stage.problem(run, codes)
        done = wrong is None and not killed and run.output == stage.good.output and run.code == stage.good.code
        if wrong is None and not done:
            wrong = stage.again() if not finished(stage) else None
        yield None if wrong is None else "%s %s: %s" % (stage.scene.name, words, wrong)


def finished(stage):
    """Whether a run had come to its end before it failed or died: a merge of maps has nothing more to merge then."""
    return stage.scene.prepare is not None and scenes.content(stage.folder / stage.scene.output) == stage.good.output


# ---- Kinds of fault ----------------------------------------------------------------------------------------------


def allocations(stage, most):
    """Every k-th allocation once, and from there on. Never bad data (3), never wrong usage (2)."""
    path = stage.folder.parent / "allocations"
    stage.reset()
    stage.play(LD_PRELOAD=str(FAIL_ALLOC), FAIL_ALLOC_COUNT=str(path))
    count = int(path.read_text())
    faults = [("allocation %d%s" % (k, " on" if good else ""), (),
               {"LD_PRELOAD": str(FAIL_ALLOC), "FAIL_ALLOC_AT": str(k), "FAIL_ALLOC_FOR_GOOD": str(good)})
              for k in spread(count, most) for good in (0, 1)]
    return faults, {1}


def calls(stage, kind):
    """How many calls of a kind a run makes; None where we may not look."""
    path = stage.folder.parent / "calls"
    stage.reset()
    run = stage.play((INJECT, kind, "count", path, "--"))
    return None if run.code == UNABLE else int(path.read_text())


def failing(stage, kind, errors, most):
    count = calls(stage, kind)
    if count is None:
        return None, set()
    return [("%s at %s %d%s" % (error, kind, k, " on" if on else ""),
             (INJECT, kind, "error", error, k, *(["on"] if on else []), "--"), {})
            for error in errors for k in spread(count, most) for on in (0, 1)], {1}


def full_disk(stage, most):
    return failing(stage, "write", ("ENOSPC",), most)


def broken_disk(stage, most):
    faults, codes = failing(stage, "touch", ("EIO",), most)
    return faults, codes | {3}


def kills(stage, most):
    count = calls(stage, "touch")
    if count is None:
        return None, set()
    return [("kill at %d" % k, (INJECT, "touch", "kill", k, "--"), {}) for k in spread(count, most)], set()


def inputs(stage):
    more = ["images/3.png", "merged.npz.brdffit-work/tile-1", "merged.npz.brdffit-work/manifest"]
    return [word for word in (*stage.scene.command, *more) if (stage.origin / word).is_file()
            and (word not in more or stage.scene.prepare or "images" in stage.scene.command)]


def truncations(stage, most):
    """Inputs that are cut short while they are read. To be told as what they are, and never a signal."""
    count = calls(stage, "read")
    if count is None:
        return None, set()
    found = inputs(stage)
    faults = []
    for i, k in enumerate(spread(count, most)):
        name = found[i % len(found)]
        size = (stage.origin / name).stat().st_size * (i % 7) // 7
        faults.append(("%s cut to %d at %d" % (name, size, k), (INJECT, "read", "truncate", name, size, k, "--"), {}))
    return faults, {1, 3}


KINDS = {"allocations": (allocations, 8, 10**9), "full disk": (full_disk, 4, 60), "broken disk": (broken_disk, 4, 60),
         "kills": (kills, 6, 100), "truncations": (truncations, 4, 170)}


def run(kind, scene, most, folder):
    """How many faults there were, and those that broke a rule. None: this system does not let us inject."""
    make = KINDS[kind][0]
    stage = Stage(scene, folder)
    faults, codes = make(stage, most)
    if faults is None:
        return None, []
    if kind == "truncations":  # the file stays short: no run after
        results = [None if wrong is None else "%s %s: %s" % (scene.name, words, wrong)
                   for words, wrong in cut(stage, faults, codes)]
    else:
        results = list(play(stage, faults, codes))
    return len(results), [wrong for wrong in results if wrong]


def cut(stage, faults, codes):
    for words, wrapper, variables in faults:
        stage.reset()
        done = stage.play(wrapper, **variables)
        if done.code in (stage.good.code, *codes):
            yield words, None if done.code == stage.good.code or done.stderr.strip() else "not a word"
        else:
            yield words, "exit status %d: %s" % (done.code, done.stderr)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--long", action="store_true", help="every allocation, and many more of the others")
    parser.add_argument("--only", choices=sorted(KINDS))
    parser.add_argument("scenes", nargs="*")
    arguments = parser.parse_args()
    broken = 0
    for kind in [arguments.only] if arguments.only else KINDS:
        for scene in SCENES:
            if arguments.scenes and scene.name not in arguments.scenes:
                continue
            with tempfile.TemporaryDirectory() as folder:
                count, wrong = run(kind, scene, KINDS[kind][2 if arguments.long else 1], pathlib.Path(folder))
            print("%-12s %-10s %6s faults, %d broken" % (kind, scene.name, "no" if count is None else count, len(wrong)),
                  flush=True)
            for line in wrong:
                print("    " + line.strip().replace("\n", "\n        "), flush=True)
            broken += len(wrong)
    return 1 if broken else 0


if __name__ == "__main__":
    os.umask(0o022)
    sys.exit(main())
