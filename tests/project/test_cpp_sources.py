"""The C++ sources keep the rules that no compiler knows."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from tests.machines import host
from tests.machines.host import SOURCES, WARNINGS, missing
from tests.support.cpp_sources import code_of
from tests.support.rows import each_row

EXTRAS = SOURCES / "extras"
MODULES = [SOURCES / "src" / name for name in ("vm", "link", "store", "text", "firmware")]
PORTABLE = sorted(
    [*(path for module in MODULES for path in module.glob("*.[ch]*")), SOURCES / "src" / "robot.h"]
)
TESTED_FOLDERS = ("host", "host_firmware", "chip", "qemu", "link", "powercut", "text")
FILES = [
    *PORTABLE,
    *sorted(path for name in TESTED_FOLDERS for path in (EXTRAS / name).glob("*.[ch]*")),
    *sorted((EXTRAS / "wasm").glob("*.cpp")),
    *sorted((EXTRAS / "library" / "src").glob("*.[ch]*")),
]
VM = SOURCES / "src" / "vm"
CHOOSING_HEADERS = {"build.h", "cpu.h", "layout_avr.h"}
AVR_HEADERS = {
    "cpu_avr.h",
    "reader_calls_avr.h",
    "receiver_avr.h",
    "link_avr.h",
}  # only its compiler uses these
ASSEMBLY_THAT_CHOOSES = {"bytecode_avr.S"}
CONDITION = re.compile(r"#\s*(if|ifdef|ifndef|elif|else|endif)\b")
HEADERS = sorted(path for part in ("src", "extras") for path in (SOURCES / part).rglob("*.h"))
BOARDS = sorted(
    path for folder in ("", "avr") for path in (SOURCES / "src/boards" / folder).glob("*.[ch]*")
)
STRICT_FLAGS = (
    "-std=c++11",
    "-pedantic",
    "-fno-exceptions",
    "-fno-rtti",
    *WARNINGS,
    "-fsyntax-only",
)
ALLOWED_HEADERS = {"<stdint.h>", "<stddef.h>", "<avr/pgmspace.h>"}
ARDUINO_MACROS = {"HIGH", "LOW", "OUTPUT"}  # defined by a header for sketches
CHIP_OF_THE_CORE = "ARDUINO_ARCH_ESP32"  # defined on the command line, as __AVR__ is for an AVR
FORBIDDEN_WORDS = ("virtual", "new", "delete", "throw", "try", "float", "double", "goto", "malloc",
                   "dynamic_cast", "typeid", "Arduino", "String")  # fmt: skip


def capital_names(path: Path) -> set[str]:
    """Return the names in capitals."""
    text = code_of(path)
    macro_names = set(re.findall(r"\b[A-Z][A-Z0-9_]*\b", text))
    arduinos = ARDUINO_MACROS if "#include <Arduino.h>" in text else set()
    return macro_names - {CHIP_OF_THE_CORE} - arduinos


@each_row("path", FILES)
def test_no_name_is_in_capitals(path: Path) -> None:
    """Arduino.h defines 1,480 macros in capitals: F, B0, INPUT. No name of ours may meet one."""
    assert not capital_names(path)


@each_row("path", PORTABLE)
def test_the_machine_does_not_depend_on_a_board(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    included_headers = re.findall(r"#include (<[^>]+>)", text)
    assert set(included_headers) <= ALLOWED_HEADERS
    words = set(re.findall(r"\w+", code_of(path)))
    assert not words & set(FORBIDDEN_WORDS)


@each_row("path", [path for path in PORTABLE if path.name not in CHOOSING_HEADERS])
def test_build_features_are_chosen_in_few_headers(path: Path) -> None:
    """In other files, a condition encloses the whole file, or chooses which file is included."""
    rows = [row.strip() for row in path.read_text(encoding="utf-8").splitlines() if row.strip()]
    rows = [row for row in rows if not row.startswith("//")]
    conditions = [k for k, row in enumerate(rows) if CONDITION.match(row)]
    if not conditions:
        return
    first_condition, last_condition = conditions[0], conditions[-1]
    inside = [row for row in rows[first_condition:last_condition] if not CONDITION.match(row)]
    if all(row.startswith("#include") for row in inside):
        return
    assert conditions == [first_condition, len(rows) - 1], [rows[k] for k in conditions]
    assert all(row.startswith("#include") for row in rows[:first_condition])


@each_row("path", sorted(VM.glob("*.S")))
def test_assembly_choices_are_in_the_files_named_by_build_h(path: Path) -> None:
    """In other files, a condition encloses the whole file, or is an assertion."""
    code = re.sub(r"#if [^#]*?#error[^\n]*\n#endif", "", code_of(path))
    code = re.sub(r"(?m)^#define.*\n|;.*", "", code)
    rows = [row.strip() for row in code.splitlines() if row.strip()]
    inner = [k for k, row in enumerate(rows) if CONDITION.match(row)]
    if path.name in ASSEMBLY_THAT_CHOOSES:
        assert f"`{path.name}`" in (VM / "build.h").read_text(encoding="utf-8")
        assert len(inner) > 2, "no more"
        return
    assert inner in ([], [inner[0], len(rows) - 1] if inner else []), [rows[k] for k in inner]
    assert all(row.startswith("#include") for row in rows[: inner[0] if inner else 0])


def first_comment(path: Path) -> str:
    """Return the comment that a file begins with, as one line."""
    rows = path.read_text(encoding="utf-8").splitlines()
    rows = rows[: next(k for k, row in enumerate(rows) if row[:1] != ";")]
    return " ".join(row.lstrip("; ") for row in rows)


ASSEMBLY_WITH_TWIN = [
    path
    for path in sorted((SOURCES / "src").rglob("*.S"))
    if "the same as `" in path.read_text(encoding="utf-8")
]


@each_row("path", ASSEMBLY_WITH_TWIN)
def test_assembly_functions_exist_in_the_named_cpp_files(path: Path) -> None:
    """Its first lines name the files for the other chips, and each function exists there."""
    comment = first_comment(path)
    (same,) = re.findall(r"[Mm]eans? the same as (.*?)[.] [A-Z`]", comment)
    twins = [path.parent / name for name in re.findall(r"`([\w/]+\.(?:cpp|h))`", same)]
    twins += [twin for row in twins if (twin := VM / row.name).exists()]
    code = "\n".join(code_of(twin) for twin in twins if twin.exists())
    defined_names = set(re.findall(r"\b(\w+)\([^;{}()]*\)(?: const)? \{", code))
    text = path.read_text(encoding="utf-8")
    mangled_names = re.findall(r"(?:\.global|^function) _ZNK?10tiniscript(\d\w+)", text, re.M)
    names = [names_in(symbol)[-1] for symbol in mangled_names]
    names += re.findall(r"^starts tiniscript_(\w+)", text, re.M)
    assert names and set(names) <= defined_names, {*names} - defined_names


# the loop and the arithmetic: a factor of four
ESSENTIAL_ASSEMBLY = {"execute_avr.S", "number_avr.S"}


@each_row("path", [path for path in ASSEMBLY_WITH_TWIN if path.name not in ESSENTIAL_ASSEMBLY])
def test_assembly_files_state_their_savings_and_removal_condition(path: Path) -> None:
    comment = first_comment(path)
    assert re.search(r"\d+ (bytes|cycles)", comment) and "lets it go" in comment


@each_row("path", BOARDS)
def test_no_board_code_blocks(path: Path) -> None:
    """The code does not ask the core for work done here by registers; the core defines only the
    clock."""
    waiting = {"delay", "delayMicroseconds", "pulseIn", "_delay_ms", "_delay_us", "Serial", "tone",
               "noTone", "analogRead", "analogWrite", "digitalWrite", "digitalRead", "pinMode",
               "attachInterrupt", "Servo", "new", "malloc"}  # fmt: skip
    assert not waiting & set(re.findall(r"\w+", code_of(path)))


@each_row("path", HEADERS)
def test_each_header_is_included_once(path: Path) -> None:
    assert code_of(path).split()[:2] == ["#pragma", "once"]


def names_in(mangled_text: str) -> list[str]:
    """Return the names in a name of the linker: `8Receiver5watchEh` has `Receiver` and `watch`."""
    names, position = [], 0
    while digits := re.match(r"\d+", mangled_text[position:]):
        position += len(digits[0]) + int(digits[0])
        names.append(mangled_text[position - int(digits[0]) : position])
    return names


def test_functions_placed_by_the_linker_exist_by_name() -> None:
    """Otherwise a renamed function would be placed anywhere, and its calls would take more
    flash."""
    code = "\n".join(map(code_of, sorted((SOURCES / "src").rglob("*.[chS]*"))))
    order = (SOURCES / "src" / "boards" / "avr" / "order.ld").read_text(encoding="utf-8")
    mangled_names = re.findall(r"\*\(\.text\._ZNK?10tiniscript(?:12_GLOBAL__N_1)?(\d\w+)", order)
    assert len(mangled_names) > 100
    for symbol in mangled_names:
        *outer, name = names_in(symbol)
        places = [code]
        if outer:
            kind = outer[0]
            class_start = rf"(?:class|struct) {kind}\b[^;{{]*\{{.*?\n\}};|\b{kind}::[^;]*?\("
            places = re.findall(class_start, code, re.DOTALL)
        assert any(re.search(rf"\b{name}\b", place) for place in places), symbol


@pytest.mark.skipif(bool(missing()), reason=missing() or "there is a compiler")
def test_each_header_compiles_alone_without_a_warning(tmp_path: Path) -> None:
    """It is included twice in a file: the second time has no effect."""
    headers = [path for path in PORTABLE if path.suffix == ".h" and path.name not in AVR_HEADERS]
    for number, header in enumerate(headers):
        twice = f'#include "{header}"\n' * 2
        (tmp_path / f"{number}.cpp").write_text(twice, encoding="utf-8")
    files = map(str, sorted(tmp_path.glob("*.cpp")))
    completed = subprocess.run(["g++", *STRICT_FLAGS, *files], capture_output=True, text=True)
    assert completed.returncode == 0, completed.stderr


@pytest.mark.skipif(sys.platform == "win32", reason="there a folder has no such owner")
def test_no_program_is_run_that_another_user_can_have_built(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The folder of builds is where all may make folders, and its name is no secret."""
    folder = tmp_path / "builds"
    assert host.make_private_folder(folder).stat().st_mode & 0o777 == 0o700
    folder.chmod(0o770)
    with pytest.raises(PermissionError):
        host.make_private_folder(folder)
    folder.chmod(0o700)
    link = tmp_path / "link"
    link.symlink_to(folder)
    monkeypatch.setattr(host, "USER", 12345)
    monkeypatch.setattr(os, "getuid", lambda: 12345)
    for path in (folder, link):
        with pytest.raises(PermissionError):
            host.make_private_folder(path)
