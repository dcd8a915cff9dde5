"""The programs that `make bench` runs, and the cache of the peers' rows. SPDX-License-Identifier: MIT"""
import csv
import hashlib
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
OURS = "moment,socp,levmar,levmar-box"  # measured again in every run, one after the other on each file
COLUMNS = ["method", "knob", "set", "file", "data", "lobes", "seconds", "search", "e2", "lower_bound", "certified", "work",
           "nodes", "sum_of_squares"]


class Failure(Exception):
    """A program failed, or the data cannot be used; the message is for people."""


def say(message):
    print(message, file=sys.stderr, flush=True)


def run(command, accepted=(0,)):
    """Standard output of a program."""
    command = [str(part) for part in command]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode not in accepted:
        raise Failure(f"{pathlib.Path(command[0]).name} failed ({done.returncode}): {done.stderr.strip()[-2000:]}")
    return done.stdout


def table(text):
    return list(csv.DictReader(text.splitlines()))


def csv_files(folder):
    folder = pathlib.Path(folder)
    if not folder.is_dir():
        raise Failure(f"{folder} is not a directory")
    found = sorted(folder.glob("*.csv"))
    if not found:
        raise Failure(f"{folder} holds no .csv file")
    return found


def digest_of(paths, more=()):
    digest = hashlib.sha256()
    for path in paths:
        digest.update(pathlib.Path(path).read_bytes())
    digest.update("\0".join(more).encode())
    return digest.hexdigest()[:16]


class Programs:
    def __init__(self, build, out):
        self.build, self.out = pathlib.Path(build), pathlib.Path(out)
        self.out.mkdir(parents=True, exist_ok=True)
        self.listing = run([self.build / "curves", "--list"])

    def methods(self):
        lines = [line.split(",") for line in self.listing.splitlines()]
        return [line[1] for line in lines if line[0] == "method" and len(line) == 2]

    def versions(self):
        return dict(line.split(",")[1:3] for line in self.listing.splitlines() if line.startswith("version"))

    # ---- Data --------------------------------------------------------------------------------------------------------

    def sets(self, folders, quick):
        """[(name, files)]: the folders given, the generated families, and the three hard problems of the tests."""
        families = self.out / "families"
        run([self.build / "families", families, "--members", 20])
        hard = HERE.parent.parent / "tests" / "data" / "hard"
        chosen = [(pathlib.Path(folder).resolve().name, csv_files(folder)) for folder in folders]
        chosen += [(name, csv_files(families / name)) for name in ("narrow", "near", "single")] + [("hard", csv_files(hard))]
        names = [name for name, _ in chosen]
        if len(set(names)) < len(names):
            raise Failure(f"two data sets have one name: {', '.join(names)}")
        return [(name, files[:: max(1, len(files) // 2)][:2] if quick else files) for name, files in chosen]

    # ---- Rows of curves ------------------------------------------------------------------------------------------------

    def curves(self, name, path, methods, options=()):
        return table(run([self.build / "curves", "--set", name, "--methods", methods, *options, path]))


class Cache:
    """Rows of the peers, by their settings, the sources they come from, and the file's bytes."""

    def __init__(self, path, key):
        self.path, self.key, self.known = pathlib.Path(path), key, {}
        self.read()

    def read(self):
        self.known = {}
        if self.path.exists():
            with open(self.path, newline="", encoding="utf-8") as file:
                for row in csv.DictReader(file):
                    if row.get("end") == "." and row["key"] == self.key:
                        self.known.setdefault(row["bytes"], []).append({c: row[c] for c in COLUMNS})

    def get(self, path, make, fresh=False):
        """The rows of a file; made, and kept whole or not at all, when they are not known. Names are the caller's."""
        digest = digest_of([path])
        if digest not in self.known:
            self.read()  # another run may be filling it
        if fresh or digest not in self.known:
            rows = make()
            new = not self.path.exists()
            with open(self.path, "a", newline="", encoding="utf-8") as file:
                writer = csv.DictWriter(file, ["key", "bytes", *COLUMNS, "end"], lineterminator="\n")
                if new:
                    writer.writeheader()
                writer.writerows({**row, "key": self.key, "bytes": digest, "end": "."} for row in rows)
            self.known[digest] = rows
        return self.known[digest]


def source_key(programs, settings):
    """Changes whenever a peer's program, its version or its settings do."""
    sources = sorted(p for p in HERE.iterdir() if re.match(r"(curves|peers)_.*\.(c|h|cc)$|scipy_peers\.py$", p.name)
                     and p.name not in ("curves_engine.c", "curves_main.c"))
    versions = [f"{name} {version}" for name, version in sorted(programs.versions().items())]
    return digest_of(sources, [*versions, *map(str, settings)])


# ---- Instructions, counted by callgrind ---------------------------------------------------------------------------------


NODE = "brdffit_moments_node"  # inclusive: all that one roughness costs
BOX = {1: "brdffit_bound_moment_one", 2: "brdffit_bound_moment_two"}  # inclusive, nodes too


def count_instructions(programs, lobes, files):
    """Instructions per node, per box without its nodes, and per fit; None where valgrind is not installed."""
    if not shutil.which("valgrind") or not shutil.which("callgrind_annotate"):
        return None
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "callgrind.out"
        text = run(["valgrind", "--quiet", "--tool=callgrind", f"--callgrind-out-file={out}", programs.build / "bench_fit",
                    "--quiet", "--repeat", 1, "--lobes", lobes, "--brute-step", "0,0", *files])
        counts = parse_annotation(run(["callgrind_annotate", "--inclusive=yes", "--threshold=100", out]))
    return instructions_of(text, counts, lobes, len(files))


def instructions_of(text, counts, lobes, files):
    """From what bench_fit said and callgrind counted; None when a function has another name or was inlined."""
    boxes, nodes = (int(n) for n in re.search(r"(\d+) boxes, (\d+) nodes", text).groups())
    if NODE not in counts or BOX[lobes] not in counts:
        return None
    inside = min(counts[NODE], counts[BOX[lobes]])
    return {"node": counts[NODE] / nodes, "box": (counts[BOX[lobes]] - inside) / boxes,
            "fit": counts.get("brdffit_fit", 0) / files, "boxes": boxes / files, "nodes": nodes / files}


def parse_annotation(text):
    """{function: largest count} of lines like `12,345 (67.8%)  file.c:function [object]`, recursion marks dropped."""
    found = {}
    for line in text.splitlines():
        match = re.match(r"\s*([\d,]+)\s+(?:\([^)]*\)\s+)?(\S.*)$", line)
        if match:
            name = re.sub(r"\s*\[[^\]]*\]$", "", match[2]).strip().rsplit(":", 1)[-1].split("'")[0]
            found[name] = max(found.get(name, 0), int(match[1].replace(",", "")))
    return found
