"""What the tests of the command line share: where things are, how to run them.

SPDX-License-Identifier: MIT
"""
import functools
import json
import os
import pathlib
import subprocess

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
BUILD = (ROOT / os.environ.get("BRDFFIT_BUILD", "build")).resolve()
BRDFFIT = BUILD / "brdffit"
GONIOMETER = BUILD / "goniometer"
DATA = HERE / "data"

# Long enough for a sanitizer build on a busy machine; only a hang reaches it.
PATIENCE = 300


def environment(**changes):
    """The environment of a test: UTF-8, no colour questions, nothing else inherited that matters."""
    env = {k: v for k, v in os.environ.items() if not k.startswith(("LC_", "LANG", "NO_COLOR", "TERM"))}
    env["LC_ALL"] = "C.UTF-8"
    for name, value in changes.items():
        if value is None:
            env.pop(name, None)
        else:
            env[name] = value
    return env


def run(*arguments, program=BRDFFIT, cwd=None, stdin=None, env=None, **more):
    """Run to the end; stdout and stderr as text. `stdin` is bytes."""
    done = subprocess.run([program, *arguments], cwd=cwd, input=b"" if stdin is None else stdin, env=env or environment(),
                          capture_output=True, timeout=PATIENCE, **more)
    done.stdout = done.stdout.decode("utf-8")
    done.stderr = done.stderr.decode("utf-8", "replace")
    return done


@functools.cache
def has_ecos():
    """Whether this build can run engine socp (make ECOS=0 cannot)."""
    return "ECOS" not in run("fit", "--quiet", "--engine", "socp", DATA / "mixed.csv").stderr


def forbid(constant):
    raise AssertionError("%s is not JSON" % constant)


def lines(text):
    """The objects of JSON lines; NaN and Infinity, which Python would let pass, are errors."""
    assert text.endswith("\n")
    return [json.loads(line, parse_constant=forbid) for line in text.splitlines()]


def fit(*arguments, expect=0, **more):
    """The objects that `fit --json` prints."""
    done = run("fit", "--json", *arguments, **more)
    assert done.returncode == expect, done.stderr
    return lines(done.stdout)
