"""Every structure lies in memory as the C header says. SPDX-License-Identifier: MIT"""
import ctypes
import os
import re
import shlex
import subprocess

import pytest

from brdffit import _ffi, _structs
from places import ROOT


def header():
    return (ROOT / "include" / "brdffit.h").read_text() + (ROOT / "include" / "brdffit_io.h").read_text()


def test_layout(tmp_path):
    compiler = shlex.split(os.environ.get("CC", "cc"))
    lines = []
    for name, structure in _structs.C_NAMES.items():
        lines.append('printf("%s %%zu\\n", sizeof(%s));' % (name, name))
        for field, _ in structure._fields_:
            lines.append('printf("%s.%s %%zu %%zu\\n", offsetof(%s, %s), sizeof(((%s *)0)->%s));' % (
                name, field, name, field, name, field))
    (tmp_path / "layout.c").write_text("#include <stdio.h>\n#include <brdffit_io.h>\nint main(void)\n{\n%s\nreturn 0;\n}\n"
                                       % "\n".join(lines))
    subprocess.run([*compiler, "-I", str(ROOT / "include"), "-o", "layout", "layout.c"], cwd=tmp_path, check=True)
    theirs = subprocess.run([tmp_path / "layout"], stdout=subprocess.PIPE, text=True, check=True).stdout.splitlines()
    ours = []
    for name, structure in _structs.C_NAMES.items():
        ours.append("%s %d" % (name, ctypes.sizeof(structure)))
        for field, _ in structure._fields_:
            place = getattr(structure, field)
            ours.append("%s.%s %d %d" % (name, field, place.offset, place.size))
    assert ours == theirs


@pytest.mark.parametrize("name", sorted(_structs.C_NAMES))
def test_no_field_is_forgotten(name):
    body = re.search(r"typedef struct %s \{(.*?)\n\} %s;" % (name, name), re.sub(r"/\*.*?\*/", "", header(), flags=re.S), re.S)
    fields = []
    for declaration in body.group(1).split(";"):
        for part in declaration.split(","):
            word = re.search(r"(\w+)\s*(\[[^]]*\])*\s*$", part.strip())
            if word:
                fields.append(word.group(1))
    assert fields == [field for field, _ in _structs.C_NAMES[name]._fields_]


def test_enumerations():
    core, io = _ffi.library().core, _ffi.library().io
    for names, function in ((_structs.DISTRIBUTION, core.brdffit_distribution_string), (_structs.NORM, core.brdffit_norm_string),
                            (_structs.ENGINE, core.brdffit_engine_string), (_structs.ISA, core.brdffit_isa_string),
                            (_structs.STOP, core.brdffit_stop_string), (_structs.SKIP, core.brdffit_skip_string),
                            (_structs.TEXEL_STATUS, core.brdffit_texel_status_string), (_structs.DROP, io.brdffit_io_drop_string)):
        assert tuple(function(i).decode() for i in range(len(names))) == names
    text = re.sub(r"/\*.*?\*/", "", header(), flags=re.S)
    for prefix, names in (("STATUS", _structs.STATUS), ("STOP", _structs.STOP), ("DISTRIBUTION", _structs.DISTRIBUTION),
                          ("NORM", _structs.NORM), ("ENGINE", _structs.ENGINE), ("ISA", _structs.ISA),
                          ("SKIP", _structs.SKIP), ("TYPE", _structs.TYPE), ("TEXEL_STATUS", _structs.TEXEL_STATUS),
                          ("IO_DROP", _structs.DROP)):
        block = re.search(r"\{([^{}]*)BRDFFIT_%s_COUNT" % prefix, text).group(1)
        assert len(re.findall(r"BRDFFIT_\w+", block)) == len(names), prefix


def test_the_environment_names_the_library(tmp_path, monkeypatch):
    monkeypatch.setenv(_ffi.ENVIRONMENT, str(tmp_path / "absent.so"))
    with pytest.raises(_ffi.LibraryError, match="absent.so"):
        _ffi.Library(_ffi.find())


@pytest.mark.parametrize("source, words", [
    ("const char *brdffit_version(void) { return \"0.2.0\"; }", "has no brdffit_|no file readers"),
])
def test_a_foreign_library_is_refused(tmp_path, source, words):
    (tmp_path / "other.c").write_text(source)
    subprocess.run([*shlex.split(os.environ.get("CC", "cc")), "-shared", "-fPIC", "-o", "other.so", "other.c"], cwd=tmp_path,
                   check=True)
    with pytest.raises(_ffi.LibraryError, match=words):
        _ffi.Library(str(tmp_path / "other.so"))


def test_another_version_is_refused(monkeypatch):
    path = _ffi.library().path
    monkeypatch.setattr(_ffi, "__version__", "7.3.0")
    with pytest.raises(_ffi.LibraryError, match="needs 7.3.0"):
        _ffi.Library(path)


def test_structures_of_other_sizes(monkeypatch):
    """Of a later version: accepted as long as it asks for nothing that is unknown here."""
    class Longer(ctypes.Structure):
        _fields_ = [*_structs.Options._fields_, ("more", ctypes.c_double)]

    monkeypatch.setattr(_structs, "Options", Longer)
    core, options = _ffi.library().core, _ffi.library().options()
    known = ctypes.cast(ctypes.byref(options), core.brdffit_workspace_size.argtypes[2])
    assert options.struct_size == ctypes.sizeof(Longer) and options.more == 0
    assert core.brdffit_workspace_size(10, 1, known) > 0
    options.more = 1.5
    assert core.brdffit_workspace_size(10, 1, known) == 0
