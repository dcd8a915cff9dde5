"""The Markdown table of a stress run. SPDX-License-Identifier: MIT"""
from cases import FAMILIES

BEGIN = "<!-- make stress: begin (written by tools/stress; edit there) -->"
END = "<!-- make stress: end -->"


def worst(rows, key):
    values = [row[key] for row in rows if row[key] is not None]
    return max(values) if values else None


def show(value, digits=2):
    return "–" if value is None else "0" if value == 0 else f"{value:.{digits}g}"


def elsewhere(rows):
    if not rows:
        return "0"
    return f"{len(rows)}: to {show(worst(rows, 'excess') or 0)} E², {show(worst(rows, 'excess_of_data'))} T"


def stops(rows):
    """Why searches ended before their gap closed, by number."""
    reasons = [row["stop"] for row in rows if not row["certified"]]
    return ", ".join(f"{reasons.count(r)} {r}" for r in sorted(set(reasons))) or "none"


def section(rows, members):
    lines = []
    for family, (_, strain) in FAMILIES.items():
        some = [row for row in rows if row["family"] == family]
        if not some:
            continue
        certified = sum(row["certified"] or 0 for row in some)
        margins = [row["margin"] for row in some if row["margin"] is not None]
        units = [row["margin_units"] for row in some if row["margin_units"] is not None]
        lines.append([strain, len(some), certified, show(worst(some, "e2_relative")), show(worst(some, "e2_units")),
                      show(worst(some, "model_units")),
                      show(worst([r for r in some if r["basin"] == "same"], "excess")),
                      elsewhere([row for row in some if row["basin"] == "another"]),
                      show(worst(some, "sigma_error")), show(worst(some, "sigma_units")),
                      show(worst(some, "x_error")), show(worst(some, "y_error")),
                      show(worst(some, "own_error")), show(worst(some, "own_units")),
                      show(min(margins) if margins else None), show(min(units) if units else None),
                      sum("bound" in row["failure"] for row in some), f"{worst(some, 'boxes') or 0:,}"])
    head = ["strain", "fits", "certified", "E², relative", "√E² in u√T", "of σ, x, y", "excess of E²", "another basin", "σ",
            "σ in √(ΔE²/λ)", "x", "y", "terms at its σ", "in u(k + k²r + 2cs)", "bound below by", "in u T",
            "bounds above", "most boxes"]
    failed = [row for row in rows if row["failure"]]
    out = [BEGIN, "## Stability", "",
           f"Made by `make stress STRESS_MEMBERS={members}`: {len(rows):,} fits (Beckmann, GGX and Blinn–Phong, one and two "
           "lobes, one to three channels) of random problems that strain double arithmetic, each against the minimum in Arb "
           "balls of 400 bits, confirmed by 50-digit mpmath. Worst of each family; u = 2⁻⁵³, T the data's sum of squares.", "",
           "| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    out += ["| " + " | ".join(map(str, line)) + " |" for line in lines]
    out += ["", "*E², relative*: `e2` against the exact minimum over x and y at its own σ, where E² > 10⁻²⁴ T; *√E² in u√T*: the "
            "same error as rounding theory has it (a residual is known to a few u of its datum), and that of the E² which the "
            "returned doubles σ, x and y really have. *Excess*: the exact E² at "
            "the returned σ over the global minimum (where σ is flat to 10⁻¹² of E², the largest is returned); *σ*: "
            "relative error; where E² is flat σ cannot be had better than a change that E² shows, so *σ in "
            "√(ΔE²/λ)* divides by that: ΔE² = u√(E²T) + u²T, its rounding, and λ its smallest curvature in ln s. "
            "*Another basin*: the fit is certified within its gap of 10⁻³ or 10⁻¹² T, but at another local optimum "
            "than the global one (or on a plateau not yet descended): its excess over the global minimum, in terms "
            "of E² and of T; left out of σ, x, y and excess. *x*, *y*: relative to the largest of their column, "
            "where the columns' condition is at most 10⁸. *Terms at its σ*: the length of what x and y add to the "
            "fit against that of the exact ones at the same σ, relative to the data's; then in units of what least "
            "squares may lose, k the condition of the columns, r = √(E²/T), c the smallest c. *Bound below by*: the "
            "smallest (minimum − `lower_bound`)/minimum, of this fit and of another that closes its gap as far as "
            "rounding (or 20,000 boxes) lets it; then the smallest minimum − `lower_bound` in units of u T. *Bounds "
            "above*: lower bounds that a ball "
            "proves to be above an explicit model's E², by however little.", "",
            f"Every fit of at most 30,000 boxes was run again in nine floating-point environments (rounding down, up, towards "
            f"zero; FTZ, DAZ and combinations): {sum(row['same_bits'] == 0 for row in rows)} differ in a bit. c = "
            "10⁻³³ in place of 0 takes up to "
            f"{show(max((row['boxes'] / row['twin_boxes'] for row in rows if row['twin_boxes']), default=None))} "
            "times the boxes. "
            f"Not certified: {stops(rows)}.", "",
            f"Promises that did not hold: {len(failed)}."]
    out += [f"- `{row['name']}`: {row['failure']}" for row in failed[:20]]
    return "\n".join([*out, END, ""])
