"""Runs that a fault may meet: a command, the files that it needs, and what it makes when nothing is wrong.

SPDX-License-Identifier: MIT
"""
import dataclasses
import json
import pathlib
import re
import shutil
import struct
import subprocess
import sys
from collections.abc import Callable

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "cli"))

import harness  # noqa: E402
import stacks  # noqa: E402

OLD = b"results of yesterday\n"
TIMES = re.compile(rb'"seconds":(\{[^}]*\}|[^,}]*)')


def table(path):
    """A MERL table of few cells, but of many pages: one lobe over an even ground."""
    dims = (16, 16, 32)
    half = np.radians(90 * (np.arange(dims[0]) / dims[0]) ** 2)
    values = 300 * (0.1 + np.exp(-(np.tan(np.minimum(half, 1.5)) / 0.25) ** 2))
    plane = np.repeat(values, dims[1] * dims[2])
    path.write_bytes(struct.pack("<3i", *dims) + np.concatenate([plane, plane, plane]).astype("<f8").tobytes())


def files(folder):
    """All that the scenes read."""
    stack, light, view = stacks.make(4, 3)
    np.save(folder / "stack.npy", stack)
    stacks.vectors_csv(folder / "geometry.csv", light, view)
    stacks.texel_csv(folder / "one.csv", light, view, stack[:, 0, 0])
    stacks.texel_csv(folder / "two.csv", light, view, stack[:, 1, 1])
    (folder / "bad.csv").write_text("theta_i,theta_o,r\n1,2,word\n")
    table(folder / "table.binary")
    (folder / "images").mkdir()
    for i in range(6):
        stacks.png(folder / "images" / ("%d.png" % i), (200 * np.clip(stack[i], 0, 1)).astype(np.uint8))
        stacks.pfm(folder / ("%d.pfm" % i), stack[i])
    stacks.vectors_csv(folder / "few.csv", light[:6], view[:6])
    stacks.vectors_csv(folder / "list.csv", light[:6], view[:6], files=["%d.pfm" % i for i in range(6)])
    (folder / "fit.json").write_text(harness.run("fit", "--json", "one.csv", cwd=folder).stdout)
    for i in (1, 2):
        (folder / ("part-%d.json" % i)).write_text(
            harness.run("fit", "--json", "--shard", "%d/2" % i, "one.csv", "two.csv", cwd=folder).stdout)


def shards(folder):
    for i in (1, 2):
        stacks.run(folder, "stack.npy", "-g", "geometry.csv", "--tile", "1", "-o", "merged.npz", "--shard", "%d/2" % i)


@dataclasses.dataclass(frozen=True)
class Scene:
    """A command that writes `output`, which may be there before (`old`)."""

    name: str
    command: tuple[str, ...]
    output: str
    old: bool = False  # there was one before
    prepare: Callable[[pathlib.Path], None] | None = None


SCENES = [
    Scene("fit", ("fit", "--json", "one.csv", "bad.csv", "-o", "OUT"), "OUT", True),
    Scene("fit-terms", ("fit", "--json", "--fresnel", "schlick", "--gap", "0.1", "--confidence", "90", "one.csv", "-o", "OUT"),
          "OUT", True),
    Scene("fit-table", ("fit", "--json", "table.binary", "--stats", "-o", "OUT"), "OUT", True),
    Scene("fit-socp", ("fit", "--json", "--engine", "socp", "--gap", "0.1", "one.csv", "-o", "OUT"), "OUT", True),
    Scene("fit-l1", ("fit", "--json", "--norm", "l1", "--gap", "0.1", "one.csv", "-o", "OUT"), "OUT", True),
    Scene("compare", ("compare", "--json", "--models", "beckmann,ggx", "one.csv", "-o", "OUT"), "OUT", True),
    Scene("eval", ("eval", "fit.json", "one.csv", "-o", "OUT"), "OUT", True),
    Scene("info", ("info", "one.csv", "-o", "OUT"), "OUT", True),
    Scene("merge", ("merge", "part-1.json", "part-2.json", "-o", "OUT"), "OUT", True),
    Scene("map", ("map", "stack.npy", "-g", "geometry.csv", "--tile", "2", "-o", "maps"), "maps"),
    Scene("map-npz", ("map", "stack.npy", "-g", "geometry.csv", "--tile", "2", "--threads", "2", "-o", "m.npz"), "m.npz"),
    Scene("map-png", ("map", "images", "-g", "few.csv", "--format", "pfm", "-o", "maps"), "maps"),
    Scene("map-list", ("map", "list.csv", "-o", "maps"), "maps"),
    Scene("merge-map", ("merge", "merged.npz"), "merged.npz", prepare=shards),
]
BY_NAME = {scene.name: scene for scene in SCENES}


@dataclasses.dataclass
class Run:
    code: int
    stdout: bytes
    stderr: str
    output: object  # bytes, a dictionary of them, or None


def content(path):
    if path.is_dir():
        return {file.name: file.read_bytes() for file in sorted(path.iterdir())}
    return TIMES.sub(b'"seconds":0', path.read_bytes()) if path.exists() else None


def left_behind(folder):
    return sorted(str(path.relative_to(folder)) for path in folder.rglob(".brdffit-*"))


class Stage:
    """A folder in which a scene is played again and again, each time from its beginning."""

    def __init__(self, scene, folder):
        self.scene, self.folder, self.origin = scene, folder / "stage", folder / "origin"
        self.origin.mkdir(parents=True)
        files(self.origin)
        if scene.prepare:
            scene.prepare(self.origin)
        self.reset()
        self.good = self.play()
        assert self.good.output is not None, self.good.stderr

    def reset(self):
        shutil.rmtree(self.folder, ignore_errors=True)
        shutil.copytree(self.origin, self.folder)
        if self.scene.old:
            (self.folder / self.scene.output).write_bytes(OLD)

    def play(self, wrapper=(), **variables):
        done = subprocess.run([*map(str, wrapper), harness.BRDFFIT, *self.scene.command], cwd=self.folder,
                              env=harness.environment(**variables), capture_output=True, timeout=harness.PATIENCE,
                              stdin=subprocess.DEVNULL)
        return Run(done.returncode, TIMES.sub(b'"seconds":0', done.stdout), done.stderr.decode("utf-8", "replace"),
                   content(self.folder / self.scene.output))

    # ---- What must hold ------------------------------------------------------------------------------------------

    def problem(self, run, codes):
        """What is wrong with a run that met a fault and ended by itself; None: nothing."""
        if run.code == self.good.code and run.output == self.good.output:
            return "left %s" % left_behind(self.folder) if left_behind(self.folder) else None  # a fault that did not matter
        if run.code not in codes:
            return "exit status %d: %s" % (run.code, run.stderr)
        if not run.stderr.strip():
            return "exit status %d, and not a word" % run.code
        if left_behind(self.folder) and self.scene.command[0] != "map":  # whose next run sweeps
            return "left %s" % left_behind(self.folder)
        return self.torn(run)

    def torn(self, run):
        """Whether an output is neither the old one nor a new one."""
        if isinstance(run.output, dict):
            wrong = [name for name, data in run.output.items() if data != self.good.output.get(name)]
            return "torn: %s" % wrong if wrong else None
        before = OLD if self.scene.old else None
        if run.output in (before, self.good.output) or self.tells_error(run):
            return None
        return "torn: %r" % run.output[:200]

    def tells_error(self, run):
        """Lines for each file, of which one says what went wrong; whole lines."""
        if "--json" not in self.scene.command or not run.output.endswith(b"\n"):
            return False
        return all(json.loads(line) for line in run.output.splitlines())

    def again(self):
        """The same command, now that nothing is wrong any more."""
        run = self.play()
        if run.code != self.good.code or run.output != self.good.output:
            return "then not as without the fault: %d %s" % (run.code, run.stderr)
        return "then left %s" % left_behind(self.folder) if left_behind(self.folder) else None
