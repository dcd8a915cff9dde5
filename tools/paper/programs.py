"""The programs that the paper's experiments run, and their caches. SPDX-License-Identifier: MIT"""
import csv
import hashlib
import json
import pathlib
import re
import subprocess
import sys

ENDINGS = (".csv", ".tsv", ".binary")
PROTOCOL_HEADER = "theta_i,phi_i,theta_o,phi_o,"

# The local solvers' settings: (label, solver, chart, coefficients, roughness). "plain" is the plainest reading of the
# paper, "best, log-uniform" the best we know for each solver (README.md).
PEERS = [
    ("levmar, plain", "levmar", "plain", "random", "uniform"),
    ("levmar, best, uniform", "levmar", "squares", "nnls", "uniform"),
    ("levmar, best, log-uniform", "levmar", "squares", "nnls", "log"),
    ("Ceres, plain", "ceres", "plain", "random", "uniform"),
    ("Ceres, best, uniform", "ceres", "log", "nnls", "uniform"),
    ("Ceres, best, log-uniform", "ceres", "log", "nnls", "log"),
]


class Failure(Exception):
    """A program failed, or the data cannot be used; the message is for people."""


def say(message):
    print(message, file=sys.stderr, flush=True)


def run(command, accepted=(0,)):
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True, check=False)
    if done.returncode not in accepted:
        raise Failure(f"{pathlib.Path(command[0]).name} failed ({done.returncode}): {done.stderr.strip()[-2000:]}")
    return done.stdout


def material_name(path):
    """As build/peers names it."""
    name = re.sub(r"\.gz$", "", path.name)
    for ending in ENDINGS:
        if name.endswith(ending) and len(name) > len(ending):
            name = name[: -len(ending)]
    return re.sub(r'[,"\r\n]', "_", name)


def find_files(folder):
    folder = pathlib.Path(folder)
    if not folder.is_dir():
        raise Failure(f"{folder} is not a directory")
    found = sorted(f for f in folder.iterdir() if re.sub(r"\.gz$", "", f.name).endswith(ENDINGS))
    if not found:
        raise Failure(f"{folder} holds no .binary, .binary.gz or .csv file")
    names = [material_name(f) for f in found]
    twice = sorted({n for n in names if names.count(n) > 1})
    if twice:
        raise Failure(f"{folder} holds more than one file for {', '.join(twice)}")
    return found


class Programs:
    def __init__(self, build, out):
        self.build, self.out = pathlib.Path(build), pathlib.Path(out)
        self.out.mkdir(parents=True, exist_ok=True)

    def brdffit(self, *arguments, accepted=(0, 4)):
        return run([self.build / "brdffit", *arguments], accepted)

    # ---- Samples: every program reads plain CSV, so that all see the same bits --------------------------------------

    def prepare(self, folder):
        """material -> CSV file of its samples. MERL tables are looked up at the paper's 84 directions, once."""
        return {material_name(path): self.samples(path) for path in find_files(folder)}

    def samples(self, path):
        if path.suffix == ".csv":
            with open(path, encoding="utf-8") as file:
                if file.readline().startswith(PROTOCOL_HEADER):
                    return path
        to = self.out / "samples" / (material_name(path) + ".csv")
        if to.exists() and to.stat().st_mtime > path.stat().st_mtime:
            return to
        to.parent.mkdir(exist_ok=True)
        fit = to.with_suffix(".json")
        merl = ["--merl-samples", "84"] if ".binary" in path.name else []
        self.brdffit("fit", "--json", "--quiet", *merl, "--output", fit, path)
        rows = self.evaluate(fit, path, 1)
        if "theta_i" not in rows[0]:
            raise Failure(f"{path}: the experiments need directions as {PROTOCOL_HEADER[:-1]} in degrees")
        with open(to.with_suffix(".part"), "w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file)
            measured = [c for c in rows[0] if c.endswith("_measured")]
            writer.writerow(PROTOCOL_HEADER.split(",")[:4] + [c[: -len("_measured")] for c in measured])
            for row in rows:
                writer.writerow([row[c] for c in PROTOCOL_HEADER.split(",")[:4]] + [row[c] for c in measured])
        to.with_suffix(".part").rename(to)
        return to

    def evaluate(self, fit, path, line):
        text = self.brdffit("eval", "--quiet", "--select", line, fit, path)
        return list(csv.DictReader(text.splitlines()))

    # ---- Fits ------------------------------------------------------------------------------------------------------

    def fit(self, samples, lobes, distribution, gap):
        """material -> JSON fit; None when this build does not know the distribution."""
        to = self.out / f"fits_{distribution}_{lobes}.jsonl"
        if distribution != "beckmann" and distribution not in self.brdffit("fit", "--help"):
            return None
        self.brdffit("fit", "--json", "--quiet", "--lobes", lobes, "--distribution", distribution, "--gap", gap,
                     "--output", to, *samples.values())
        fits = [json.loads(line) for line in to.read_text(encoding="utf-8").splitlines()]
        for fit in fits:
            if "error" in fit or "e2" not in fit:
                raise Failure(f"{fit.get('file')}: {fit.get('error')}")
        return dict(zip(samples, fits))

    def brute(self, samples, lobes, step_log2):
        """material -> JSON answer of the exhaustive search, from the cache where the file is the same."""
        program = self.build / "tests" / "ref" / "brute"
        return self.cached("brute.jsonl", f"{lobes} {step_log2}", f"brute force, {lobes} lobes", samples,
                           [program, "--json", "--lobes", lobes, "--step-log2", step_log2])

    def boxes(self, samples, engine, lobes, *more):
        """material -> JSON line of bench_boxes; engine moment takes no time and is run afresh."""
        command = [self.build / "bench_boxes", "--engine", engine, "--lobes", lobes, *more]
        if engine == "moment" and "--norm" not in more:
            lines = run([*command, *samples.values()]).splitlines()
            return dict(zip(samples, map(json.loads, lines)))
        return self.cached("boxes.jsonl", " ".join(map(str, command[1:])), " ".join(map(str, command[1:5] + list(more))),
                           samples, command)

    def cached(self, name, settings, title, samples, command):
        """material -> JSON answer of a command about its file, from the cache where file and settings are the same."""
        cache = self.out / name
        known = {}
        if cache.exists():
            for line in cache.read_text(encoding="utf-8").splitlines():
                try:
                    entry = json.loads(line)
                    known[entry["key"]] = entry["answer"]
                except (ValueError, KeyError):
                    continue  # cut short by an interruption
        answers = {}
        for done, (material, path) in enumerate(samples.items()):
            key = f"{hashlib.sha256(path.read_bytes()).hexdigest()} {settings}"
            if key not in known:
                say(f"{title}: {done + 1} of {len(samples)}")
                known[key] = json.loads(run([*command, path]))
                with open(cache, "a", encoding="utf-8") as file:
                    file.write("\n" + json.dumps({"key": key, "answer": known[key]}) + "\n")
            answers[material] = known[key]
        return answers

    # ---- Local solvers ---------------------------------------------------------------------------------------------

    def peer_versions(self):
        text = run([self.build / "peers", "--list"])
        return dict(line.split(",", 1) for line in text.splitlines())

    def peers(self, samples, starts, settings, seed):
        """Run what the cache lacks; progress goes to standard error as it comes."""
        _, solver, chart, coefficients, sigma = settings
        for lobes in (1, 2):
            command = [self.build / "peers", "--peer", solver, "--chart", chart, "--coefficients", coefficients,
                       "--sigma", sigma, "--lobes", lobes, "--starts", starts, "--seed", seed,
                       "--cache", self.out / "peers.csv", *samples.values()]
            if subprocess.run([str(part) for part in command], check=False).returncode != 0:
                raise Failure("peers failed")

    def peer_rows(self, samples, settings, seed):
        """The cache's whole rows of one setting about these very data."""
        digests = self.digests(samples)
        _, *wanted = settings
        rows = []
        with open(self.out / "peers.csv", newline="", encoding="utf-8") as file:
            for row in csv.DictReader(file):
                if row.get("end") == "." and digests.get(row["material"]) == row["data"] and \
                        [row["peer"], row["chart"], row["coefficients"], row["sigma"]] == wanted and \
                        row["seed"] == str(seed):
                    rows.append(row)
        return rows

    def digests(self, samples):
        """material -> digest as build/peers writes it (one start each, written to standard output)."""
        if getattr(self, "known_digests", None) is None:
            text = run([self.build / "peers", "--quiet", "--starts", 1, *samples.values()])
            self.known_digests = {row["material"]: row["data"] for row in csv.DictReader(text.splitlines())}
        return self.known_digests
