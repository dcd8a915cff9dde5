"""The documentation, from start to end: figures, generated pages, notebook, HTML, and a look at the result.

    build.py BUILD

writes BUILD/docs/html; BUILD holds the library and the programs. Nothing is written elsewhere. Warnings are errors.
SPDX-License-Identifier: MIT
"""
import dataclasses
import os
import pathlib
import re
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent


def environment(build):
    """Of this process and of the notebook's kernel: the package's sources on the library of the build tree."""
    out = dict(os.environ)
    out["BRDFFIT_BUILD"] = str(build)
    out["BRDFFIT_LIBRARY"] = str(build / "libbrdffit.so")
    out["PYTHONPATH"] = str(ROOT / "python" / "src")
    out["PYTHONDONTWRITEBYTECODE"] = "1"
    out["MATPLOTLIBRC"] = str(ROOT / "docs" / "matplotlibrc")
    out.pop("MPLBACKEND", None)
    out["MPLCONFIGDIR"] = str(build / "docs" / "matplotlib")
    out["TMPDIR"] = str(build / "docs" / "tmp")
    # The notebook finds its kernel in this environment, and no setting of the user's changes the result.
    for name, folder in (("IPYTHONDIR", "ipython"), ("JUPYTER_CONFIG_DIR", "jupyter"), ("JUPYTER_RUNTIME_DIR", "runtime"),
                         ("JUPYTER_DATA_DIR", "data")):
        out[name] = str(build / "docs" / folder)
    return out


def fill(path, **places):
    """A written page with what is generated in the place of a word in capitals."""
    text = path.read_text(encoding="utf-8")
    for word, made in places.items():
        assert word in text, "%s has no %s" % (path, word)
        text = text.replace(word, made)
    path.write_text(text, encoding="utf-8")


def adopt(text):
    """A page of the repository as one of these: its links to files lead nowhere here, and a dollar is no formula."""
    text = re.sub(r"(?<!!)\[([^\]\n]+)\]\((?!https?:|#)[^)\n]*\)", r"\1", text)
    parts = re.split(r"(```.*?```|`[^`\n]*`)", text, flags=re.S)
    parts[::2] = [part.replace("$", "\\$") for part in parts[::2]]
    return "".join(parts)


def stage(source, build):
    """A copy of docs/ with the generated pages beside the written ones."""
    shutil.rmtree(source, ignore_errors=True)
    shutil.copytree(ROOT / "docs", source, ignore=shutil.ignore_patterns("__pycache__", ".*"))
    from ext import api_pages, c_header, program_help

    fill(source / "python.md", PAGES="\n".join("api/" + page for page in api_pages.write(source / "api")))
    fill(source / "cli.md", COMMANDS="\n".join("## brdffit %s\n\n```{program-help} brdffit %s\n```\n" % (name, name)
                                               for name in program_help.commands(build / "brdffit")))
    for name in ("RESULTS", "CHANGELOG"):
        (source / (name.lower() + ".md")).write_text(adopt((ROOT / (name + ".md")).read_text(encoding="utf-8")), encoding="utf-8")
    shutil.copytree(ROOT / "examples", source / "examples")
    (source / "c").mkdir()
    for name, first in (("brdffit", "Version and limits"), ("brdffit_io", "Measurements")):
        text = (ROOT / "include" / (name + ".h")).read_text(encoding="utf-8")
        (source / "c" / (name + ".rst")).write_text(c_header.page(text, name + ".h", first), encoding="utf-8")


def example(folder):
    """A report as users get it, beside the pages."""
    import brdffit
    import brdffit.report

    samples = brdffit.Samples.from_csv(pathlib.Path(brdffit.__file__).parent / "two_lobe_satin.csv")
    named = dataclasses.replace(samples, file="two_lobe_satin.csv")
    folder.mkdir()
    (folder / "example_report.html").write_text(brdffit.report.page(named, "two_lobe_satin", lobes=2), encoding="utf-8")


def main():
    build = pathlib.Path(sys.argv[1]).resolve()
    if os.environ.get("BRDFFIT_DOCS") != "1":  # once more, with that environment
        os.execve(sys.executable, [sys.executable, __file__, str(build)], {**environment(build), "BRDFFIT_DOCS": "1"})
    docs = build / "docs"
    shutil.rmtree(docs / "tmp", ignore_errors=True)
    (docs / "tmp").mkdir(parents=True)
    source, html = docs / "source", docs / "html"
    stage(source, build)
    import check_site
    import figures

    profile = docs / "ipython" / "profile_default"
    profile.mkdir(parents=True, exist_ok=True)
    # The kernel would warn that it listens to this machine without encryption.
    (profile / "ipython_kernel_config.py").write_text("c.IPKernelApp.log_level = 'ERROR'\n", encoding="utf-8")
    figures.draw(source / "figures")
    example(source / "extra")
    shutil.rmtree(html, ignore_errors=True)
    done = subprocess.run([sys.executable, "-m", "sphinx", "-q", "-b", "html", "-W", "--keep-going", "-n", "-E", "-d",
                           str(docs / "doctrees"), str(source), str(html)])
    if done.returncode != 0:
        return done.returncode
    return check_site.check(html, ROOT / "docs")


if __name__ == "__main__":
    sys.exit(main())
