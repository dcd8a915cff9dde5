"""
Measurements as text that tests/cross/bits.c reads without rounding: problems.py FILE... (needs the Python package).

SPDX-License-Identifier: MIT
"""
import sys

import brdffit


def main() -> None:
    for path in sys.argv[1:]:
        samples = brdffit.Samples.from_csv(path)
        if samples.form != "directions":
            continue
        print(len(samples.values), samples.values.shape[1])
        for array in (samples.light, samples.view, samples.values):
            print(*(float(v).hex() for v in array.ravel()))


if __name__ == "__main__":
    main()
