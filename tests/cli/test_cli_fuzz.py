"""Every fuzz target on some thousand mutations of its seeds, and on the inputs that are kept; `make fuzz` goes on from there.

SPDX-License-Identifier: MIT
"""
import pytest

import harness

FUZZ = harness.BUILD / "tests" / "fuzz"
TARGETS = sorted(path.stem.removeprefix("fuzz_") for path in (harness.ROOT / "tests" / "fuzz").glob("fuzz_*.c"))
# Those of the libraries have C tests of their own.
COUNT = {"json": 10000, "list": 20000, "merge": 20000, "png": 3000}


@pytest.mark.parametrize("name", TARGETS)
def test_target(name):
    program = FUZZ / ("fuzz_" + name)
    if not program.exists():
        pytest.skip("fuzz targets are not built")
    kept = sorted((harness.ROOT / "tests" / "fuzz" / "corpus" / name).iterdir())
    assert kept
    for arguments in (["-n", str(COUNT.get(name, 2000))], kept):
        done = harness.run(*arguments, program=program)
        assert done.returncode == 0 and "no fault" in done.stdout, (done.stdout, done.stderr)
