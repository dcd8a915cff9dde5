"""The report of `make bench` as Markdown, and the table that it prints. SPDX-License-Identifier: MIT"""
import math
import os

import bench_arithmetic as a
from bench_labels import KNOBS, LABELS, PEERS, SETTINGS

BEGIN = "<!-- make bench: begin (written by tools/bench/report.py; edit there) -->"
END = "<!-- make bench: end -->"


def seconds(value):
    for unit, scale in (("s", 1.0), ("ms", 1e3), ("µs", 1e6), ("ns", 1e9)):
        if value * scale >= 1.0 or unit == "ns":
            return f"{value * scale:.3g} {unit}"
    return "0"


def ratio(value):
    return f"{value:,.0f}" if value >= 100 else f"{value:.3g}"


def error(value):
    return "≤ 1e-12" if value <= a.FLOOR else f"{value:.1e}".replace("e-0", "e-").replace("e+0", "e+")


def table(header, rows):
    lines = ["| " + " | ".join(header) + " |", "|" + "---|" * len(header)]
    return "\n".join(lines + ["| " + " | ".join(str(cell) for cell in row) + " |" for row in rows])


def knob(method, value):
    kind = KNOBS[method]
    if kind == "gap":
        return f"gap {value:.0e}".replace("e-0", "e-")
    if kind in ("step", "box width"):
        power = round(-math.log2(value))
        return f"{kind} 2^-{power}"
    return f"{value:,.0f} {kind}"


# ---- Targets ---------------------------------------------------------------------------------------------------------


def main_set(b):
    return b.sets[0][0]


def fits(b, lobes, name):
    return a.pick(b.fresh, "moment", lobes, a.GAP, name)


def verdict(good):
    return "reached" if good else "not reached"


def time_targets(b):
    rows = []
    for lobes, target in ((1, 1e-5), (2, 5e-4)):
        found = fits(b, lobes, main_set(b))
        whole, search = (a.median(a.seconds_of(found, field).values()) for field in ("seconds", "search"))
        rows.append([f"median certified fit, {lobes} lobe{'s' * (lobes > 1)} (gap 1e-3)", f"≤ {seconds(target)}",
                     f"{seconds(whole)} whole, {seconds(search)} of it search", verdict(whole <= target)])
    for lobes in (1, 2):
        ours = a.seconds_of(fits(b, lobes, main_set(b)))
        for method, what in (("levmar", "unconstrained"), ("levmar-box", "in a box")):
            found = a.median(a.ratios(a.start_seconds(b.fresh, method, lobes, main_set(b)), ours))
            rows.append([f"one levmar start ({what}) / certified fit, {lobes} lobe{'s' * (lobes > 1)}", "> 1",
                         f"{ratio(found)} (median of files)", verdict(found > 1.0)])
            rows.append([f"5,000 levmar starts ({what}) / certified fit, {lobes} lobe{'s' * (lobes > 1)}", "≥ 10,000",
                         f"{ratio(5000 * found)} (5,000 × the mean start)", verdict(5000 * found >= 1e4)])
    return rows


def total_targets(b):
    rows = []
    for lobes, target in ((1, 2.7e-3), (2, 0.18)):
        found = fits(b, lobes, main_set(b))
        search = sum(a.seconds_of(found, "search").values())
        boxes = sum(float(row["work"]) for row in found.values())
        rows.append([f"all {len(found)} files of {main_set(b)}, {lobes} lobe{'s' * (lobes > 1)}, search",
                     f"prototype: {seconds(target)} for 100 files", f"{seconds(search)}, {boxes:,.0f} boxes",
                     verdict(search <= target * len(found) / 100.0)])
    return rows


def paper_pairs(b, lobes, method):
    """[(gap, files closed, files tried, median ratio of boxes, of time)]: cut-short searches count as they stand."""
    found = []
    for gap in (1e-1, 1e-2, 1e-3):
        theirs = a.pick(b.paper, method, lobes, gap)
        if theirs:
            ours = a.pick(b.paper, "moment", lobes, gap)
            closed = sum(row["certified"] == "1" for row in theirs.values())
            boxes, time = (a.median(a.ratios(a.seconds_of(theirs, f), a.seconds_of(ours, f))) for f in ("work", "seconds"))
            found.append((gap, closed, len(theirs), boxes, time))
    return found


def paper_targets(b):
    rows = []
    for lobes in (1, 2):
        for gap, closed, files, boxes, time in paper_pairs(b, lobes, "socp-gap-every-box"):
            at_least = "" if closed == files else "at least "
            rows.append([f"paper's bound (socp, every box) / moment, {lobes} lobe{'s' * (lobes > 1)}, gap {gap:g}",
                         "boxes ≥ 1,000",
                         f"{at_least}{ratio(boxes)} × boxes, {ratio(time)} × time; the paper's closed {closed} of {files}",
                         verdict(boxes >= 1000)])
    return rows


def targets(b):
    return time_targets(b) + total_targets(b) + paper_targets(b) + kernel_targets(b)


def kernel_targets(b):
    rows = []
    for lobes, found in b.instructions.items():
        if found:
            rows.append([f"instructions, {lobes} lobe{'s' * (lobes > 1)}", "–",
                         f"{found['node']:,.0f} a node, {found['box']:,.0f} a box, {found['fit']:,.0f} a fit", "–"])
    best = [row for row in b.peak if row["distinct_c"] == "32"]
    if best:
        row = best[-1]
        rows.append(["node kernel's part of the machine's peak (28 distinct c)", "–",
                     f"{100 * float(row['fraction']):.0f} % with {row['isa']}", "–"])
    return rows


# ---- Curves ------------------------------------------------------------------------------------------------------------


def summary(b, lobes):
    rows = []
    for method in LABELS:
        points = b.curves.get(("all", str(lobes), method))
        if not points:
            continue
        full, last = a.cheapest(points), points[-1]
        most = a.cheapest(points, 0.95)
        rows.append([LABELS[method],
                     f"{seconds(most.seconds)} ({knob(method, most.knob)})" if most else "–",
                     f"{seconds(full.seconds)} ({knob(method, full.knob)})" if full else "–",
                     knob(method, last.knob), seconds(last.seconds), f"{last.found * last.files:.0f} of {last.files}",
                     error(last.median), error(last.worst), "yes" if method in ("moment", "socp") else "no"])
    return table(["method", "95 % of files found after", "all found after", "largest knob", "time", "found there",
                  "median error", "worst error", "proof"], rows)


def by_set(b, lobes):
    rows = []
    for method in LABELS:
        cells = []
        for name, _ in b.sets:
            points = b.curves.get((name, str(lobes), method))
            cells.append(f"{points[-1].found * points[-1].files:.0f}/{points[-1].files}, {error(points[-1].worst)}"
                         if points else "–")
        if any(cell != "–" for cell in cells):
            rows.append([LABELS[method], *cells])
    return table(["found, worst error at the largest knob", *(name for name, _ in b.sets)], rows)


# ---- Costs ---------------------------------------------------------------------------------------------------------------


def gap_rows(b):
    rows = []
    for power in range(1, 13):
        cells = []
        for lobes in (1, 2):
            found = a.pick(b.fresh, "moment", lobes, 10.0 ** -power)
            cells += [seconds(a.median(a.seconds_of(found).values())) if found else "–",
                      f"{a.median(a.seconds_of(found, 'work').values()):,.0f}" if found else "–",
                      f"{sum(row['certified'] == '1' for row in found.values())}/{len(found)}"]
        rows.append([f"1e-{power}", *cells])
    return table(["gap", "1 lobe: median time", "boxes", "certified", "2 lobes: median time", "boxes", "certified"], rows)


def scaling_table(rows, field, label):
    lines = []
    for value in sorted({int(row[field]) for row in rows}):
        cells = [f"{value:,}"]
        for lobes in ("1", "2"):
            row = next((r for r in rows if r[field] == str(value) and r["lobes"] == lobes), None)
            cells += [seconds(float(row["seconds"])), seconds(float(row["search"])),
                      f"{(int(row['peak_kib']) - int(row['data_kib'])) / 1024:.3g} MB of {int(row['peak_kib']) / 1024:.3g} MB"] \
                if row else ["–"] * 3
        lines.append(cells)
    return table([label, "1 lobe: fit", "of it search", "peak: fit, of process", "2 lobes: fit", "of it search",
                  "peak: fit, of process"], lines)


def cost_panels(b):
    def series(rows, field):
        return {f"{p} lobe{'s' * (p > 1)}": [(int(r[field]), float(r["seconds"])) for r in rows if r["lobes"] == str(p)]
                for p in (1, 2)}

    gaps = {f"{p} lobe{'s' * (p > 1)}": [(10.0 ** -g, a.median(a.seconds_of(a.pick(b.fresh, "moment", p, 10.0 ** -g)).values()))
                                         for g in range(1, 13)] for p in (1, 2)}
    return [("every c distinct, K = 3", "N, samples", series(b.by_n, "samples")),
            ("N = 84, every c distinct", "K, channels", series(b.by_k, "channels")),
            ("all files, median", "relative gap on E²", gaps)]


def exponents(b):
    parts = []
    for label, rows, field, least in (("N", b.by_n, "samples", 1000), ("K", b.by_k, "channels", 4)):
        for lobes in ("1", "2"):
            found = a.slope([(int(r[field]), float(r["seconds"])) for r in rows
                             if r["lobes"] == lobes and int(r[field]) >= least])
            if found is not None:
                parts.append(f"{label}^{found:.2f} with {lobes} lobe{'s' * (lobes == '2')}")
    return "; ".join(parts)


# ---- All of it -------------------------------------------------------------------------------------------------------------


def paper_table(b):
    rows = []
    for method, label in (("socp-gap-every-box", "every box to ECOS, as the paper"), ("socp-gap", "closed forms first")):
        for lobes in (1, 2):
            rows += [[label, lobes, f"{gap:g}", f"{closed} of {files}", ratio(boxes), ratio(time)]
                     for gap, closed, files, boxes, time in paper_pairs(b, lobes, method)]
    return table(["engine socp", "lobes", "gap", "closed in time", "boxes / moment's", "time / moment's"], rows)


def extra_sections(b):
    lines = []
    for title in ("Whole tables", "Whole maps"):
        lines += [f"### {title}", ""]
        rows = b.extra.get(title)
        lines += [table(list(rows[0]), [list(row.values()) for row in rows]) if rows else
                  "This build has no program for it.", ""]
    return lines


def evaluation_note(b):
    if not b.evaluation:
        return "SciPy was left out."
    cost = {key: seconds(value) for key, value in b.evaluation.items()}
    return (f"One evaluation of the reduced objective: {cost['C, 1']} in C with one lobe, {cost['C, 2']} with two; "
            f"from Python through ctypes {cost['ctypes, 1']} and {cost['ctypes, 2']}; vectorised in numpy "
            f"{cost['numpy, 1']} (one lobe). SciPy got the compiled one.")


def section(b):
    files = len(b.best) // 2
    versions = ", ".join(f"{name} {version}" for name, version in b.versions.items())
    return "\n".join([
        BEGIN, "## Run time against error", "",
        f"Made by `{b.options.command}` on {b.machine}, shared with other work (load {b.load[0]:.1f} at the start)."
        f"{' ' + b.options.note if b.options.note else ''} Seconds are processor time of one thread; reading files "
        "is not in them. "
        f"{files} files: " + ", ".join(f"{name} ({len(found)})" for name, found in b.sets) +
        ". narrow, near and single are generated (`tools/bench/families.c`): a second lobe far narrower than the "
        "sampling; two lobes 5 to 30 % apart; one lobe fitted with two. The figures (`bench.svg`: all files, median "
        "and worst; `bench_sets.svg`: each set; "
        "`bench_costs.svg`) and every row are then in `build/bench/`.", "",
        "### Targets", "", table(["what", "target", "reached", ""], targets(b)), "",
        "### Every method over its knob", "",
        "Error = (E − E*)/E*, E = √E², E* of the certified fit at a gap of 1e-12. A file is *found* when the error "
        "is at most 1e-6. Times are medians over the files; of engines the whole `brdffit_fit()` with its proof, of "
        "peers the solver alone without "
        "any preparation.", "",
        "**One lobe**", "", summary(b, 1), "", "**Two lobes**", "", summary(b, 2), "",
        "Two lobes, by data set:", "", by_set(b, 2), "", "One lobe, by data set:", "", by_set(b, 1), "",
        f"No answer of any peer is below a proven lower bound ({len(b.fresh) + len(b.peers):,} rows judged).", "",
        f"Peers: {versions}{', SciPy ' + scipy_version() if b.evaluation else ''}. {evaluation_note(b)}", "", *SETTINGS, "",
        PEERS, "",
        "### Against the paper's bound", "",
        f"{b.paper_files} files of {main_set(b)}. Medians over files; a search that ran out of patience counts with "
        "the boxes and time "
        "it had, so that such ratios are lower limits.", "", paper_table(b), "",
        "### What a fit costs", "", "Against the gap, all files:", "", gap_rows(b), "",
        "Against N (K = 3) and K (N = 84), every c distinct, which is the worst case of the reduction; growth "
        f"{exponents(b)}. Larger N are left out "
        f"where a fit could take more than {b.options.longest:g} s (`--longest`):", "",
        scaling_table(b.by_n, "samples", "N"), "", scaling_table(b.by_k, "channels", "K"), "",
        f"Peak memory of the command line as a whole process, one file: {b.memory[1] / 2 ** 20:.3g} MB with one lobe, "
        f"{b.memory[2] / 2 ** 20:.3g} MB with two.", "", *kernel_section(b), *extra_sections(b), END, ""])


def kernel_section(b):
    lines = ["### Kernels", ""]
    if b.peak:
        rows = [[row["isa"], row["distinct_c"], seconds(float(row["node_seconds"])), f"{float(row['node_flops']) / 1e9:.3g}",
                 f"{float(row['peak_flops']) / 1e9:.3g}", f"{100 * float(row['fraction']):.0f} %"] for row in b.peak]
        lines += ["The node kernel (three channels) beside a loop of independent multiplications and additions; no "
                  "FMA in either. "
                  "Operations are counted from the source (`tools/bench/kernel.c`).", "",
                  table(["instruction set", "distinct c (padded)", "a node", "Gflop/s", "peak Gflop/s", "part of it"], rows), ""]
    rows = [[lobes, f"{f['node']:,.0f}", f"{f['box']:,.0f}", f"{f['fit']:,.0f}", f"{f['nodes']:.0f}", f"{f['boxes']:.0f}"]
            for lobes, f in b.instructions.items() if f]
    if rows:
        lines += ["Instructions by callgrind (which knows no AVX-512, so that the fit runs its AVX2 code), mean of "
                  "three files of "
                  f"{main_set(b)} at gap 1e-3; a box without its nodes:", "",
                  table(["lobes", "a node", "a box", "a fit", "nodes", "boxes"], rows), ""]
    else:
        lines += ["valgrind was not there: instructions were not counted.", ""]
    return lines


def scipy_version():
    import scipy

    return scipy.__version__


def terminal(b):
    """The targets, and where everything is."""
    rows = targets(b)
    width = max(len(row[0]) for row in rows)
    lines = [f"{row[0]:{width}}  {row[1]:34}  {row[3]:11}  {row[2]}" for row in rows]
    return "\n".join([*lines, "", f"{os.path.join(str(b.out), 'results.md')}, bench.svg, bench_sets.svg, bench_costs.svg, *.csv"])
