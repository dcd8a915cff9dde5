"""brdffit as a process: streams, files, signals, several files at once.

SPDX-License-Identifier: MIT
"""
import os
import pathlib
import pty
import resource
import shutil
import signal
import stat
import subprocess
import tempfile
import time

import pytest

import harness

# More than a pipe holds: once all of it is written, the reader is at work and its signal handlers are in place.
PREAMBLE = b"# " + b"x" * 1000 + b"\n"
PREAMBLE *= 400


def start(*arguments, cwd, **more):
    more = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "env": harness.environment(), **more}
    return subprocess.Popen([harness.BRDFFIT, *arguments], cwd=cwd, **more)


def reading(process):
    process.stdin.write(PREAMBLE)
    process.stdin.flush()


# ---- Several files ---------------------------------------------------------------------------------------------------


def test_batch_keeps_order_and_goes_on(desk):
    names = ["matte.csv", "infinite.csv", "two_lobe_table.binary", "missing.csv", "single.csv", "lying.binary",
             "ggx_metal.csv", ".", "two_lobe_satin.csv", "truncated.csv.gz", "mis.csv"]
    bad = {"infinite.csv", "missing.csv", "lying.binary", ".", "truncated.csv.gz"}
    lines = harness.fit(*names, "--lobes", "2", cwd=desk, expect=1)
    assert [line["file"] for line in lines] == names
    assert {line["file"] for line in lines if line["status"] == "error"} == bad
    for line in lines:
        if line["status"] != "error":
            (alone,) = harness.fit(line["file"], "--lobes", "2", cwd=desk)
            assert dict(alone, seconds=0) == dict(line, seconds=0)


@pytest.mark.parametrize("names, code", [
    (["single.csv"], 0), (["single.csv", "infinite.csv"], 3), (["missing.csv", "infinite.csv"], 1), (["infinite.csv",
        "missing.csv"], 1),
    (["single.csv", "mis.csv"], 4), (["mis.csv", "infinite.csv"], 3), (["mis.csv", "missing.csv", "infinite.csv"], 1),
])
def test_the_worst_exit_code_wins(desk, names, code):
    done = harness.run("fit", "--lobes", "2", "--box-budget", "1", *names, cwd=desk)
    assert done.returncode == code


def test_the_summary_counts(desk):
    done = harness.run("fit", "--lobes", "2", "--box-budget", "1", "single.csv", "mis.csv", "infinite.csv", cwd=desk)
    assert done.stderr.splitlines()[-1] == "brdffit: 3 files: 1 certified, 1 open, 1 failed (infinite.csv)"


# ---- Streams ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["two_lobe_satin.csv", "two_lobe_table.binary"])
def test_standard_input(desk, name):
    (piped,) = harness.fit("-", cwd=desk, stdin=(desk / name).read_bytes())
    (direct,) = harness.fit(name, cwd=desk)
    assert piped["file"] == "-"
    assert dict(piped, file=name, seconds=0) == dict(direct, seconds=0)


def test_closed_standard_input(desk):
    done = subprocess.run('"%s" fit - <&-' % harness.BRDFFIT, shell=True, cwd=desk, capture_output=True, timeout=harness.PATIENCE)
    assert done.returncode == 1 and b"standard input" in done.stderr and done.stdout == b""


@pytest.mark.parametrize("command", ["fit matte.csv", "fit --json matte.csv mis.csv", "info matte.csv", "--help", "fit --help",
                                     "--version", "eval fits.json matte.csv"])
def test_output_that_cannot_be_written(desk, command):
    (desk / "fits.json").write_text(harness.run("fit", "--json", "matte.csv", cwd=desk).stdout)

    def run(tail):
        return subprocess.run('"%s" %s %s' % (harness.BRDFFIT, command, tail), shell=True, cwd=desk,
                              stderr=subprocess.PIPE, timeout=harness.PATIENCE)

    before = sorted(os.listdir(desk))
    closed = run(">&-")
    assert closed.returncode == 1
    full = run(">/dev/full")
    assert full.returncode == 1 and b"No space left" in full.stderr
    assert sorted(os.listdir(desk)) == before


def test_reader_that_went_away(desk):
    """Quietly: `brdffit fit ... | head` is nobody's fault."""
    for command in (["fit", "--json", "--quiet", "matte.csv", "mis.csv"], ["info", "matte.csv"], ["--help"]):
        read, write = os.pipe()
        os.close(read)
        done = subprocess.run([harness.BRDFFIT, *command], cwd=desk, stdout=write, stderr=subprocess.PIPE,
                              timeout=harness.PATIENCE)
        os.close(write)
        assert (done.returncode, done.stderr) == (1, b"")


def test_quiet_json_still_speaks(desk):
    done = harness.run("fit", "-q", "--json", "matte.csv", "single.csv", cwd=desk)
    assert len(harness.lines(done.stdout)) == 2 and done.stderr == ""


def test_lines_fit_the_screen(desk):
    done = harness.run("fit", "--lobes", "2", *sorted(os.listdir(desk)), cwd=desk)
    told = harness.run("info", *sorted(os.listdir(desk)), cwd=desk)
    for line in (done.stdout + told.stdout).splitlines():
        assert len(line) <= 79, line


def test_ascii_is_ascii(desk):
    for env in ({"LC_ALL": "C"}, {"LC_ALL": "POSIX"}, {"LC_ALL": "de_DE.ISO-8859-1"}, {"LC_ALL": None, "LANG": None}):
        done = harness.run("fit", "--lobes", "2", "mis.csv", "infinite.csv", cwd=desk, env=harness.environment(**env))
        assert (done.stdout + done.stderr).isascii() and "sigma" in done.stdout
    for env in ({"LC_ALL": "en_GB.UTF-8"}, {"LC_ALL": "", "LANG": "xx_XX.utf8"}):
        assert "σ" in harness.run("fit", "mis.csv", cwd=desk, env=harness.environment(**env)).stdout


def on_terminal(arguments, cwd, env):
    """Everything that a program shows on a terminal."""
    master, slave = pty.openpty()
    process = subprocess.Popen([harness.BRDFFIT, *arguments], cwd=cwd, env=env, stdin=subprocess.DEVNULL, stdout=slave,
                               stderr=slave)
    os.close(slave)
    shown = b""
    while True:
        try:
            block = os.read(master, 65536)
        except OSError:
            break
        if not block:
            break
        shown += block
    os.close(master)
    process.wait(harness.PATIENCE)
    return shown.decode()


def test_colour_only_where_wanted(desk):
    env = harness.environment(TERM="xterm")
    assert "\x1b[32mProven:" in on_terminal(["fit", "matte.csv"], desk, env)
    assert "\x1b[33mNOT proven:" in on_terminal(["fit", "--lobes", "2", "--box-budget", "1", "mis.csv"], desk, env)
    for plain in (dict(env, NO_COLOR="1"), dict(env, TERM="dumb"), harness.environment()):
        assert "\x1b[3" not in on_terminal(["fit", "matte.csv"], desk, plain)
    assert "\x1b[3" in on_terminal(["fit", "matte.csv"], desk, dict(env, NO_COLOR=""))
    assert "\x1b" not in on_terminal(["fit", "--json", "matte.csv"], desk, env)
    assert "\x1b" not in harness.run("fit", "matte.csv", cwd=desk, env=env).stdout


def test_progress_only_on_a_terminal(desk):
    """Nothing for a moment's work; after that which file of how many, the rate, and the line is cleared again."""
    for quiet in ([], ["--quiet"]):
        master, slave = pty.openpty()
        process = start("fit", "-", "two_lobe_satin.csv", "matte.csv", *quiet, cwd=desk, stderr=slave, stdout=subprocess.DEVNULL)
        os.close(slave)
        time.sleep(0.5)  # a line is drawn only when the last was drawn a fifth of a second ago
        process.stdin.write((desk / "mis.csv").read_bytes())
        process.stdin.close()
        assert process.wait(harness.PATIENCE) == 0
        try:
            shown = os.read(master, 65536)
        except OSError:
            shown = b""
        os.close(master)
        if quiet:
            assert shown == b""
        else:
            assert b"\rfile 2 of 3, " in shown and b"two_lobe_satin.csv" in shown
            assert b" files/s, " in shown and b" s left" in shown
            assert b"\r\x1b[K" in shown and shown.endswith(b"3 files: 3 certified, 0 open, 0 failed\r\n")
    done = harness.run("fit", "mis.csv", "matte.csv", cwd=desk)
    assert "file 2" not in done.stderr


# ---- Files -----------------------------------------------------------------------------------------------------------


def leftovers(folder):
    return [name for name in os.listdir(folder) if "tmp" in name or name.startswith(".")]


@pytest.mark.parametrize("command", ["fit --json matte.csv mis.csv", "fit matte.csv", "info matte.csv", "info --json matte.csv",
                                     "eval fits.json matte.csv"])
def test_output_file(desk, command):
    (desk / "fits.json").write_text(harness.run("fit", "--json", "matte.csv", cwd=desk).stdout)
    plain = harness.run(*command.split(), cwd=desk)
    done = harness.run(*command.split(), "--output", "out", cwd=desk)
    assert (done.returncode, done.stdout, done.stderr) == (plain.returncode, "", plain.stderr)
    if "fit " not in command:
        assert (desk / "out").read_text() == plain.stdout
    assert len((desk / "out").read_text()) > 100
    assert leftovers(desk) == []
    to_stdout = harness.run(*command.split(), "-o", "-", cwd=desk)
    assert len(to_stdout.stdout) > 100


def test_output_file_holds_errors_too(desk):
    done = harness.run("fit", "--json", "-o", "out", "infinite.csv", "matte.csv", cwd=desk)
    assert done.returncode == 3
    assert [line["status"] for line in harness.lines((desk / "out").read_text())] == ["error", "certified"]


def test_output_follows_links_and_keeps_modes(desk):
    target = desk / "target"
    target.write_text("old")
    target.chmod(0o640)
    (desk / "link").symlink_to("target")
    assert harness.run("info", "matte.csv", "-o", "link", cwd=desk).returncode == 0
    assert (desk / "link").is_symlink() and "matte.csv" in target.read_text()
    assert stat.S_IMODE(target.stat().st_mode) == 0o640
    done = subprocess.run("umask 027; exec '%s' info matte.csv -o new" % harness.BRDFFIT, shell=True, cwd=desk)
    assert done.returncode == 0
    assert stat.S_IMODE((desk / "new").stat().st_mode) == 0o640


def test_output_to_what_is_no_file(desk):
    os.mkfifo(desk / "pipe")
    process = start("info", "matte.csv", "-o", "pipe", cwd=desk)
    text = (desk / "pipe").read_text()
    assert process.wait(harness.PATIENCE) == 0
    assert "matte.csv" in text and stat.S_ISFIFO((desk / "pipe").stat().st_mode)
    assert harness.run("info", "matte.csv", "-o", "/dev/null", cwd=desk).returncode == 0
    assert stat.S_ISCHR(os.stat("/dev/null").st_mode)
    (desk / "folder").mkdir()
    done = harness.run("info", "matte.csv", "-o", "folder", cwd=desk)
    assert done.returncode == 1 and "folder" in done.stderr


@pytest.mark.parametrize("name", ["matte.csv", "./matte.csv", "link", "hard"])
def test_output_never_replaces_input(desk, name):
    (desk / "link").symlink_to("matte.csv")
    os.link(desk / "matte.csv", desk / "hard")
    before = (desk / "matte.csv").read_bytes()
    (desk / "fits.json").write_text(harness.run("fit", "--json", "matte.csv", cwd=desk).stdout)
    for command in (["fit", "mis.csv", "matte.csv"], ["info", "matte.csv"], ["eval", "fits.json", "matte.csv"]):
        done = harness.run(*command, "-o", name, cwd=desk)
        assert done.returncode == 2 and "--output" in done.stderr
        assert (desk / "matte.csv").read_bytes() == before


def test_output_that_does_not_fit(desk):
    """The file system refuses half-way: the old file stays, nothing is left behind."""
    (desk / "fits.json").write_text(harness.run("fit", "--json", "two_lobe_table.binary", cwd=desk).stdout)
    (desk / "out").write_text("old")

    def limit():
        resource.setrlimit(resource.RLIMIT_FSIZE, (100000, 100000))

    done = harness.run("eval", "fits.json", "two_lobe_table.binary", "-o", "out", cwd=desk, preexec_fn=limit)
    assert done.returncode == 1 and "out" in done.stderr
    assert (desk / "out").read_text() == "old" and leftovers(desk) == []


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP, signal.SIGKILL])
def test_killed_before_the_end(desk, number):
    (desk / "out").write_text("old")
    process = start("fit", "--json", "-o", "out", "matte.csv", "-", cwd=desk)
    reading(process)
    process.send_signal(number)
    assert process.wait(harness.PATIENCE) == -number
    assert (desk / "out").read_text() == "old"
    assert number == signal.SIGKILL or leftovers(desk) == []
    process.communicate()


def test_read_errors(desk):
    """A file that opens and then fails to be read; one that may not be opened."""
    if os.path.exists("/proc/self/mem"):
        done = harness.run("fit", "/proc/self/mem", cwd=desk)
        assert done.returncode == 1 and done.stdout == ""
    with tempfile.TemporaryDirectory() as folder:
        os.chmod(folder, 0o755)
        program = shutil.copy(harness.BRDFFIT, folder)
        secret = shutil.copy(desk / "matte.csv", folder)
        os.chmod(secret, 0)
        user = {"user": 65534} if os.geteuid() == 0 else {}
        done = harness.run("fit", "matte.csv", program=program, cwd=folder, **user)
        assert done.returncode == 1 and "matte.csv" in done.stderr and done.stdout == ""
        done = harness.run("fit", "--json", "-o", "out", "-", program=program, cwd=folder,
                           stdin=(desk / "mis.csv").read_bytes(), **user)
        assert os.geteuid() != 0 or (done.returncode == 1 and sorted(os.listdir(folder)) == ["brdffit", "matte.csv"])


def test_no_memory(desk):
    """Too little memory for the workspace is told, not crashed on. Sanitizers need the memory for themselves."""
    if b"__asan_init" in harness.BRDFFIT.read_bytes():
        pytest.skip("a sanitizer build reserves memory of its own")

    def limit():
        resource.setrlimit(resource.RLIMIT_AS, (40 << 20, 40 << 20))

    done = harness.run("fit", "--json", "--lobes", "2", "--box-budget", "100000000", "mis.csv", cwd=desk, preexec_fn=limit)
    (line,) = harness.lines(done.stdout)
    if line["status"] == "error":
        assert done.returncode == 1 and line["error"]["code"] == "memory"
    else:
        assert done.returncode == 0  # the library's own caps kept it small


# ---- Signals ---------------------------------------------------------------------------------------------------------


def test_first_interrupt_reports(desk):
    """Interrupted while it reads: that fit stops at once, with an incumbent and a bound; the next files are not begun."""
    process = start("fit", "--json", "--lobes", "2", "--gap", "1e-9", "matte.csv", "-", "mis.csv", "single.csv", cwd=desk)
    reading(process)
    process.send_signal(signal.SIGINT)
    out, err = process.communicate((desk / "two_lobe_satin.csv").read_bytes(), harness.PATIENCE)
    done, stopped, *rest = harness.lines(out.decode())
    assert process.returncode == 4
    assert done["status"] in ("certified", "gap_open") and done["stop"] != "cancelled"
    assert (stopped["status"], stopped["stop"]) == ("gap_open", "cancelled")
    assert 0 <= stopped["lower_bound"] <= stopped["e2"] <= stopped["sum_of_squares"]
    assert [(line["file"], line["status"], line["error"]["code"]) for line in rest] == [
        ("mis.csv", "error", "interrupted"), ("single.csv", "error", "interrupted")]
    assert b"2 files were not begun" in err


def test_second_interrupt_ends(desk):
    (desk / "out").write_text("old")
    process = start("fit", "--json", "-o", "out", "-", cwd=desk)
    reading(process)
    process.send_signal(signal.SIGINT)
    status = pathlib.Path("/proc/%d/status" % process.pid)
    while b"ShdPnd:\t0000000000000000" not in status.read_bytes():
        pass  # the first one has to arrive before the second is sent: signals do not queue
    process.send_signal(signal.SIGINT)
    assert process.wait(harness.PATIENCE) == -signal.SIGINT
    assert (desk / "out").read_text() == "old" and leftovers(desk) == []
    process.communicate()


def test_ignored_interrupts_stay_ignored(desk):
    process = start("fit", "--json", "-", cwd=desk, preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_IGN))
    reading(process)
    process.send_signal(signal.SIGINT)
    out, _ = process.communicate((desk / "matte.csv").read_bytes(), harness.PATIENCE)
    assert process.returncode == 0 and harness.lines(out.decode())[0]["status"] == "certified"


# ---- Other programs --------------------------------------------------------------------------------------------------


def test_external_commands(tmp_path):
    script = tmp_path / "brdffit-hello"
    script.write_text('#!/bin/sh\necho "$@"; trap | grep PIPE; exit 7\n')
    script.chmod(0o755)
    env = harness.environment(PATH="%s:%s" % (tmp_path, os.environ["PATH"]))
    done = harness.run("hello", "--lobes", "a b", env=env)
    assert (done.returncode, done.stdout, done.stderr) == (7, "--lobes a b\n", "")
    assert harness.run("hell", env=env).returncode == 2
    script.chmod(0o644)
    assert harness.run("hello", env=env).returncode in (1, 2)
