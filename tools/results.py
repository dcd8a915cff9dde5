"""RESULTS.md: a marked section for each program that measures (`make paper`, `bench`, `stress`, `export-errors`).

SPDX-License-Identifier: MIT
"""
import os
import pathlib
import platform


def machine():
    """The processor, for people."""
    name = platform.processor() or platform.machine()
    try:
        for line in pathlib.Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines():
            if line.startswith("model name"):
                name = line.split(":", 1)[1].strip()
                break
    except OSError:
        pass
    return f"{name}, one of {os.cpu_count()} cores"


def put(path, text, begin, end):
    """Replace the section from `begin` to `end` of a Markdown file by `text`, which holds both markers, or append it; other
    sections stay."""
    path = pathlib.Path(path)
    old = path.read_text(encoding="utf-8") if path.exists() else "# Results\n"
    if begin in old and end in old:
        head, rest = old.split(begin, 1)
        new = head + text.rstrip("\n") + rest.split(end, 1)[1]
    else:
        new = old.rstrip("\n") + "\n\n" + text
    part = path.with_name(path.name + ".part")
    part.write_text(new, encoding="utf-8")
    part.rename(path)
