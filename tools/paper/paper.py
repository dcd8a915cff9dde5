#!/usr/bin/env python3
"""Reproduce the experiments of Yu, Seo and Lee: `make paper DATA=dir` calls this.

Writes under --out, for each of Figures 2-10, figureNN.csv, .svg and .png, and results.md, the table of the paper's
claims beside ours; --results puts that section into another Markdown file too. What takes long (brute force, local
solvers) is kept in --out and is not run again. SPDX-License-Identifier: MIT
"""
import argparse
import csv
import pathlib
import shlex
import sys

sys.path.insert(1, str(pathlib.Path(__file__).resolve().parents[1]))  # for results.py and figure_style.py

import arithmetic as a
import report
import results
from programs import PEERS, Failure, Programs, say

GAP = 1e-6
LINF_GAP = 1e-3
STEP_LOG2 = 11


class Experiments:
    """Everything that figures and tables are made of."""

    def __init__(self, options):
        self.programs = Programs(options.build, options.out)
        self.out = self.programs.out
        self.gap, self.seed, self.every = GAP, options.seed, options.every
        self.boxes_every = options.boxes_every
        self.note, self.command, self.cached = options.note, options.command, options.cached
        self.samples = self.programs.prepare(options.data)
        say(f"{len(self.samples)} materials")
        self.fits = self.all_fits()
        self.brute = self.all_brute(options)
        self.boxes = self.all_boxes(options)
        self.linf = {lobes: self.programs.boxes(self.samples, "moment", lobes, "--norm", "linf", "--gap", LINF_GAP)
                     for lobes in (1, 2)}
        self.machine = results.machine()
        self.versions = self.programs.peer_versions()
        self.scopes = {"all": (sorted(self.samples), options.starts)}
        if options.deep_starts > options.starts:
            self.scopes["subset"] = (sorted(self.samples)[:: options.every], options.deep_starts)
        self.peers = self.all_peers(options)
        if options.cached and "subset" in self.scopes:
            self.narrow(options.deep_starts)
        self.starts_run = self.judge_peers()

    def all_fits(self):
        fits = {}
        for distribution in ("beckmann", "torrance-sparrow"):
            for lobes in (1, 2):
                found = self.programs.fit(self.samples, lobes, distribution, self.gap)
                if found is None:
                    say(f"this build has no distribution {distribution}: left out")
                    break
                fits[distribution, lobes] = found
        return fits

    def all_brute(self, options):
        if options.no_brute:
            return {}
        names = sorted(self.samples)
        some = {m: self.samples[m] for m in names[:: options.brute_every]}
        scope = f"1 material in {options.brute_every}, by name" if options.brute_every > 1 else "all"
        return {1: (self.programs.brute(self.samples, 1, STEP_LOG2), "all"),
                2: (self.programs.brute(some, 2, STEP_LOG2), scope)}

    def all_peers(self, options):
        peers = {}
        for settings in PEERS:
            if settings[1] not in self.versions:
                continue
            say(f"{settings[0]}:")
            for materials, starts in self.scopes.values() if not options.cached else ():
                self.programs.peers({m: self.samples[m] for m in materials}, starts, settings, self.seed)
            peers[settings[0]] = a.Peer(self.programs.peer_rows(self.samples, settings, self.seed))
        return peers

    def narrow(self, starts):
        """With --cached, the deep scope is what an interrupted run got done with its first setting."""
        first = next(iter(self.peers.values()))
        done = [m for m in self.scopes["subset"][0] if first.complete(m, 2, starts)]
        self.scopes["subset"] = (done, starts)
        if not done:
            del self.scopes["subset"]

    def all_boxes(self, options):
        """(engine, lobes) -> material -> boxes a level; engine socp with two lobes to the paper's resolution only."""
        names = sorted(self.samples)
        some = {m: self.samples[m] for m in names[:: options.boxes_every]}
        found = {}
        for engine in ("moment", "socp"):
            found[engine, 1] = self.programs.boxes(self.samples, engine, 1, "--gap", self.gap)
            found[engine, 2] = self.programs.boxes(some, engine, 2, "--gap", self.gap, *(
                ["--resolution", 2.0 ** (1 - STEP_LOG2), "--budget", 1000000] if engine == "socp" else []))
        return found

    def judge_peers(self):
        wrong = a.below_bound(self.peers.values(), {p: self.fits["beckmann", p] for p in (1, 2)})
        if wrong:
            raise Failure(f"a local solver is below the proven lower bound, so the proof is wrong: {wrong[0]}")
        return sum(int(row["last"]) - int(row["first"]) for peer in self.peers.values()
                   for rows in peer.blocks.values() for row in rows)

    # ---- Rows of the figures -----------------------------------------------------------------------------------------

    def error_rows(self):
        distributions = [d for d, lobes in self.fits if lobes == 1]
        rows = [{"material": m} | {f"rms_{d}": self.fits[d, 1][m]["rms_total"] for d in distributions} |
                {"sigma": self.fits["beckmann", 1][m]["sigma"][0]} for m in self.samples]
        return sorted(rows, key=lambda row: row["rms_beckmann"]), distributions

    def reprojection_rows(self, material):
        """The 84 samples: normalised radiance measured, and of both fits."""
        path = self.samples[material]
        line = list(self.samples).index(material) + 1
        tables = [self.programs.evaluate(self.out / f"fits_beckmann_{lobes}.jsonl", path, line) for lobes in (1, 2)]
        fit = self.fits["beckmann", 1][material]
        rows = []
        for one, two in zip(*tables):
            row = {c: float(one[c]) for c in ("theta_i", "phi_i", "theta_o", "phi_o")}
            factor = a.math.cos(a.math.radians(row["theta_i"])) if fit["quantity"] == "brdf" else 1.0
            for channel, scale in zip(fit["channels"], fit["channel_scale"]):
                row[f"{channel}_measured"] = float(one[f"{channel}_measured"]) * factor / scale
                row[f"{channel}_one"] = float(one[f"{channel}_fit"]) * factor / scale
                row[f"{channel}_two"] = float(two[f"{channel}_fit"]) * factor / scale
            rows.append(row)
        return rows, fit["channels"]

    def improvement_rows(self):
        one, two = self.fits["beckmann", 1], self.fits["beckmann", 2]
        rows = [{"material": m, "rms_1": one[m]["rms_total"], "rms_2": two[m]["rms_total"],
                 "d12": a.d12(one[m], two[m])} for m in self.samples]
        return sorted(rows, key=lambda row: row["d12"])

    def rate_rows(self):
        rows = []
        for label, peer in self.peers.items():
            for scope, (materials, most) in self.scopes.items():
                for lobes in (1, 2):
                    certified = self.fits["beckmann", lobes]
                    for starts in peer.milestones(materials, lobes, most):
                        rows.append({"setting": label, "scope": scope, "lobes": lobes, "starts": starts,
                                     "materials": len(materials),
                                     "reached": a.count_at_optimum(peer, certified, materials, lobes, starts),
                                     "near": a.count_at_optimum(peer, certified, materials, lobes, starts, a.NEAR)})
        return rows

    def excess_rows(self):
        rows = []
        for label, peer in self.peers.items():
            for scope, (materials, starts) in self.scopes.items():
                if not all(peer.complete(m, 2, starts) for m in materials):
                    continue
                found = []
                for m in materials:
                    fit = self.fits["beckmann", 2][m]
                    found.append((a.excess(peer.best(m, 2, starts), fit["e2"], fit["sum_of_squares"]), m))
                rows += [{"setting": label, "scope": scope, "starts": starts, "rank": rank, "material": m, "excess": value}
                         for rank, (value, m) in enumerate(sorted(found), 1)]
        return rows


    def level_rows(self):
        return [{"engine": engine, "lobes": lobes, "materials": len(answers), "level": level,
                 "boxes": sum(b["levels"][level] for b in answers.values() if level < len(b["levels"]))}
                for (engine, lobes), answers in self.boxes.items()
                for level in range(max(len(b["levels"]) for b in answers.values()))]


def write_csv(path, rows):
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, list(rows[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def draw(e):
    import figures

    counts = {scope: len(materials) for scope, (materials, _) in e.scopes.items()}
    rows, distributions = e.error_rows()
    write_csv(e.out / "figure02.csv", rows)
    figures.errors(e.out, rows, distributions)
    chosen = a.choose_plots(e.fits["beckmann", 1], e.fits["beckmann", 2])
    for number, (material, why) in enumerate(chosen, 3):
        rows, channels = e.reprojection_rows(material)
        write_csv(e.out / f"figure{number:02}.csv", rows)
        figures.reprojection(e.out, f"figure{number:02}", material, rows, channels, why)
    rows = e.improvement_rows()
    write_csv(e.out / "figure08.csv", rows)
    figures.improvements(e.out, rows, a.BETTER)
    rows = e.rate_rows()
    write_csv(e.out / "figure09.csv", rows)
    figures.rates(e.out, rows, list(e.peers), counts)
    rows = e.excess_rows()
    write_csv(e.out / "figure10.csv", rows)
    figures.excesses(e.out, rows, list(e.peers), counts)
    rows = e.level_rows()
    write_csv(e.out / "boxes.csv", rows)
    figures.levels(e.out, rows)


def read_options(arguments):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("data", help="directory of MERL .binary[.gz] files or 84-sample CSV files")
    parser.add_argument("--build", default="build")
    parser.add_argument("--out", default="build/paper")
    parser.add_argument("--starts", type=int, default=100, help="random starts for every material (default 100)")
    parser.add_argument("--deep-starts", type=int, default=0, help="starts for every Mth material (the paper: 5000)")
    parser.add_argument("--every", type=int, default=10, help="M (default 10)")
    parser.add_argument("--brute-every", type=int, default=10,
                        help="two-lobe brute force for every Mth material only (default 10)")
    parser.add_argument("--boxes-every", type=int, default=10,
                        help="two-lobe boxes a level for every Mth material only (default 10)")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--no-brute", action="store_true", help="leave the brute force out")
    parser.add_argument("--cached", action="store_true",
                        help="run no local solver: tell what the cache holds of an interrupted run")
    parser.add_argument("--results", help="Markdown file to put the table into as well")
    parser.add_argument("--note", help="what the data are, for the table")
    options = parser.parse_args(arguments)
    if min(options.starts, options.every, options.brute_every, options.boxes_every) < 1:
        parser.error("--starts, --every, --brute-every and --boxes-every begin at 1")
    folder = pathlib.Path(options.data).resolve().name
    options.note = options.note or f"the files of `{folder}`; this program cannot tell genuine MERL tables from others."
    extra = [f"--deep-starts {options.deep_starts}"] if options.deep_starts else []
    extra += [f"--every {options.every}"] if options.every != 10 else []
    extra += [f"--brute-every {options.brute_every}"] if options.brute_every != 10 else []
    extra += [f"--boxes-every {options.boxes_every}"] if options.boxes_every != 10 else []
    extra += [f"--seed {options.seed}"] if options.seed != 1 else []
    extra += ["--cached"] if options.cached else []
    extra += ["--no-brute"] if options.no_brute else []
    options.command = f"make paper DATA={shlex.quote(folder)} STARTS={options.starts}" + \
        (f" PAPER_OPTIONS='{' '.join(extra)}'" if extra else "")
    return options


def main(arguments):
    options = read_options(arguments)
    try:
        e = Experiments(options)
        draw(e)
        text = report.write(e)
        (e.out / "results.md").write_text(text, encoding="utf-8")
        if options.results:
            results.put(options.results, text, report.BEGIN, report.END)
    except (Failure, OSError) as failure:
        say(f"paper: {failure}")
        return 1
    print(text)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
