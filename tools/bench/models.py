"""Every model that a fit may have: certified fits, RMS error, boxes and time, in one run for each set of files.

    models.py BUILD --set NAME FILE... [--set NAME FILE...] [--repeat N] [--results RESULTS.md]

BUILD has `bench_models` (make bench-programs). SPDX-License-Identifier: MIT
"""
import argparse
import pathlib
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
import results

BEGIN = "<!-- bench_models: begin (written by tools/bench/models.py; edit there) -->"
END = "<!-- bench_models: end -->"
HEAD = """## Every model

`tools/bench/models.py BUILD --set NAME FILE...` on %s. Every direction above the horizon, gap 1e-3 where no other is named. RMS:
geometric mean over the files of the root of E², relative to one Beckmann lobe; time: median over the files of the median of
%d whole fits; boxes and time also beside the same lobes without Fresnel, Smith's masking and further diffuse terms.
"""


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("--set", nargs="+", action="append", required=True, metavar=("NAME", "FILE"))
    parser.add_argument("--repeat", type=int, default=3)
    parser.add_argument("--results", type=pathlib.Path)
    arguments = parser.parse_args()
    lines = [BEGIN, HEAD % (results.machine(), arguments.repeat)]
    for name, *files in arguments.set:
        command = [str(arguments.build / "bench_models"), "--repeat", str(arguments.repeat), *files]
        table = subprocess.run(command, capture_output=True, text=True, check=True).stdout
        lines += [f"### {name}, {len(files)} files", "", table]
        print("\n".join(lines[-3:]), flush=True)
    if arguments.results:
        results.put(arguments.results, "\n".join([*lines, END, ""]), BEGIN, END)


if __name__ == "__main__":
    main()
