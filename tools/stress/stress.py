#!/usr/bin/env python3
"""Strain the library and judge it by 50-digit references: `make stress` calls this.

Writes build/stress/stress.csv (one row a fit) and results.md (one row a family); --results puts the table into another
Markdown file too. Exit status 1: something that brdffit.h promises does not hold; the failing inputs stay in
build/stress/failed. SPDX-License-Identifier: MIT
"""
import argparse
import collections
import csv
import json
import multiprocessing
import pathlib
import shutil
import subprocess
import sys

sys.path.insert(1, str(pathlib.Path(__file__).resolve().parents[1]))  # for results.py

import results
import table
from cases import DISTRIBUTIONS, FAMILIES, make
from judge import judge


def run(program, cases, folder):
    """What the library says of every case, by name; one process a setting."""
    groups, answers = collections.defaultdict(list), {}
    for case in cases:
        case.write(folder / f"{case.name}.csv")
        groups[case.lobes, case.distribution, case.normalise].append(case)
    for (lobes, distribution, normalise), members in groups.items():
        files = [str(folder / f"{case.name}.csv") for case in members]
        done = subprocess.run([program, str(lobes), distribution, normalise, *files], capture_output=True, text=True,
                              check=False)
        lines = done.stdout.splitlines()
        if done.returncode or len(lines) != len(files):
            raise SystemExit(f"{program} failed ({done.returncode}): {done.stderr[-500:]}")
        answers.update((case.name, json.loads(line)) for case, line in zip(members, lines))
    return answers


def stress(program, cases, folder, processes=1):
    """A row for each case."""
    folder.mkdir(parents=True, exist_ok=True)
    answers = run(program, cases, folder)
    work = [(case, answers[case.name], answers.get(case.twin)) for case in cases]
    if processes == 1:
        return [judge(*one) for one in work]
    with multiprocessing.Pool(processes) as pool:
        return pool.starmap(judge, work, chunksize=4)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--build", type=pathlib.Path, default=pathlib.Path("build"))
    parser.add_argument("--members", type=int, default=12)
    parser.add_argument("--family", action="append", choices=list(FAMILIES))
    parser.add_argument("--distribution", action="append", choices=DISTRIBUTIONS)
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--results", type=pathlib.Path)
    o = parser.parse_args()
    out = o.build / "stress"
    shutil.rmtree(out, ignore_errors=True)
    cases = make(o.family or FAMILIES, o.members, distributions=tuple(o.distribution or DISTRIBUTIONS))
    rows = stress(o.build.resolve() / "stress_fit", cases, out / "cases", o.processes)
    with open(out / "stress.csv", "w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, list(rows[0]))
        writer.writeheader()
        writer.writerows(rows)
    text = table.section(rows, o.members)
    (out / "results.md").write_text(text, encoding="utf-8")
    print(text)
    if o.results:
        results.put(o.results, text, table.BEGIN, table.END)
    failed = [row for row in rows if row["failure"]]
    for row in failed:
        (out / "failed").mkdir(exist_ok=True)
        shutil.copy(out / "cases" / f"{row['name']}.csv", out / "failed")
        print(f"FAILED {row['name']}: {row['failure']}", file=sys.stderr)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
