"""Names of the benchmark's methods and what is said of their settings. SPDX-License-Identifier: MIT"""

LABELS = {
    "moment": "**brdffit, engine moment**",
    "socp": "brdffit, engine socp, every box, to a box width",
    "grid": "brute force, σ = k·step",
    "levmar": "levmar",
    "levmar-box": "levmar in a box, as the paper",
    "ceres": "Ceres",
    "varpro": "variable projection",
    "recursive": "recursive multi-start",
    "recursive-box": "recursive multi-start in a box",
    "nlopt-direct-l": "NLopt DIRECT-L",
    "nlopt-mlsl": "NLopt MLSL",
    "nlopt-stogo": "NLopt StoGO",
    "nlopt-crs": "NLopt CRS",
    "scipy-direct": "SciPy direct",
    "scipy-shgo": "SciPy shgo",
    "scipy-dual-annealing": "SciPy dual_annealing",
    "scipy-differential-evolution": "SciPy differential_evolution",
}

KNOBS = {
    "moment": "gap", "socp": "box width", "grid": "step", "levmar": "starts", "levmar-box": "starts", "ceres": "starts",
    "varpro": "starts", "recursive": "starts a round", "recursive-box": "starts a round",
    "nlopt-direct-l": "evaluations", "nlopt-mlsl": "evaluations", "nlopt-stogo": "evaluations", "nlopt-crs": "evaluations",
    "scipy-direct": "evaluations", "scipy-shgo": "points", "scipy-dual-annealing": "iterations",
    "scipy-differential-evolution": "generations",
}

SETTINGS = [
    "Settings, the best of those tried:",
    "",
    "- NLopt, SciPy, variable projection and brute force minimise E²(σ), the coefficients eliminated by non-negative least "
    "squares in closed form, over samples of equal c merged (28 of 84): the same reduction that the library makes, in compiled "
    "code for AVX-512, AVX2 or SSE2 (`tools/bench/curves_reduced.c`, which may use FMA). Two lobes are searched "
    "over the whole square.",
    "- Variable ln σ in [1e-3, 6]; tried: σ itself, which misses narrow lobes (33 files, 2,000 evaluations, two "
    "lobes: CRS 67 % found against 88 %, DIRECT-L 88 % against 91 %).",
    "- A local search by L-BFGS with the analytic gradient follows DIRECT-L, StoGO, CRS and SciPy's direct and "
    "differential_evolution; tried: none, which finds fewer at every number of evaluations. MLSL: L-BFGS inside, random points; "
    "tried: Sobol points (94 % found against 100 %), Subplex inside (slower to 500 evaluations). DIRECT-L: NLopt's own; tried: "
    "randomised, Gablonsky's original (the same within a few per cent). StoGO: deterministic; tried: randomised (the same). MLSL "
    "ends at 2,000 evaluations, because its time grows with their square.",
    "- SciPy: direct locally biased, no tolerances; shgo with Sobol points; dual_annealing with the gradient in its "
    "local search; differential_evolution vectorised, a whole generation in one call, tolerance 0; one fixed seed.",
    "- levmar and Ceres: the best of `tools/paper` (its section here): square-root and logarithmic chart, log-uniform starts, "
    "coefficients by NNLS. \"In a box\" is the plain reading of the paper: σ, x, y themselves, uniform starts.",
    "- Variable projection: the reduced problem as NLopt has it, Levenberg–Marquardt in ln σ with the Hessian where that is "
    "positive definite, else Kaufman's matrix (`curves_varpro.c`, `curves_projected.c`), from the roughnesses of "
    "levmar's starts; tried: Kaufman's and Golub and Pereyra's matrices everywhere, which with two lobes find "
    "fewer (168 and 166 of 179 after 1,000 starts).",
    "- Recursive multi-start after Optical Engineering 60(9), 094103 (README of `tools/bench`: what of it is known): levmar as "
    "above from starts that span the roughnesses evenly, coefficients by NNLS. \"In a box\" has bounds on σ, x, y "
    "themselves and starts that span all of them; tried: the logarithmic chart in a box (slower).",
    "- Brute force in double: lobes computed once, pairs screened 64 at a time and solved only when they could win.",
]

PEERS = ("Rows of the peers come from a cache that knows their sources, settings and data; the engines, and five "
         "levmar starts of each kind beside them for the ratios, are measured in every run, file by file. `FRESH=1` "
         "measures all.")
