"""PlatformIO builds the sketch and runs the tests in C++."""

from __future__ import annotations

import os
import re
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from tests.machines import host
from tests.support.command import CommandResult
from tests.support.needs import need
from tests.support.platformio import OFFLINE, SKETCH, copy_sketch, pio, prepare
from tiniscript import compile_text, robots
from tiniscript.cli import main
from tools.bench.firmware_size import SMALLER_ENVIRONMENTS, environments
from tools.builds.platformio_offline import ARDUINO, BOARDS, DEBIAN_PACKAGES

FLASH_BYTES, RAM_BYTES = 32_256, 2048  # memory of an Uno


@pytest.fixture(scope="module")
def project(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of the sketch to build and to break. Without PlatformIO, tests are skipped; in CI they
    fail."""
    return copy_sketch(tmp_path_factory.mktemp("platformio"))


@pytest.fixture
def native(project: Path) -> Path:
    """Return the project, if this computer's compiler can build the tests in C++."""
    need(host.missing())
    return project


@contextmanager
def change_file(path: Path, *changes: tuple[str, str]) -> Iterator[None]:
    """Change a file of the copy, and put it back afterwards."""
    text_before = path.read_text(encoding="utf-8")
    before_after = text_before
    for old_text, new_text in changes:
        assert old_text in before_after, f"{path.name} has no {old_text}"
        before_after = before_after.replace(old_text, new_text)
    path.unlink()
    path.write_text(before_after, encoding="utf-8")
    try:
        yield
    finally:
        path.write_text(text_before, encoding="utf-8")


def names_stand_in_if_used(log: str) -> bool:
    """Return whether a log names the stand-ins, or is one of PlatformIO's own platforms."""
    return not prepare()[0] or "Offline stand-in for PlatformIO's platform" in log


# -- the tests in C++ ---------------------------------------------------------------------------


def test_firmware_tests_pass(native: Path) -> None:
    log = pio(native, "test", "-e", "native").gives(0).out
    count = re.search(r"(\d+) test cases: (\d+) succeeded", log)
    files = "".join(path.read_text(encoding="utf-8") for path in native.glob("test/*.cpp"))
    case_count = len(re.findall(r"^(?:TEST_)?CASE\(", files, re.MULTILINE))
    assert count and int(count[1]) == int(count[2]) == case_count > 300, log
    assert "\nPASSED: blocks: BREAK leaves the innermost loop\n" in log
    assert names_stand_in_if_used(log)


def test_a_failing_test_case_is_reported_by_name(native: Path) -> None:
    broken_path = native / "test" / "cases.cpp"
    with change_file(broken_path, ('"0 SHOW 2\\n0 MOTORS 0 0\\n0 DONE\\n")', '"0 SHOW 3\\n")')):
        log = pio(native, "test", "-e", "native").gives(1).out
    names = re.findall(r"^FAILED: (.*)$", log, re.MULTILINE)
    assert "accepted: ELSE after ELSE when the condition is FALSE" in names
    assert f"{len(names)} failed, " in log.splitlines()[-1] + log.splitlines()[-2], log


def test_cpp_test_cases_pass(native: Path) -> None:
    result = pio(native, "test", "-e", "native", "-a", "--test-case=no such case")
    result.gives(1, out="no test case has run")


def test_an_early_end_of_the_tests_fails(native: Path) -> None:
    """A run that stops in the middle is a failure, whatever its exit code."""
    broken_path = native / "test" / "test_cases.cpp"
    with change_file(
        broken_path,
        ('TEST_CASE("a robot that', 'TEST_CASE("ends") { exit(0); }\nTEST_CASE("a robot that'),
        ("#include <doctest.h>", "#include <doctest.h>\n#include <stdlib.h>"),
    ):
        pio(native, "test", "-e", "native").gives(1, out="have ended before their end")


def test_firmware_tests_are_built_for_the_computer(native: Path) -> None:
    pio(native, "test", "-e", "uno").gives(1, out="pio test -e native")


# -- the sketch ---------------------------------------------------------------------------------


SKETCHES = ("uno", "nano", "mega", "nano_liner", "mega_liner", "mega_grabber", "uno_elegoo4",
            "nano_elegoo4", "mega_elegoo4", "uno_sumo", "nano_sumo", "mega_sumo", "uno_tinibot2",
            "nano_tinibot2", "mega_tinibot2")  # fmt: skip

OLD_BY_NEW_NANO = {"nano_new": "nano", "nano_new_liner": "nano_liner",
             "nano_new_elegoo4": "nano_elegoo4", "nano_new_sumo": "nano_sumo",
             "nano_new_tinibot2": "nano_tinibot2"}  # fmt: skip
# Boards of PlatformIO, and where Arduino's `boards.txt` has them.
ARDUINO_BOARDS = {
    "uno": "uno",
    "nanoatmega328": "nano.menu.cpu.atmega328old",
    "nanoatmega328new": "nano.menu.cpu.atmega328",
    "megaatmega2560": "mega.menu.cpu.atmega2560",
}
# Their platform cannot be had everywhere: tests/firmware/test_esp32_builds.py builds them.
ESP32 = {"esp32dev": "tinibot32", "esp32c3": "tinibotc3"}


def test_every_robot_has_a_sketch_for_its_board() -> None:
    text = (SKETCH / "platformio.ini").read_text(encoding="utf-8")
    names = re.findall(r"\[env:(\w+)\]", text)
    assert set(names) == {*SKETCHES, *OLD_BY_NEW_NANO, *ESP32, *SMALLER_ENVIRONMENTS, "native"}
    assert set(environments()) == set(SKETCHES)
    for board, name in ESP32.items():
        assert robots.load(name).board.chip == board
    for name in set(robots.names()) - set(ESP32.values()):
        board = robots.load(name).board.chip
        assert (board if name == robots.DEFAULT else f"{board}_{name}") in SKETCHES


@pytest.mark.sampled(of="builds of PlatformIO")
@pytest.mark.parametrize("name", SKETCHES)
def test_the_sketch_builds(project: Path, name: str) -> None:
    log = pio(project, "run", "-e", name).gives(0).out
    assert names_stand_in_if_used(log)
    assert "warning" not in log, log
    used_bytes = {name: int(size) for name, size in re.findall(r"(\w+): .*used (\d+) bytes", log)}
    assert 0 < used_bytes["Flash"] < (FLASH_BYTES if "mega" not in name else 7 * FLASH_BYTES)
    assert 0 < used_bytes["RAM"] < (RAM_BYTES if "mega" not in name else 4 * RAM_BYTES)
    assert (project / ".pio" / "build" / name / "firmware.hex").is_file()


@pytest.mark.sampled(of="builds of PlatformIO")
def test_an_oversized_sketch_is_refused(project: Path) -> None:
    with change_file(
        project / "platformio.ini",
        ("= nanoatmega328\n", "= nanoatmega328\nboard_upload.maximum_size = 20000\n"),
    ):
        pio(project, "run", "-e", "nano").gives(
            1, out="is greater than maximum allowed (20000 bytes)"
        )


@pytest.mark.sampled(of="builds of PlatformIO")
def test_an_interrupt_without_a_vector_is_refused(project: Path) -> None:
    """Tables are in the place of vectors that `vectors.S` lacks."""
    clock = project / "src" / "boards" / "avr" / "clock.cpp"
    with change_file(clock, ("ISR(TIMER0_OVF_vect", "ISR(ADC_vect) {}\n\nISR(TIMER0_OVF_vect")):
        pio(project, "run", "-e", "uno").gives(1, out="an interrupt has no vector in vectors.S")


@pytest.mark.parametrize(("board", "arduino"), ARDUINO_BOARDS.items())
def test_the_capacity_of_a_board_follows_its_fuses(board: str, arduino: str) -> None:
    """The size of the bootloader's section follows from the high fuse, not from the bootloader's
    size."""
    path = ARDUINO / "boards.txt"
    need("" if path.exists() else f"{DEBIAN_PACKAGES[ARDUINO]} is not installed")
    rows = dict(re.findall(rf"^{re.escape(arduino)}\.(\S+)=(\S+)$", path.read_text("utf-8"), re.M))
    flash, min_section = {"atmega328p": (32_768, 512), "atmega2560": (262_144, 1024)}[
        rows["build.mcu"]
    ]
    section = min_section << (~int(rows["bootloader.high_fuses"], 16) >> 1 & 3)
    assert BOARDS[board][4] == flash - section == int(rows["upload.maximum_size"])


@pytest.mark.sampled(of="builds of PlatformIO")
@pytest.mark.parametrize(("new_env", "old_env"), OLD_BY_NEW_NANO.items())
def test_a_nano_with_a_new_bootloader_gets_the_same_sketch(
    project: Path, new_env: str, old_env: str
) -> None:
    """Only the upload differs: it uses PlatformIO's board for such Nanos."""
    builds: list[bytes] = []
    program_sizes: list[int] = []
    for name in (new_env, old_env):
        log = pio(project, "run", "-e", name).gives(0).out
        program_sizes += map(int, re.findall(r"Flash: .*bytes from (\d+)", log))
        builds.append((project / ".pio" / "build" / name / "firmware.hex").read_bytes())
    assert builds[0] == builds[1]
    assert (
        "nanoatmega328new" in pio(project, "project", "config").out.partition(f"env:{new_env}\n")[2]
    )
    assert program_sizes == [30_720] * 2


@pytest.mark.sampled(of="builds of PlatformIO")
def test_the_sketch_of_a_custom_robot_builds(project: Path) -> None:
    """`tsc firmware --board` writes its header, and from then on the sketch is for it."""
    kit_header = project / "src" / "boards" / "kits" / "own.h"
    pio(project, "run", "-e", "uno").gives(0)
    profile = Path(robots.__file__).parent / "tinibot.toml"
    try:
        assert main(["firmware", "--board", str(profile), "-o", str(kit_header)]) == 0
        log = pio(project, "run", "-e", "uno").gives(0).out
        assert re.search(r"(Compiling |Retrieved `)\S+/boards/motors.cpp.o", log)
        with change_file(kit_header, ("kBuzzer", "kNothingLikeIt")):
            pio(project, "run", "-e", "uno").gives(1, out="kBuzzer")
        board_message = "is wired to another board. It fits: uno."
        pio(project, "run", "-e", "mega").gives(1, out=board_message)
        pio(project, "run", "-e", "mega_grabber").gives(0)
    finally:
        kit_header.unlink(missing_ok=True)


def test_test_sketch_has_a_program_that_every_robot_can_run() -> None:
    """The compiler turns the text into the bytes below it in `board_main.cpp`."""
    source = (SKETCH.parent / "tests" / "machines" / "board_main.cpp").read_text(encoding="utf-8")
    text = re.search(r"Every robot can run it:  (.*)\n", source)
    array = re.search(r"program\[.*?\] = \{(.*?)\n\};", source, re.S)
    assert text and array
    byte_literals = re.findall(r"'(.)'|(0x\w+|\d+),", re.sub(r"//.*", "", array[1]))
    code = bytes(ord(letter) if letter else int(number, 0) for letter, number in byte_literals)
    for name in robots.names():
        assert code == compile_text(text[1], robots.load(name).kit).image


# -- the bootstrap ------------------------------------------------------------------------------


def run_offline(*words: str, **variables: str) -> CommandResult:
    completed = subprocess.run(
        [*OFFLINE, "--offline", *words],
        env={**os.environ, **variables},
        capture_output=True,
        text=True,
        check=False,
    )
    return CommandResult(completed.returncode, completed.stdout, completed.stderr)


def test_the_users_platformio_is_left_alone(project: Path, tmp_path: Path) -> None:
    manifest = tmp_path / "platforms" / "native" / "platform.json"
    manifest.parent.mkdir(parents=True)
    manifest.write_text("{}")
    result = run_offline("--project", str(project), PLATFORMIO_CORE_DIR=str(tmp_path))
    result.gives(0, "platforms of its own (native)", out="")
    assert [path for path in tmp_path.rglob("*") if path.is_file()] == [manifest]


def test_every_platform_is_pinned_and_other_versions_are_refused(
    project: Path, tmp_path: Path
) -> None:
    settings = (project / "platformio.ini").read_text(encoding="utf-8")
    names = re.findall(r"(?m)^platform = (.*)", settings)
    assert names and all(re.fullmatch(r"\w+ @ \d+\.\d+\.\d+", package) for package in names)
    with change_file(project / "platformio.ini", ("= atmelavr @ 5.1.0", "= atmelavr @ 5.0.0")):
        result = run_offline("--project", str(project), PLATFORMIO_CORE_DIR=str(tmp_path))
    result.gives(2, "wants atmelavr @ 5.0.0, the stand-in is one for 5.1.0", out="")


def test_the_command_runs_in_the_project(project: Path) -> None:
    run_offline("--project", str(project), "pio", "project", "config").gives(0, out="env:native")
