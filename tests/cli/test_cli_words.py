"""What the command line says to somebody who has not met it before: hints at slips, helps that fit a terminal, and the
completion of shells, which is made of the table of options.

SPDX-License-Identifier: MIT
"""
import re
import shutil
import subprocess

import pytest

import harness

COMMANDS = ["fit", "compare", "eval", "map", "merge", "info", "completion"]


@pytest.mark.parametrize("given,hint", [
    (["version"], "'--version'"), (["-v"], "'--version'"), (["-V"], "'--version'"), (["--verison"], "'--version'"),
    (["fitt"], "'fit'"), (["complete"], "'completion'"), (["fit", "x", "-lobes", "2"], "'--lobes'"),
    (["fit", "x", "-output", "y"], "'--output'"), (["fit", "x", "-quiet"], "'--quiet'"), (["map", "x", "-gap=1"], "'--gap'"),
    (["fit", "x", "--distribution", "GGX"], "'ggx'"), (["fit", "x", "--norm", "L1"], "'l1'"),
    (["fit", "x", "--Lobes", "2"], "'--lobes'"),
    (["fit", "x", "--fresnel", "Schlick"], "'schlick'"), (["fit", "x", "--lobes", "GGX"], "'ggx'")])
def test_hints(given, hint):
    done = harness.run(*given)
    assert done.returncode == 2 and "did you mean %s?" % hint in done.stderr, done.stderr


def test_short_options_keep_their_values(tmp_path):
    """-oNAME is no slip, unless NAME makes it the name of an option."""
    done = harness.run("fit", "-oout.txt", harness.DATA / "mixed.csv", cwd=tmp_path)
    assert done.returncode == 0 and (tmp_path / "out.txt").exists()


@pytest.mark.parametrize("command", [None, *COMMANDS])
def test_helps_fit_a_terminal(command):
    text = harness.run(*([command] if command else []), "--help").stdout
    assert text and max(map(len, text.splitlines())) < 80, [line for line in text.splitlines() if len(line) > 79]


def options(command):
    return set(re.findall(r"^  (?:-\w, )?--([\w-]+)", harness.run(command, "--help").stdout, re.M))


def completed(*words):
    """What bash offers for the last of the words."""
    asked = "COMP_WORDS=(%s)\nCOMP_CWORD=%d\n" % (" ".join("'%s'" % word for word in words), len(words) - 1)
    script = harness.run("completion", "bash").stdout + asked + "_brdffit\nprintf '%s\\n' \"${COMPREPLY[@]}\"\n"
    return set(subprocess.run(["bash", "-c", script], capture_output=True, text=True, check=True).stdout.split())


@pytest.mark.skipif(shutil.which("bash") is None, reason="no bash here")
def test_bash():
    assert set(COMMANDS) <= completed("brdffit", "")
    assert completed("brdffit", "co") == {"compare", "completion"}
    assert completed("brdffit", "fit", "--norm", "l") == {"l1", "l2", "linf"}
    assert {"beckmann", "ggx"} <= completed("brdffit", "map", "--distribution", "")
    for command in COMMANDS[:-1]:
        assert completed("brdffit", command, "--") == {"--" + name for name in options(command)}, command


@pytest.mark.parametrize("shell", ["zsh", "fish"])
def test_other_shells(shell, tmp_path):
    """Every option and command is in it; the shell takes it, where there is one."""
    text = harness.run("completion", shell).stdout
    for command in COMMANDS:
        assert command in text
        for name in options(command) if command != "completion" else ():
            assert ("--%s" if shell == "zsh" else "-l %s ") % name in text
    assert all(line.count("'") % 2 == 0 for line in text.splitlines())
    if shutil.which(shell):
        (tmp_path / "script").write_text(text)
        subprocess.run([shell, "-n", tmp_path / "script"], check=True)


def test_completion_of_what():
    assert harness.run("completion").returncode == 2 and harness.run("completion", "csh").returncode == 2
