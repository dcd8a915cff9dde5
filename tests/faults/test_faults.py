"""A part of the fault campaign (campaign.py has all of it), and what a signal may not do. SPDX-License-Identifier: MIT"""
import pathlib
import subprocess
import sys

import pytest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

import campaign
import scenes

# Of each kind the scenes that have most to lose; `make faults` plays them all.
PLAYED = [("allocations", "fit-socp", 5), ("allocations", "eval", 6), ("allocations", "merge", 5), ("allocations", "map-png", 6),
          ("allocations", "map-npz", 6), ("full disk", "fit", 3), ("full disk", "map-npz", 3), ("broken disk", "map", 3),
          ("broken disk", "compare", 2), ("kills", "fit", 4), ("kills", "map", 5), ("kills", "merge-map", 4),
          ("truncations", "fit-table", 4), ("truncations", "map-list", 3)]


def sanitized():
    """Whether the program brings an allocator of its own, which no other may stand before."""
    return b"__asan_init" in scenes.harness.BRDFFIT.read_bytes()


@pytest.mark.parametrize("kind,scene,most", PLAYED, ids=["%s-%s" % (kind, scene) for kind, scene, _ in PLAYED])
def test_campaign(kind, scene, most, tmp_path):
    if not campaign.INJECT.exists() or (kind == "allocations" and sanitized()):
        pytest.skip("nothing to inject faults with: not Linux, or a build with sanitizers")
    if scene == "fit-socp" and not scenes.harness.has_ecos():
        pytest.skip("built without ECOS")
    count, wrong = campaign.run(kind, scenes.BY_NAME[scene], most, tmp_path)
    if count is None:
        pytest.skip("this system does not let us trace")
    assert wrong == [] and count >= most


def test_a_table_that_is_cut_under_the_sweep(tmp_path):
    """SIGBUS is one file that cannot be read: the others are fitted, before and after."""
    if not campaign.INJECT.exists():
        pytest.skip("nothing to inject faults with")
    for name in "abc":
        scenes.table(tmp_path / (name + ".binary"))
    files = [name + ".binary" for name in "abc"]
    good = scenes.harness.run("fit", "--quiet", *files, cwd=tmp_path)
    assert good.returncode == 0
    seen = set()
    for at in range(1, 60):
        scenes.table(tmp_path / "b.binary")
        done = subprocess.run([campaign.INJECT, "touch", "truncate", "b.binary", "20", str(at), "--", scenes.harness.BRDFFIT, "fit",
                               "--json", *files], cwd=tmp_path, env=scenes.harness.environment(), capture_output=True,
                              timeout=scenes.harness.PATIENCE)
        if done.returncode == campaign.UNABLE:
            pytest.skip("this system does not let us trace")
        assert done.returncode in (0, 1, 3), (at, done.stderr)
        fits = scenes.harness.lines(done.stdout.decode())
        assert [fit["status"] for fit in fits if fit["file"] != "b.binary"] == ["certified"] * 2
        seen.add(next(fit["error"]["code"] if fit["status"] == "error" else "fitted" for fit in fits if fit["file"] == "b.binary"))
    assert {"read", "format"} <= seen
