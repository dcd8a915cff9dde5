#!/usr/bin/env python3
"""Run time against error of brdffit and its peers, costs, and the targets: `make bench` calls this.

Writes under --out: fresh.csv and peers.csv (every row measured), curves.csv (the figure's points), scaling.csv, the figures
bench.svg, bench_sets.svg, bench_costs.svg (and .png), and results.md; --results puts that section into another Markdown
file too. SPDX-License-Identifier: MIT
"""
import argparse
import concurrent.futures
import csv
import os
import pathlib
import shlex
import sys
import threading
import time

sys.path.insert(1, str(pathlib.Path(__file__).resolve().parents[1]))  # for results.py and figure_style.py

import bench_arithmetic as a
import bench_programs as p
import bench_text
import results
from bench_programs import Failure, say

# Of the peers, whose rows are cached, and of what every run measures again (engines, a few levmar starts).
FULL = {"starts": 50, "evaluations": 10000, "grid": "11,8", "patience": 1.0, "repeat": 9}
QUICK = {"starts": 10, "evaluations": 500, "grid": "11,6", "patience": 0.3, "repeat": 3}
OURS = {"starts": 5, "width": "11,4", "patience": 0.5, "repeat": 5}


def options_of(settings):
    return [part for name, value in settings.items() for part in (f"--{name}", str(value))]


class Bench:
    """Everything that the report is made of."""

    def __init__(self, options):
        self.options, self.programs = options, p.Programs(options.build, options.out)
        self.out, self.begun = self.programs.out, time.time()
        self.settings = QUICK if options.quick else FULL
        self.sets = self.programs.sets(options.data, options.quick)
        self.versions = self.programs.versions()
        self.fresh, self.peers = [], []
        self.load = os.getloadavg()

    # ---- Curves ------------------------------------------------------------------------------------------------------

    def measure(self):
        methods = ",".join(m for m in self.programs.methods() if m not in ("moment", "socp"))
        cache = p.Cache(self.out / "cache.csv", p.source_key(self.programs, [methods, *self.settings.values()]))
        ours = options_of(OURS)
        work = [(name, path) for name, files in self.sets for path in files]
        self.shown = self.done = 0
        lock = threading.Lock()

        def one(job):
            name, path = job
            fresh = [] if self.options.peers_only else self.programs.curves(name, path, p.OURS, ours)
            with lock:
                known = cache.get(path, lambda: self.peer_rows(name, path, methods), self.options.fresh)
            self.tell(len(work))
            return fresh, [row | {"set": name, "file": path.stem} for row in known]

        with concurrent.futures.ThreadPoolExecutor(self.options.workers) as pool:
            for fresh, known in pool.map(one, work):
                self.fresh += fresh
                self.peers += known
        say(f"bench: {len(work)} files measured, {time.time() - self.begun:.0f} s")

    def tell(self, count):
        self.done += 1
        if time.time() > self.shown + 30.0:
            self.shown = time.time()
            say(f"bench: {self.done} of {count} files, {self.shown - self.begun:.0f} s")

    def peer_rows(self, name, path, methods):
        rows = self.programs.curves(name, path, methods, options_of(self.settings))
        if self.options.no_scipy:
            return rows
        import scipy_peers

        digest = rows[0]["data"]
        for lobes in (1, 2):
            rows += scipy_peers.rows(self.programs.build / "libcurves_reduced.so", path, (name, path.stem), lobes, digest,
                                     self.options.quick)
        return rows

    def judge(self):
        """Optima and curves; a peer below a proven bound would mean that the proof is wrong."""
        rows = self.fresh + self.peers
        self.best = a.optima(self.fresh)
        missing = {a.identity(row) for row in rows} - set(self.best)
        if missing:
            raise Failure(f"no certified optimum for {sorted(missing)[0]}")
        wrong = a.contradictions(rows, self.best)
        if wrong:
            raise Failure(f"below a proven lower bound, so the proof is wrong: {wrong[0]}")
        own = [row for row in self.fresh if row["method"] in ("moment", "socp")]
        self.curves = a.curves(own + self.peers, self.best)

    # ---- Costs -------------------------------------------------------------------------------------------------------

    def scaling(self, **setting):
        command = [self.programs.build / "scaling", *(part for k, v in setting.items() for part in (f"--{k}", v))]
        return p.table(p.run(command))[0]

    def costs(self):
        """Against N, each until a fit would take more than two minutes, and against K. One process a setting."""
        self.by_n, self.by_k = [], []
        for lobes in (1, 2):
            for power in range(2, 6 if self.options.quick else 8):
                row = self.scaling(samples=10 ** power, lobes=lobes, repeat=5 if power < 6 else 1)
                self.by_n.append(row)
                if 10.0 * float(row["seconds"]) > self.options.longest:
                    break
            for channels in (1, 2, 3, 4, 7, 10, 16, 31):
                self.by_k.append(self.scaling(channels=channels, lobes=lobes, repeat=9))
        file = self.sets[0][1][0]
        self.memory = {lobes: 1024 * int(p.run([self.programs.build / "scaling", "--peak", self.programs.build / "brdffit", "fit",
                                                "--lobes", lobes, file])) for lobes in (1, 2)}

    def against_paper(self):
        """The paper's bound to the gaps of engine moment, on one file in ten."""
        name, files = self.sets[0]
        some = files[:: max(1, len(files) // 5)][:5]
        self.paper_files = len(some)
        patience = "0.5" if self.options.quick else "2"
        self.paper = [row for path in some for row in
                      self.programs.curves(name, path, "moment,socp-gap,socp-gap-every-box", ["--patience", patience])]

    def others(self):
        """Programs of other parts of the project, where this build has them: their CSV as it is."""
        self.extra, kept = {}, self.out / "bench_table.csv"
        most = "1e5" if self.options.quick else "1e7"
        for title, name, arguments in (
                ("Whole tables", "bench_table", ["--csv", kept, "--repeat", 5, "--scaling", most, *self.options.table]),
                ("Whole maps", "bench_many", ["--csv"])):
            program = self.programs.build / name
            if not program.exists():
                continue
            try:
                text = p.run([program, *arguments])
                rows = p.table(kept.read_text(encoding="utf-8") if name == "bench_table" else text)
                # Names without their folders: the report may be published.
                self.extra[title] = [row | {"file": pathlib.Path(row["file"]).name} if row.get("file") else row for row in rows]
            except Failure as failure:
                say(f"bench: {title} is left out: {failure}")

    def evaluation_costs(self):
        if self.options.no_scipy:
            return {}
        import scipy_peers

        return scipy_peers.evaluation_costs(self.programs.build / "libcurves_reduced.so", self.sets[0][1][0])

    def kernel(self):
        """The machine's peak and the node kernel's part of it; instructions of nodes and boxes."""
        program = self.programs.build / "kernel"
        self.peak = p.table(p.run([program])) if program.exists() else []
        files = self.sets[0][1]
        some = files[:: max(1, len(files) // 3)][:3]
        self.instructions = {lobes: p.count_instructions(self.programs, lobes, some) for lobes in (1, 2)}


def write_rows(path, rows, columns=None):
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, columns or list(rows[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def write_files(bench):
    write_rows(bench.out / "fresh.csv", bench.fresh, p.COLUMNS)
    write_rows(bench.out / "peers.csv", bench.peers, p.COLUMNS)
    write_rows(bench.out / "scaling.csv", bench.by_n + bench.by_k)
    write_rows(bench.out / "curves.csv", [dict(zip(("set", "lobes", "method"), key)) | point._asdict()
                                          for key, points in bench.curves.items() for point in points])


def draw(bench):
    import bench_figure as figure

    figure.overview(bench.out, bench.curves, len(bench.best) // 2)
    figure.by_set(bench.out, bench.curves, [name for name, _ in bench.sets])
    figure.scaling(bench.out, bench_text.cost_panels(bench))


def read_options(arguments):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("data", nargs="*", help="directories of CSV files, each a data set")
    parser.add_argument("--build", default="build")
    parser.add_argument("--out", default="build/bench")
    parser.add_argument("--table", action="append", default=[], help="a whole table (MERL .binary) for bench_table; repeat it")
    parser.add_argument("--quick", action="store_true", help="three files a set, smaller knobs: minutes")
    parser.add_argument("--fresh", action="store_true", help="measure the peers again too")
    parser.add_argument("--peers-only", action="store_true", help="fill the peers' cache and stop")
    parser.add_argument("--together", action="store_true",
                        help="costs beside the curves instead of after them: sooner where other programs disturb anyway")
    parser.add_argument("--workers", type=int, default=1, help="files measured at a time (default 1: the quietest)")
    parser.add_argument("--no-scipy", action="store_true")
    parser.add_argument("--longest", type=float, default=120.0, help="seconds of the longest fit of the costs (default 120)")
    parser.add_argument("--results", help="Markdown file to put the section into as well")
    parser.add_argument("--note", default="", help="what the data are, for the report")
    options = parser.parse_args(arguments)
    folders = " ".join(pathlib.Path(folder).resolve().name for folder in options.data)
    options.command = "make bench" + (f" DATA={shlex.quote(folders)}" if folders else "") + \
        (" QUICK=1" if options.quick else "") + (" FRESH=1" if options.fresh else "") + \
        (f" BENCH_OPTIONS='--together --workers {options.workers}'" if options.together else "")
    return options


def run_steps(bench):
    """What is not curves."""
    for step in (bench.against_paper, bench.costs, bench.kernel, bench.others):
        step()
        say(f"bench: {step.__name__}, {time.time() - bench.begun:.0f} s")


def main(arguments):
    options = read_options(arguments)
    try:
        bench = Bench(options)
        beside = threading.Thread(target=run_steps, args=(bench,))
        if options.together:
            beside.start()
        bench.measure()
        if options.peers_only:
            return 0
        bench.judge()
        if options.together:
            beside.join()
        else:
            run_steps(bench)
        bench.machine, bench.evaluation = results.machine(), bench.evaluation_costs()
        write_files(bench)
        draw(bench)
        text = bench_text.section(bench)
        (bench.out / "results.md").write_text(text, encoding="utf-8")
        if options.results:
            results.put(options.results, text, bench_text.BEGIN, bench_text.END)
    except (Failure, OSError) as failure:
        say(f"bench: {failure}")
        return 1
    print(bench_text.terminal(bench))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
