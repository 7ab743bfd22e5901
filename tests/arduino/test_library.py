"""The library for Arduino and PlatformIO: its files, its examples on chips, and the link of one."""

from __future__ import annotations

import subprocess
import sys
import tarfile
from pathlib import Path

import pytest

from tests.machines import board as boards
from tests.machines import sketch_board
from tests.support.command import run_subprocess
from tests.support.conformance_kit import have_kit
from tests.support.needs import need
from tests.support.platformio import shared_folder
from tools.builds import chips, library
from tools.uno import Uno

URL = "https://example.org/tiniscript"
EXAMPLES = ("ImageInFlash", "OwnSensor", "Link")
PRELUDE = "#include <Arduino.h>\nvoid setup();\nvoid loop();\n#line 1\n"
# Stand-ins for Arduino's core on chips without one here.
STAND_IN = """
#pragma once
#include <stdint.h>
#define PROGMEM
#define HIGH 1
#define LOW 0
#define OUTPUT 1
#define A0 14
#define A5 19
unsigned long millis();
unsigned long micros();
void pinMode(int, int);
void digitalWrite(int, int);
void analogWrite(int, int);
int analogRead(int);
struct Port {
  void begin(long);
  int available();
  int availableForWrite();
  int read();
  void write(uint8_t);
  void print(const char*);
  void println(const char*);
  void println(int);
  void println(double, int);
};
extern Port Serial;
"""
# Functions of the C library that these compilers lack.
STRING_H = """
#pragma once
#include <stddef.h>
extern "C" {
size_t strlen(const char*);
void* memcpy(void*, const void*, size_t);
void* memset(void*, int, size_t);
}
"""


@pytest.fixture(scope="module")
def built_library(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("library") / "TiniScript"
    assert library.main([str(folder), "--url", URL]) == 0
    return folder


def sources(folder: Path) -> list[Path]:
    return [p for p in sorted((folder / "src").rglob("*")) if p.suffix in (".cpp", ".S")]


def elf(built: Path, example: str, board: str, folder: Path) -> Path:
    """Return an example as the Arduino IDE builds it: no warning, and it fits."""
    need(boards.missing())
    path = folder / f"{example}-{board}.elf"
    if path.exists():
        return path
    sketch = folder / f"{example}.cpp"
    text = (built / "examples" / example / f"{example}.ino").read_text(encoding="utf-8")
    sketch.write_text(PRELUDE + text, encoding="utf-8")
    flags = [
        *boards.flags_of(board, sketch_board.FLAGS),
        *boards.CPP,
        "-Wall",
        "-Wextra",
        "-Werror",
    ]
    boards.run(
        "avr-g++", *flags, "-Wl,--gc-sections", f"-I{built / 'src'}", sketch, *sources(built),
        sketch_board.core(board), "-o", path,
    )  # fmt: skip
    return path


@pytest.mark.sampled("board")
@pytest.mark.parametrize("board", ["uno", "mega"])
@pytest.mark.parametrize("example", EXAMPLES)
def test_an_example_builds_and_fits(
    built_library: Path, example: str, board: str, tmp_path_factory: pytest.TempPathFactory
) -> None:
    program = elf(built_library, example, board, shared_folder(tmp_path_factory))
    text, data, zeros = map(int, boards.run("avr-size", program).splitlines()[1].split()[:3])
    flash, ram = (32_256, 2_048) if board == "uno" else (253_952, 8_192)
    assert text + data <= flash
    assert data + zeros <= ram - 400, "no room for the stack"


@pytest.mark.parametrize("name", chips.CHIPS)
def test_library_and_examples_compile_for_a_chip_of_esp_boards(
    built_library: Path, name: str, tmp_path: Path
) -> None:
    need(chips.missing_reason(chips.CHIPS[name]))
    (tmp_path / "Arduino.h").write_text(STAND_IN, encoding="utf-8")
    (tmp_path / "string.h").write_text(STRING_H, encoding="utf-8")
    sketches = []
    for example in EXAMPLES:
        text = (built_library / "examples" / example / f"{example}.ino").read_text(encoding="utf-8")
        sketches.append(tmp_path / f"{example}.cpp")
        sketches[-1].write_text(PRELUDE + text, encoding="utf-8")
    flags = (f"-I{built_library / 'src'}", f"-I{tmp_path}")
    for path in [
        *(built_library / "src").glob("*.cpp"),
        *sketches,
    ]:  # the rest is built for them elsewhere
        chips.compile_one(chips.CHIPS[name], path, str(tmp_path / "one.o"), flags)


def test_an_image_in_flash_runs(
    built_library: Path, tmp_path_factory: pytest.TempPathFactory
) -> None:
    program = elf(built_library, "ImageInFlash", "uno", shared_folder(tmp_path_factory))
    with Uno(program, names={"left": "D5", "back": "D7"}) as uno:
        uno.run_ms(500)
        assert uno.pins.history("left")[-1].state == "pwm"
        uno.run_ms(800)  # the right wheel turns backward now
        assert uno.pins.history("back")[-1].state == "high"
        uno.run_ms(700)
        assert uno.pins.history("left")[-1].state == "low"
        assert uno.pins.history("back")[-1].state == "low"


@pytest.mark.long
def test_the_link_of_an_example_conforms(
    built_library: Path, tmp_path: Path, tmp_path_factory: pytest.TempPathFactory
) -> None:
    have_kit()
    program = elf(built_library, "Link", "uno", shared_folder(tmp_path_factory))
    with Uno(program, baud=115_200, tells_sleep=False) as uno:
        uno.go()
        result = run_subprocess("doctor", "--conform", "--port", uno.pty, "--baud", "115200")
        assert result.code == 0, result.out + result.err
        result = run_subprocess("upload", "-e", "SI|SHOW(1 + 1)", "--port", uno.pty,
                                "--baud", "115200", "--no-save")  # fmt: skip
        assert "1 + 1 2" in result.out, result.out + result.err


def test_platformio_packs_it(built_library: Path, tmp_path: Path) -> None:
    """Its list of licences comes from the internet, so a stub replaces it."""
    pytest.importorskip("platformio")
    code = (
        "import json, sys\n"
        "from platformio.package.manifest import schema\n"
        "licences = {'licenses': [{'licenseId': 'MIT'}]}\n"
        "schema.ManifestSchema.load_spdx_licenses = staticmethod(lambda: licences)\n"
        "from platformio.__main__ import main\n"
        "sys.exit(main(['pio', 'pkg', 'pack', sys.argv[1], '-o', sys.argv[2]]))\n"
    )
    command = [sys.executable, "-c", code, str(built_library), str(tmp_path)]
    completed = subprocess.run(command, capture_output=True, text=True, check=False)
    assert completed.returncode == 0, completed.stdout + completed.stderr
    (packed_path,) = tmp_path.glob("*.tar.gz")
    with tarfile.open(packed_path) as tar_file:
        names = set(tar_file.getnames())
    assert {
        "src/TiniScript.h",
        "src/vm/machine.h",
        "library.json",
        "examples/Link/Link.ino",
    } <= names


def test_a_foreign_folder_is_left_alone(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "kept.txt").write_text("mine", encoding="utf-8")
    assert library.main([str(tmp_path), "--url", URL]) == 2
    assert (tmp_path / "kept.txt").read_text(encoding="utf-8") == "mine"
    assert "no library" in capsys.readouterr().err
