"""Build hook: compiles the C library and puts it into the wheel, as brdffit/_lib/libbrdffit.so.

The environment's CC, CFLAGS, CPPFLAGS, LDFLAGS, ECOS, ECOS_DIR and THIRD_PARTY reach the Makefile as they do on the
command line. SPDX-License-Identifier: MIT
"""
import os
import pathlib
import shutil
import subprocess
import sys
import sysconfig
import tempfile

from hatchling.builders.hooks.plugin.interface import BuildHookInterface


class Hook(BuildHookInterface):
    def initialize(self, version, build_data):
        here = pathlib.Path(self.root)
        inside = here / "c"
        source = inside if inside.is_dir() else here.parent
        if source == inside:
            self._scratch = tempfile.mkdtemp(prefix="brdffit-")
            build = pathlib.Path(self._scratch)
        else:  # the objects stay in the tree: the next installation compiles what has changed
            self._scratch = None
            build = source / os.environ.get("BRDFFIT_PYTHON_BUILD", "build/python")
        library = self._make(source, build)
        build_data["pure_python"] = False
        build_data["tag"] = "py3-none-" + sysconfig.get_platform().replace("-", "_").replace(".", "_")
        if version == "editable":
            target = here / "src" / "brdffit" / "_lib" / library.name
            target.parent.mkdir(exist_ok=True)
            fresh = target.with_suffix(".new")
            shutil.copy2(library, fresh)
            fresh.replace(target)  # a program that has the old one loaded keeps it
        else:
            build_data["force_include"][str(library)] = "brdffit/_lib/" + library.name
            build_data["force_include"][str(source / "LICENSE")] = "brdffit/LICENSE"
            # The text that brdffit/export/shaders.py makes shaders of.
            build_data["force_include"][str(source / "include" / "brdffit_shade")] = "brdffit/_shade"

    def finalize(self, version, build_data, artifact_path):
        if self._scratch is not None:
            shutil.rmtree(self._scratch, ignore_errors=True)

    @staticmethod
    def _make(source, build):
        make = os.environ.get("MAKE") or shutil.which("gmake") or shutil.which("make")
        if make is None:
            raise SystemExit("brdffit: GNU make, a C compiler and zlib with headers are needed to build the library")
        third_party = pathlib.Path(os.environ.get("THIRD_PARTY") or (
            build / "third_party" if source.name == "c" else source / "build" / "third_party"))
        library = build / "whole" / "libbrdffit.so"
        # As somebody would write them who calls make in the tree: the Makefile remembers them, and compiles again when
        # they are spelled in another way.
        build, third_party, target = (path.relative_to(source) if path.is_relative_to(source) else path
                                      for path in (build, third_party, library))
        environment = {key: value for key, value in os.environ.items() if key not in ("MAKEFLAGS", "MFLAGS", "MAKELEVEL")}
        command = [make, "--no-print-directory", "-j%d" % min(8, os.cpu_count() or 1), "BUILD=%s" % build,
                   "THIRD_PARTY=%s" % third_party, "PYTHON=%s" % sys.executable, "PREFIX=/usr", str(target)]
        done = subprocess.run(command, cwd=source, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        if done.returncode != 0:
            sys.stderr.write(done.stdout.decode("utf-8", "replace"))
            raise SystemExit("brdffit: building the C library failed; its words are above")
        return library
