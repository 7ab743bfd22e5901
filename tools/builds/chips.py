"""Builds C++ for the chips of ESP boards with Debian's compilers, and says how large it is.

Knows each chip's compiler, linker and emulator, and that no C library is needed:
`vm_arduino/extras/qemu` has the functions that the compilers call. `tests/machines/qemu.py` runs
the results.
"""

from __future__ import annotations

import shutil
import subprocess
import tempfile
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import NamedTuple

from tools import ROOT

SOURCES = ROOT / "vm_arduino"

COMMON_FLAGS = (
    "-std=c++11", "-Os", "-fno-exceptions", "-fno-rtti", "-ffunction-sections", "-fdata-sections",
    "-fno-asynchronous-unwind-tables",
)  # fmt: skip


class Chip(NamedTuple):
    """`compiler` makes objects, or assembly text for `assembler`."""

    board: str
    compiler: tuple[str, ...]
    assembler: tuple[str, ...]
    linker: tuple[str, ...]
    measurer: str
    emulator: tuple[str, ...]
    ram_start: int  # start of RAM in the emulator
    start_file: str  # file with the start code, in `vm_arduino/extras/qemu`


# The features of the LX6 of an ESP32: clang has no single name for them. QEMU's de233_fpu has no
# `mul32high`, so that is left out.
_LX6 = (
    "bool", "clamps", "coprocessor", "dcache", "debug", "density", "exception", "fp",
    "highpriinterrupts-level7", "interrupt", "loop", "mac16", "minmax", "miscsr", "mul16", "mul32",
    "nsa", "prid", "regprotect", "rvector", "s32c1i", "sext", "threadptr", "timers3", "windowed",
    "div32",
)  # fmt: skip
_CLANG = ("clang-22", "--target=xtensa-none-elf")
_SIM = ("qemu-system-xtensa", "-M", "sim", "-semihosting")
_XTENSA_LD = ("xtensa-lx106-elf-ld", "--no-relax")

CHIPS = {
    "lx6": Chip(
        board="ESP32: Xtensa LX6 with register windows",
        compiler=(
            *_CLANG, "-nostdlibinc", "-fno-builtin", "-S",
            *(word for name in _LX6
              for word in ("-Xclang", "-target-feature", "-Xclang", f"+{name}")),
        ),
        # In a single step, clang places literals out of reach.
        assembler=(
            *_CLANG, "-c",
            *(word for name in _LX6
              for word in ("-Xclangas", "-target-feature", "-Xclangas", f"+{name}")),
        ),
        linker=_XTENSA_LD,
        measurer="xtensa-lx106-elf-size",
        emulator=(*_SIM, "-cpu", "de233_fpu"),
        ram_start=0x2000,
        start_file="xtensa.S",
    ),
    "lx106": Chip(
        board="ESP8266: Xtensa lx106 without register windows",
        compiler=("xtensa-lx106-elf-gcc", "-mlongcalls", "-mtext-section-literals",
                  "-ffreestanding", "-c"),
        assembler=(),
        linker=_XTENSA_LD,
        measurer="xtensa-lx106-elf-size",
        emulator=(*_SIM, "-cpu", "lx106"),
        ram_start=0x60000000,
        start_file="xtensa.S",
    ),
    "rv32imc": Chip(
        board="ESP32-C3: RISC-V rv32imc",
        compiler=("riscv64-unknown-elf-gcc", "-march=rv32imc", "-mabi=ilp32", "-ffreestanding",
                  "-c"),
        assembler=(),
        linker=("riscv64-unknown-elf-ld", "-m", "elf32lriscv"),
        measurer="riscv64-unknown-elf-size",
        emulator=("qemu-system-riscv32", "-M", "virt", "-bios", "none",
                  "-semihosting-config", "enable=on,target=native"),
        ram_start=0x80000000,
        start_file="riscv.S",
    ),
}  # fmt: skip


def missing_reason(chip: Chip, can_run: bool = False) -> str:
    """Return the reason why building for a chip, or running on it, is impossible, or ""."""
    tools = [chip.compiler, chip.assembler, chip.linker, (chip.measurer,)]
    if can_run:
        tools.append(chip.emulator)
    names = dict.fromkeys(words[0] for words in tools if words)
    missing_names = [name for name in names if not shutil.which(name)]
    return (
        f"no {' and no '.join(missing_names)} on this computer: no {chip.board}"
        if missing_names
        else ""
    )


def build(
    chip: Chip, source_paths: Iterable[Path], program: Path, *flags: str, entry: str = "_start"
) -> None:
    """Compile and link files into one program for the emulator."""
    with tempfile.TemporaryDirectory() as folder:
        objects: list[str] = []
        for path in source_paths:
            objects.append(str(Path(folder) / f"{len(objects)}.o"))
            compile_one(chip, path, objects[-1], flags)
        _command([
            *chip.linker, "--gc-sections", "--no-warn-rwx-segments", "-z", "noexecstack",
            f"--entry={entry}", f"--defsym=RAM={chip.ram_start:#x}",
            "-T", str(SOURCES / "extras" / "qemu" / "chip.ld"), *objects, "-o", str(program),
        ])  # fmt: skip


def measure_size(chip: Chip, probe: str, *modules: str) -> tuple[int, int]:
    """Return flash and RAM of a C++ program with a `main`, linked with the parts of the machine
    that it uses.

    The program includes from `vm_arduino/src`, and may use these folders there too. Flash is text
    and data, RAM is data and bss.
    """
    with tempfile.TemporaryDirectory() as folder:
        source, program = Path(folder) / "probe.cpp", Path(folder) / "probe"
        source.write_text(probe, encoding="utf-8")
        module_sources = [path for module in ("vm", *modules)
                          for path in sorted((SOURCES / "src" / module).glob("*.cpp"))]  # fmt: skip
        source_paths = [source, *module_sources, SOURCES / "extras" / "qemu" / "library.cpp"]
        build(chip, source_paths, program, f"-I{SOURCES / 'src'}", entry="main")
        row = _command([chip.measurer, str(program)]).splitlines()[1]
    text, data, bss = (int(word) for word in row.split()[:3])
    return text + data, data + bss


def compile_one(chip: Chip, path: Path, object_file: str, flags: Sequence[str]) -> None:
    """Make an object of one file."""
    flags_for_cpp = (*COMMON_FLAGS, *flags) if path.suffix == ".cpp" else ()
    if not chip.assembler:
        _command([*chip.compiler, *flags_for_cpp, str(path), "-o", object_file])
        return
    assembly_file = f"{object_file}.s"
    if path.suffix == ".cpp":
        _command([*chip.compiler, *flags_for_cpp, str(path), "-o", assembly_file])
    else:
        _command(
            [chip.compiler[0], "-E", "-x", "assembler-with-cpp", str(path), "-o", assembly_file]
        )
    _command([*chip.assembler, assembly_file, "-o", object_file])


def _command(words: Sequence[str]) -> str:
    result = subprocess.run(words, capture_output=True, text=True, check=False)
    assert result.returncode == 0, f"{words[0]} refuses the C++ machine:\n{result.stderr[:4000]}"
    return result.stdout
