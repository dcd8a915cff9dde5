"""brdffit_shade.h compiles as C99 and as C++17, strictly, and beside the library's header; both languages compute the same.

SPDX-License-Identifier: MIT
"""
import os
import pathlib
import shutil
import subprocess

import pytest

ROOT = pathlib.Path(__file__).resolve().parent.parent
STRICT = ["-O1", "-Wall", "-Wextra", "-Wpedantic", "-Wshadow", "-Wconversion", "-Werror", "-Wno-unused-function",
          "-ffp-contract=off", "-I", str(ROOT / "include")]
PROGRAM = """
#include "brdffit_shade.h"
#include "brdffit_shade.h"
#include "brdffit.h"
#include <stdio.h>
int main(void)
{
    static struct brdffit_shade_f single;
    static struct brdffit_shade_d twice;
    const double sigma[] = {0.2, 0.4, 0.3}, x[] = {0.3, 0.2}, more[] = {0.1, 0.2};
    const double y[] = {0.1, 0.2, 0.05, 0.1, 0.1, 0.02}, f0[] = {0.1, 1, 0, 0.5, 0.2, 0.3};
    const struct brdffit_shade_description d = {3, 2, {BRDFFIT_SHADE_GGX, BRDFFIT_SHADE_BECKMANN, BRDFFIT_SHADE_GGX},
                                                BRDFFIT_SHADE_SMITH, BRDFFIT_SHADE_OREN_NAYAR, 1, sigma, x, y, f0, more};
    const double l[] = {0.6, 0, 0.8}, v[] = {-0.28, 0.1, 0.954777}, u[] = {0.4, 0.3, 0.7};
    const float lf[] = {0.6f, 0, 0.8f}, vf[] = {-0.28f, 0.1f, 0.954777f};
    double out[3], drawn[3], pdf;
    float outf[3];
    if (!brdffit_shade_make_f(&single, &d) || !brdffit_shade_make_d(&twice, &d)) {
        return 1;
    }
    brdffit_shade_eval_f(&single, lf, vf, outf);
    brdffit_shade_eval_d(&twice, l, v, out);
    pdf = brdffit_shade_sample_d(&twice, v, u, drawn);
    printf("%.15g %.15g %.7g %.7g %.12g %.12g\\n", out[0], out[1], (double)outf[0], (double)outf[1], pdf, drawn[0]);
    return 0;
}
"""


def run(folder, compiler, standard, ending):
    source = folder / ("shade" + ending)
    source.write_text(PROGRAM)
    subprocess.run([*compiler.split(), standard, *STRICT, "-o", folder / "shade", source, "-lm"], check=True)
    return subprocess.run([folder / "shade"], capture_output=True, text=True, check=True).stdout


def test_both_languages(tmp_path):
    plain = os.environ.get("CC", "cc")
    plus = os.environ.get("CXX", "g++")
    if not shutil.which(plain.split()[0]) or not shutil.which(plus.split()[0]):
        pytest.skip("no compiler of C and of C++")
    assert run(tmp_path, plain, "-std=c99", ".c") == run(tmp_path, plus, "-std=c++17", ".cc")
