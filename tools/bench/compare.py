"""Two builds of the library on the same data: certified fits, boxes, instructions and time, before and after.

    compare.py BEFORE AFTER --set NAME FILE... [--set NAME FILE...] [--results RESULTS.md]

BEFORE and AFTER are folders with a `brdffit` (build/ of two commits). Boxes and times are of all files of a set, times the
median of five runs, taken in turns; instructions are those below brdffit_fit of every twentieth file (valgrind), in the least
instruction set, without which no number of two machines agrees. SPDX-License-Identifier: MIT
"""
import argparse
import json
import pathlib
import re
import statistics
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
import results

BEGIN = "<!-- make compare: begin (written by tools/bench/compare.py; edit there) -->"
END = "<!-- make compare: end -->"
# Label, options of the build after, and of the build before; None where that has no such fit.
MODELS = [
    ("1 Beckmann", ["--lobes", "1"], ["--lobes", "1"]),
    ("2 Beckmann", ["--lobes", "2"], ["--lobes", "2"]),
    ("1 GGX", ["--lobes", "1", "--distribution", "ggx"], ["--lobes", "1", "--distribution", "ggx"]),
    ("2 GGX", ["--lobes", "2", "--distribution", "ggx"], ["--lobes", "2", "--distribution", "ggx"]),
    ("3 Beckmann, gap 1e-2", ["--lobes", "3", "--gap", "1e-2"], None),
    ("Beckmann + GGX, gap 1e-2", ["--lobes", "beckmann,ggx", "--gap", "1e-2"], None),
]
RUNS = 5


def fits(build, options, files):
    """Certified, boxes, seconds in fits of one run over the files."""
    command = [str(build / "brdffit"), "fit", "--json", *options, *map(str, files)]
    out = subprocess.run(command, capture_output=True, text=True, check=False).stdout
    lines = [json.loads(line) for line in out.splitlines()]
    return (sum(line["status"] == "certified" for line in lines), sum(line["boxes"] for line in lines),
            sum(line["seconds"]["reduce"] + line["seconds"]["search"] for line in lines))


def instructions(build, options, files):
    """Below brdffit_fit, or None without valgrind."""
    with tempfile.TemporaryDirectory() as folder:
        command = ["valgrind", "--tool=callgrind", f"--callgrind-out-file={folder}/out", "--toggle-collect=brdffit_fit",
                   str(build / "brdffit"), "fit", "--json", *options, *map(str, files)]
        try:
            text = subprocess.run(command, capture_output=True, text=True, check=False).stderr
        except OSError:
            return None
    found = re.search(r"Collected : (\d+)", text)
    return int(found.group(1)) if found else None


def arrow(before, after, form):
    old = "–" if before is None else form(before)
    return f"{old} → {'–' if after is None else form(after)}"


def row(name, files, model, before, after):
    label, new, old = model
    runs = {True: [], False: []}
    for _ in range(RUNS):
        runs[False].append(fits(before, old, files) if old else None)
        runs[True].append(fits(after, new, files))
    few = files[::20]
    first, last = runs[False][0], runs[True][0]
    seconds = [statistics.median(run[2] for run in runs[key]) if runs[key][0] else None for key in (False, True)]
    count = [instructions(before, old, few) if old else None, instructions(after, new, few)]
    cells = [name, label, arrow(first and first[0], last[0], lambda n: f"{n}/{len(files)}"),
             arrow(first and first[1], last[1], lambda n: f"{n:,}"),
             arrow(*count, lambda n: f"{n / len(few) / 1e6:.3f} M"), arrow(*seconds, lambda s: f"{s * 1e3:.4g} ms")]
    return "| " + " | ".join(cells) + " |"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("before", type=pathlib.Path)
    parser.add_argument("after", type=pathlib.Path)
    parser.add_argument("--set", nargs="+", action="append", required=True, metavar=("NAME", "FILE"))
    parser.add_argument("--results", type=pathlib.Path)
    arguments = parser.parse_args()
    lines = [BEGIN, "## Before and after: one core for lists of lobes", "",
             f"`tools/bench/compare.py BEFORE AFTER` on {results.machine()}; before: the last commit with one and two lobes "
             "hard-coded. Gap 1e-3 where no other is named; instructions a fit, of every twentieth file.", "",
             "| data | model | certified | boxes | instructions | time of all fits |", "|---|---|---|---|---|---|"]
    for name, *files in arguments.set:
        for model in MODELS:
            lines.append(row(name, [pathlib.Path(f) for f in files], model, arguments.before, arguments.after))
            print(lines[-1], flush=True)
    text = "\n".join([*lines, END, ""])
    if arguments.results:
        results.put(arguments.results, text, BEGIN, END)


if __name__ == "__main__":
    main()
