#!/usr/bin/env python3
"""
Build the example firmware for each processor, run it under QEMU, and compare its bits with this computer's.

    run.py [TARGET...] [--build DIR] [--table] [--list]

Prints flash, static memory, workspace, stack and instructions of each, and fails where bits differ or a number is above
its line in budgets.txt. Targets whose compiler or emulator is missing are skipped, and said to be, unless they are named;
tools/setup/cross.sh installs them. SPDX-License-Identifier: MIT
"""
import argparse
import pathlib
import re
import shutil
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
SOURCES = [HERE / "firmware.c", HERE / "goniometer.c"]
PARTS = ["--distributions", "beckmann,ggx", "--lobes", "2", "--without", "anisotropic,fresnel,diffuse,masking"]
WORKSPACE = 128 * 1024
FLAGS = ["-std=gnu11", "-Os", "-ffunction-sections", "-fdata-sections", "-w", f"-DWORKSPACE={WORKSPACE}"]

ARM = ["arm-none-eabi-gcc", "-mthumb", "--specs=nosys.specs"]
RISCV = ["riscv64-unknown-elf-gcc", "--specs=picolibc.specs"]
# Compiler, where code and data lie, entry, emulator.
TARGETS = {
    "cortex-m3": ([*ARM, "-mcpu=cortex-m3"], 0x0, 0x20000000, "start", ["qemu-system-arm", "-M", "mps2-an385"]),
    "cortex-m4f": ([*ARM, "-mcpu=cortex-m4", "-mfpu=fpv4-sp-d16", "-mfloat-abi=hard"], 0x0, 0x20000000, "start",
                   ["qemu-system-arm", "-M", "mps2-an386"]),
    "cortex-m7": ([*ARM, "-mcpu=cortex-m7", "-mfpu=fpv5-d16", "-mfloat-abi=hard"], 0x0, 0x20000000, "start",
                  ["qemu-system-arm", "-M", "mps2-an500"]),
    "rv32imac": ([*RISCV, "-march=rv32imac", "-mabi=ilp32"], 0x80000000, 0x80200000, "_start",
                 ["qemu-system-riscv32", "-M", "virt", "-bios", "none"]),
    "rv32gc": ([*RISCV, "-march=rv32gc", "-mabi=ilp32d"], 0x80000000, 0x80200000, "_start",
               ["qemu-system-riscv32", "-M", "virt", "-bios", "none"]),
}
QUANTITIES = ["flash", "static", "1-lobe workspace", "2-lobe workspace", "stack", "1-lobe instructions", "2-lobe instructions"]


def run(command, **more):
    return subprocess.run([str(word) for word in command], check=True, capture_output=True, text=True, **more)


def host(build, scratch):
    """What the example prints here, with the library itself."""
    program = scratch / "host"
    run(["cc", *FLAGS, f"-I{ROOT / 'include'}", f"-I{HERE}", *SOURCES, HERE / "host.c", build / "libbrdffit.a", "-lm",
         "-o", program])
    return run([program]).stdout


def results(output):
    return [line for line in output.splitlines() if not line.startswith("#")]


def measured(output):
    """The numbers of a run: name to value."""
    return {match[1]: int(match[2]) for match in re.finditer(r"^# (.+) (\d+)$", output, re.M)}


def missing(target):
    compiler, *_, emulator = TARGETS[target]
    return [words[0] for words in (compiler, emulator) if shutil.which(words[0]) is None]


def build_for(target, scratch):
    compiler, code, data, entry, _ = TARGETS[target]
    script = scratch / f"{target}.ld"
    text = (HERE / "bare.ld").read_text()
    script.write_text(text.replace("@ROM@", hex(code)).replace("@RAM@", hex(data)).replace("@ENTRY@", entry))
    program = scratch / f"{target}.elf"
    run([*compiler, *FLAGS, "-nostartfiles", f"-I{scratch}", f"-I{HERE}", f"-T{script}", "-Wl,--gc-sections", *SOURCES,
         HERE / "bare.c", scratch / "brdffit.c", "-lm", "-o", program])
    return program


def sizes(program):
    """Flash: code, constants and initial data. Static: data that is not the workspace or the stack."""
    sections = dict(re.findall(r"^(\.\w+)\s+(\d+)", run(["size", "-A", program]).stdout, re.M))
    size = {name: int(sections.get(name, 0)) for name in (".text", ".data", ".bss")}
    return {"flash": size[".text"] + size[".data"], "static": size[".data"] + size[".bss"] - WORKSPACE}


def emulate(target, program):
    command = [*TARGETS[target][-1], "-display", "none", "-monitor", "none", "-serial", "none", "-icount", "shift=0",
               "-semihosting-config", "enable=on,target=native", "-kernel", program]
    done = subprocess.run([str(word) for word in command], stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=600)
    if done.returncode:
        sys.exit(f"{target}: the firmware ends with {done.returncode}: {(done.stdout + done.stderr)[-300:]}")
    return done.stdout + done.stderr


def budgets():
    found = {}
    for line in (HERE / "budgets.txt").read_text().splitlines():
        if line.strip() and not line.startswith("#"):
            target, quantity, most = re.fullmatch(r"(\S+)\s+(.+?)\s+([\d,]+)", line).groups()
            found[target, quantity] = int(most.replace(",", ""))
    return found


def check(target, expected, scratch, limits):
    """The numbers of a target, and what is wrong with it."""
    program = build_for(target, scratch)
    output = emulate(target, program)
    numbers = {**sizes(program), **measured(output)}
    problems = [] if results(output) == results(expected) else [f"{target}: other bits than here"]
    for quantity in QUANTITIES:
        most = limits.get((target, quantity))
        if most is None:
            problems.append(f"{target}: no budget for {quantity} ({numbers[quantity]:,})")
        elif numbers[quantity] > most:
            problems.append(f"{target}: {quantity} {numbers[quantity]:,}, above its budget of {most:,}")
    return numbers, problems


def main():
    parser = argparse.ArgumentParser(description=__doc__.strip().splitlines()[0])
    parser.add_argument("targets", nargs="*", metavar="TARGET", help=f"of {', '.join(TARGETS)} (default: all that can be run)")
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build", metavar="DIR", help="where libbrdffit.a is")
    options = parser.parse_args()
    scratch = options.build / "firmware"
    scratch.mkdir(parents=True, exist_ok=True)
    run([sys.executable, ROOT / "tools/amalgamate/amalgamate.py", *PARTS, "-o", scratch, "--cc", "none"])
    expected, limits, problems = host(options.build, scratch), budgets(), []
    print(f"{'target':12}" + "".join(f"{quantity:>21}" for quantity in QUANTITIES))
    for target in options.targets or TARGETS:
        if target not in TARGETS:
            sys.exit(f"run.py: no target '{target}'; there are {', '.join(TARGETS)}")
        if missing(target):
            problems += [f"{target}: no {name}" for name in missing(target) if options.targets]
            print(f"{target:12} skipped: no {' and no '.join(missing(target))}")
            continue
        numbers, wrong = check(target, expected, scratch, limits)
        problems += wrong
        print(f"{target:12}" + "".join(f"{numbers[quantity]:21,}" for quantity in QUANTITIES), flush=True)
    if problems:
        sys.exit("\n".join(problems))


if __name__ == "__main__":
    main()
