"""`program-help`: what a program of the build tree says to --help. SPDX-License-Identifier: MIT"""
import os
import re
import subprocess
import sys

from docutils import nodes
from docutils.parsers.rst import Directive


class ProgramHelp(Directive):
    required_arguments = 1
    final_argument_whitespace = True

    def run(self):
        program, *command = self.arguments[0].split()
        folder = self.state.document.settings.env.config.brdffit_build
        program = sys.executable if program == "python" else folder / program
        done = subprocess.run([program, *command, "--help"], capture_output=True, text=True, env={**os.environ, "COLUMNS": "80"})
        if done.returncode != 0:
            raise self.error("%s --help: exit status %d: %s" % (self.arguments[0], done.returncode, done.stderr))
        return [nodes.literal_block(done.stdout, done.stdout, language="text")]


def commands(program):
    """The names of its subcommands, as its help lists them, but for what another package brings."""
    text = subprocess.run([program, "--help"], capture_output=True, text=True, check=True).stdout
    return [name for name in re.findall(r"^  ([a-z]+) +\S", text, re.M) if name not in ("report", "export")]


def setup(app):
    app.add_config_value("brdffit_build", None, "env")
    app.add_directive("program-help", ProgramHelp)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
