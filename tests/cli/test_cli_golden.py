"""Golden cases: cases/*.txt, each a command, its exit code and what it prints.

    # why
    $ fit two.csv --lobes 2          the command without the program's name (shell syntax)
    env LC_ALL=C                     changes of the environment, optional
    needs ecos                       skipped in a build without, optional
    mask numbers                     of any kind: where a search stopped early is the engine's business
    exit 0
    --- stdout
    ...
    --- stderr
    ...

Times, counts of boxes and nodes, the proven bound and everything at rounding level are masked before comparing: they
follow the machine or the engine. After a wanted change, BRDFFIT_UPDATE_GOLDEN=1 rewrites the files; read the diff.

SPDX-License-Identifier: MIT
"""
import os
import re
import shlex

import pytest

import harness

CASES = sorted((harness.HERE / "cases").glob("*.txt"))
NUMBER = r"[0-9](?:[0-9.,]*[0-9])?(?:e[-+]?[0-9]+)?"
PARAGRAPH = "(?:Proven:|NOT proven:|Verified:|NOT verified:|Warning,|Search:|Lobes:|Skipped:|Format:|Used:)"
MASKS = [
    (r"(read|reduce|search)\s+" + NUMBER + r"\s+(ms|s)\b", r"\1 <time>"),
    (NUMBER + r"\s+box(es)?,\s+" + NUMBER + r"\s+nodes?", "<n> boxes, <n> nodes"),
    (NUMBER + r"\s+box(es)?,\s+" + NUMBER + r"\s+programs?\s+by\s+ECOS\s+\(" + NUMBER + r"\s+refused\),\s+" + NUMBER +
     r"\s+box(es)?\s+decided\s+without", "<n> boxes, <n> programs by ECOS (<n> refused), <n> boxes decided without"),
    (r"below\s+" + NUMBER + r":\s+" + NUMBER + r"\s+box(es)?\s+discarded", "below <level>: <n> boxes discarded"),
    (r"leave\s+" + NUMBER + r"\s%\sof\sthe\sdomain", "leave <share> of the domain"),
    (NUMBER + r"\s+programs?\s+by\s+ECOS\s+\(" + NUMBER + r"\s+refused\),\s+" + NUMBER + r"\s(ms|s)\.",
     "<n> programs by ECOS (<n> refused), <time>."),
    (r"below\s+" + NUMBER + r";", "below <bound>;"),
    (r"lies\s+between\s+" + NUMBER, "lies between <bound>"),
    (r"\s+\(" + NUMBER + r"\s%\sabove\)", " (<gap> above)"),
    (r"this\s+one\s+has\s+" + NUMBER, "this one has <e2>"),
    (r"fit's\s+" + NUMBER, "fit's <e2>"),
    (r"by\s+more\s+than\s+" + NUMBER, "by more than <gap>"),
    (r"(?m) +" + NUMBER + r" (ms|s)$", " <time>"),
    (r"\bBIC by " + NUMBER, "BIC by <n>"),
    # Residuals of an exact fit.
    (r" +[0-9.]+e-(1[3-9]|2[0-9]|3[0-9])\b", " <rounding>"),
    (r"brdffit [0-9]+\.[0-9]+\.[0-9]+$", "brdffit <version>"),
]


def mask(text, numbers=False):
    """What is masked may also move a line break: paragraphs are joined first."""
    text = re.sub(r"(?m)^  %s.*(?:\n  (?! |%s).*)+" % (PARAGRAPH, PARAGRAPH),
                  lambda match: re.sub(r"\n +", " ", match[0]), text)
    for pattern, replacement in MASKS:
        text = re.sub("(?m)" + pattern, replacement, text)
    if numbers:
        text = re.sub(r" *(?<![\w<.-])" + NUMBER + r"(?![\w>])", " <n>", text)
    return text


def parse(path):
    case = {"comment": [], "env": {}, "mask": False, "ecos": False, "stdout": "", "stderr": ""}
    text, _, rest = path.read_text(encoding="utf-8").partition("--- stdout\n")
    case["stdout"], _, case["stderr"] = rest.partition("--- stderr\n")
    for line in text.splitlines():
        if line.startswith("$"):
            case["command"] = line[1:].strip()
        elif line.startswith("env "):
            name, _, value = line[4:].partition("=")
            case["env"][name] = value
        elif line == "needs ecos":
            case["ecos"] = True
        elif line == "mask numbers":
            case["mask"] = True
        elif line.startswith("exit "):
            case["exit"] = int(line[5:])
        else:
            case["comment"].append(line)
    return case


def write(path, case):
    head = [*case["comment"], "$ " + case["command"], *("env %s=%s" % e for e in case["env"].items()),
            *(["needs ecos"] if case["ecos"] else []), *(["mask numbers"] if case["mask"] else [])]
    path.write_text("\n".join([*head, "exit %d" % case["exit"], "--- stdout\n"]) + case["stdout"] + "--- stderr\n" +
                    case["stderr"], encoding="utf-8")


@pytest.mark.parametrize("path", CASES, ids=lambda path: path.stem)
def test_golden(path, desk):
    case = parse(path)
    if case["ecos"] and not harness.has_ecos():
        pytest.skip("this build is without ECOS")
    done = harness.run(*shlex.split(case["command"]), cwd=desk, env=harness.environment(**case["env"]))
    got = dict(case, exit=done.returncode, stdout=mask(done.stdout, case["mask"]),
               stderr=mask(done.stderr))
    if os.environ.get("BRDFFIT_UPDATE_GOLDEN") == "1":
        write(path, got)
    assert got["stderr"] == case["stderr"]
    assert got["stdout"] == case["stdout"]
    assert got["exit"] == case["exit"]


def test_there_are_cases():
    assert len(CASES) > 40
