"""`tsc firmware` builds missing firmware, never writes old ones, and names the reason if it
cannot.
"""

from __future__ import annotations

import errno
import os
import re
import shutil
import subprocess
import sys
from argparse import Namespace
from collections.abc import Callable, Sequence
from contextlib import nullcontext
from functools import cache, partial
from pathlib import Path
from random import Random
from typing import ClassVar, NamedTuple

import pytest

from tests.machines.bootloaders import bootloader
from tests.machines.uno import skip_unless_available
from tests.support.casefile import ROOT
from tests.support.command import CommandResult, Tsc, run_subprocess
from tests.support.copies import link_copy
from tests.support.edited_robots import TEXTS
from tests.support.flashed_boards import (
    CHILD_ENDS,
    command,
    copy_package,
    new_board,
    run_interrupted,
    tsc,
)
from tests.support.needs import need
from tests.support.platformio import prepare
from tests.support.waiting import has_ended, until
from tiniscript import robots
from tiniscript.cli import firmware_build
from tiniscript.cli.errors import CommandError
from tiniscript.cli.terminal.progress import Progress
from tiniscript.flash import building, children, ready
from tiniscript.flash.building import (
    COMPILING,
    FETCHING,
    WRITING,
    CannotBuild,
    Sources,
    StepProgress,
)
from tiniscript.library import install_advice
from tiniscript.robots.profile import Robot

load = cache(robots.load)  # takes longer than what is tested with it


@pytest.fixture
def clone(tmp_path: Path) -> Path:
    """A copy of a clone's package and of the firmware's sources: its `compiler`."""
    folder = tmp_path / "clone"
    link_copy(ROOT / "vm_arduino", folder / "vm_arduino", ".pio", "own.h", "__pycache__")
    return copy_package(folder)


@pytest.fixture
def robot_file(tmp_path: Path) -> Path:
    """A profile of one's own: the paper's robot with another name for a sensor."""
    profile = tmp_path / "mine.toml"
    profile.write_text(TEXTS["tinibot"].replace("LIGHT_R", "LIGHT_X"), encoding="utf-8")
    return profile


# -- PlatformIO builds


@pytest.mark.sampled(of="builds of PlatformIO")
def test_a_custom_robot_is_built_and_written(clone: Path, robot_file: Path) -> None:
    """It is built once and stays ready until one of its sources changes."""
    skip_unless_available()
    environment, reason = prepare()
    need(reason or ("" if shutil.which("avrdude") else "no avrdude on this computer"))
    with new_board(bootloader("uno")) as uno:
        result = tsc(clone, "--port", uno.pty, "--robot", str(robot_file), **environment)
        assert result.code == 0, result.err
        assert "PlatformIO is building the firmware of mine for the uno" in result.err
        first_line = result.out.splitlines()[0]
        assert first_line.startswith("The firmware for mine was written to the uno and verified: ")
        info = run_subprocess("doctor", "--json", "--port", uno.pty)
        assert f'"kit": "{robots.load(str(robot_file)).kit.fingerprint:04x}"' in info.out, info.err
    files = ready.files(ready.firmware_cache())
    assert [(file.title, file.board) for file in files] == [("mine", "uno")]
    second_build = tsc(
        clone, "--build", "--robot", str(robot_file)
    )  # PlatformIO could not build now
    assert (second_build.code, second_build.err) == (0, "")
    assert second_build.out == f"mine on uno: ready, {files[0].flash_bytes:,} bytes\n"
    source = clone.parent / "vm_arduino" / "src" / "main.cpp"
    source.unlink()
    source.write_text("?", encoding="utf-8")
    broken_result = tsc(clone, "--build", "--robot", str(robot_file), **environment)
    assert broken_result.code == 2
    assert "could not be built" in broken_result.err and "error" in broken_result.err
    log = broken_result.err.split()[-1]
    assert "main.cpp" in Path(log).read_text(encoding="utf-8")


# -- outdated files are not written


def test_the_digest_covers_sources_robot_and_board(clone: Path, robot_file: Path) -> None:
    sources, rng = building.sources(), Random(1)
    assert sources is not None
    digests = {
        sources.digest(robot)
        for robot in (
            robots.load("tinibot"),
            robots.load("tinibot", "nano"),
            robots.load(str(robot_file)),
        )
    }
    assert len(digests) == 3
    spanish = robots.load("tinibot").with_language("es")
    assert sources.digest(spanish) not in digests and ready.title_of(spanish) == "tinibot_es"
    assert ready.title_of(spanish.with_language("en")) == "tinibot_es"
    for name in sources.files:
        data, k = bytearray(sources.files[name]), rng.randrange(len(sources.files[name]))
        data[k] ^= 1
        for changed_data in (bytes(data), sources.files[name] + b"\n"):
            changed_sources = building.Sources({**sources.files, name: changed_data})
            digests.add(changed_sources.digest(robots.load("tinibot")))
        fewer = {value: data for value, data in sources.files.items() if value != name}
        digests.add(building.Sources(fewer).digest(robots.load("tinibot")))
    assert len(digests) == 3 + 3 * len(sources.files) > 150


@pytest.mark.parametrize("seed", range(10))
def test_no_two_sources_have_one_digest(seed: int) -> None:
    """However the same bytes are spread over the same names."""
    rng, robot, files_by_digest = Random(seed), load("tinibot"), dict[str, dict[str, bytes]]()
    for _ in range(60):
        text, names = b"a\n1\n"[: rng.randrange(6)], ["a", "b", "a\n1"][: rng.randrange(4)]
        files: dict[str, bytes] = {}
        for name in names:
            k = rng.randrange(len(text) + 1)
            files[name], text = text[:k], text[k:]
        digest = building.Sources(files).digest(robot)
        assert files_by_digest.setdefault(digest, files) == files


def test_the_sources_are_those_of_the_project_without_a_robot(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Whichever robot was built before, and the first folder that has any."""
    names = ("platformio.ini", "partitions.csv", "src/main.cpp", "src/boards/a.h")
    for folder, others in (("none", ()), ("first", ("src/boards/kits/own.h",)), ("second", ())):
        for name in (*names[folder == "none" :], *others, "README.md", ".pio/a.cpp"):
            (tmp_path / folder / name).parent.mkdir(parents=True, exist_ok=True)
            (tmp_path / folder / name).write_text(f"{name} in {folder}")
    folders = tuple(tmp_path / folder for folder in ("none", "first", "second"))
    monkeypatch.setattr(building, "SOURCE_FOLDERS", folders)
    for _ in range(2):
        found_sources = building.sources()
        assert found_sources is not None
        assert found_sources.files == {name: f"{name} in first".encode() for name in names}
        (tmp_path / "first" / building.HEADER_FILE).unlink(missing_ok=True)
    monkeypatch.setattr(building, "SOURCE_FOLDERS", folders[:1])
    assert building.sources() is None


def test_breakpoints_change_the_firmware_only_if_they_replace_a_feature(
    clone: Path,
) -> None:
    """For each robot on each board: it is built, refused, or included anyway."""
    sources = building.sources()
    assert sources is not None
    for name in robots.names():
        for robot in (robots.load(name), *firmware_build.robots_on_boards(name, "en")):
            board, has_discs = robot.board.chip, robot.board.discs is not None
            if board in building.ENVIRONMENT_WITH_BREAKPOINTS and not has_discs:
                assert sources.digest(robot, True) != sources.digest(robot)
                assert ready.title_of(robot, True) != ready.title_of(robot)
                firmware_build.require_breakpoints(robot)
                continue
            with pytest.raises(CommandError) as exception_info:
                firmware_build.require_breakpoints(robot)
            has_breakpoints_anyway = board not in building.ENVIRONMENT_WITH_BREAKPOINTS
            key = "flash_has_breakpoints" if has_breakpoints_anyway else "flash_no_breakpoints"
            assert exception_info.value.key == key


@pytest.mark.sampled(of="builds of PlatformIO")
def test_firmware_with_breakpoints_is_cached_beside_that_without(clone: Path) -> None:
    """The omitted features are printed before, even if it is ready, and files are never
    confused.
    """
    skip_unless_available()
    environment, reason = prepare()
    need(reason)
    for _ in range(2):
        result = tsc(clone, "--build", "--breakpoints", "--chip", "uno", **environment)
        assert result.code == 0, result.err
        assert "no longer reads typed lines of text" in result.err
        assert result.out.startswith("tinibot on uno: ready, ")
        environment = {}  # PlatformIO could not build now
    assert [file.title for file in ready.files(ready.firmware_cache())] == ["tinibot_breakpoints"]
    assert "tinibot on uno: not built yet" in tsc(clone, "--list").out


@pytest.mark.parametrize(("words", "message"), [
    (("--chip", "mega"), "the firmware for the mega always has breakpoints"),
    (("--robot", "tinibot32"), "the firmware for the esp32dev always has breakpoints"),
    (("--robot", "tinibot2", "--chip", "uno"), "discs on its wheels"),
])  # fmt: skip
def test_breakpoints_that_leave_nothing_out_or_have_no_room_are_refused(
    clone: Path, words: tuple[str, ...], message: str
) -> None:
    result = tsc(clone, "--build", "--breakpoints", *words)
    assert (result.code, result.out) == (2, "") and message in result.err


def test_a_hand_made_header_is_ignored(clone: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(building, "SOURCE_FOLDERS", [clone.parent / "vm_arduino"])
    sources_before = building.sources()
    (clone.parent / "vm_arduino" / building.HEADER_FILE).write_text("#error", encoding="utf-8")
    assert sources_before and building.sources() == sources_before


def test_an_outdated_packaged_file_is_not_used(clone: Path) -> None:
    """`ready` is a folder of the clone, and a pull changes the sources next to it."""
    folder = clone / "tiniscript" / "flash" / "ready"
    folder.mkdir()
    digest = building.Sources(source_bytes(clone)).digest(robots.load("tinibot"))
    (folder / ready.file_name_of("tinibot", "uno", digest)).write_text(":00000001FF\n")
    (folder / ready.file_name_of("tinibot", "nano", digest)).write_text(":00000001FF\n")
    rows = tsc(clone, "--list").out.splitlines()
    assert rows[0] == "tinibot on uno: ready, 0 bytes"
    assert rows[1].startswith("tinibot on nano: not built yet")


@pytest.mark.parametrize(("titles", "spanish", "english"), [
    (["liner", "liner_es", "own"], "liner_es", "liner"),
    (["liner"], "liner", "liner"),  # an answer in another language is better than no robot
    (["tinibot"], None, None),
])  # fmt: skip
def test_a_package_without_sources_uses_the_file_in_the_robots_language(
    monkeypatch: pytest.MonkeyPatch, titles: list[str], spanish: str | None, english: str | None
) -> None:
    files = [ready.ReadyFile(title, "nano", "1", Path(title)) for title in titles]
    monkeypatch.setattr(building, "sources", lambda: None)
    monkeypatch.setattr(ready, "files", lambda: files)
    for language, expected_text in (("es", spanish), ("en", english)):
        robot = robots.load("liner", "nano").with_language(language)
        if expected_text is None:
            with pytest.raises(CommandError):
                firmware_build.firmware(robot, Namespace(yes=True), "en")
        else:
            assert firmware_build.firmware(robot, Namespace(yes=True), "en").title == expected_text
        with pytest.raises(CommandError):  # a firmware without breakpoints is none with them
            firmware_build.firmware(robot, Namespace(yes=True), "en", has_breakpoints=True)
        own_robot = robot._replace(name="own")
        with pytest.raises(CommandError):
            firmware_build.firmware(own_robot, Namespace(yes=True), "en")


def source_bytes(clone: Path) -> dict[str, bytes]:
    project = clone.parent / "vm_arduino"
    paths = [project / name for name in (building.SETTINGS_FILE, building.PARTITIONS_FILE)]
    files = [*paths, *sorted((project / "src").rglob("*"))]
    return {
        path.relative_to(project).as_posix(): path.read_bytes() for path in files if path.is_file()
    }


ROW = ":0400000001020304F2\n"


@pytest.mark.parametrize(("text", "is_whole"), [
    (ROW + ":00000001FF\n", True),
    (ROW, False),  # a disk that was full
    ("", False),
    (ROW.replace("F2", "F3") + ":00000001FF\n", False),
    (ROW + ":0000", False),
    ("<p>no file</p>", False),
])  # fmt: skip
def test_an_incomplete_file_is_rebuilt(text: str, is_whole: bool) -> None:
    folder = ready.firmware_cache()
    folder.mkdir(parents=True)
    (folder / ready.file_name_of("mine", "uno", "12")).write_text(text)
    assert (ready.find("mine", "uno", "12") is not None) == is_whole
    assert ready.find("mine", "uno", "13") is None
    assert len(ready.files(folder)) == is_whole


def test_the_cache_does_not_grow_for_ever() -> None:
    for number in range(ready.MAX_FILES + 5):
        file = ready.store("a/robot of mine", "uno", f"{number:016x}", b":00000001FF\n")
        os.utime(file.path, ns=(number, number))
    files = ready.files(ready.firmware_cache())
    assert len(files) == ready.MAX_FILES and files[-1].digest == f"{ready.MAX_FILES + 4:016x}"
    assert {path.suffix for path in ready.firmware_cache().iterdir()} == {".hex"}
    for file in files:
        os.utime(file.path, (2**33, 2**33))  # the clock of this computer was ahead, or is behind
    for number in range(2):
        assert ready.store("new", "uno", f"{number:016x}", b":00000001FF\n").path.is_file()


@pytest.mark.parametrize("board", ["esp32dev", "esp32c3", "esp8266"])
def test_only_an_image_that_its_board_can_start_is_offered(board: str, tmp_path: Path) -> None:
    """It begins where that board looks for it."""
    for offset in (0, 1, 0x1000):
        data = bytes(offset) + ready.IMAGE_MAGIC + bytes(0x2000)
        path = tmp_path / f"tinibot-{board}-{offset}.bin"
        path.write_bytes(data)
        is_offered = ready.IMAGE_OFFSETS.get(board) == offset
        images = [ready.ReadyFile("tinibot", board, str(offset), path)] * is_offered
        assert ready.images(tmp_path) == images
        path.write_bytes(data[:offset])
        assert ready.images(tmp_path) == []
        path.unlink()


# -- with a PlatformIO that a test plays


class Played(NamedTuple):
    """An end of PlatformIO: its exit code, its output, and the file that it leaves."""

    code: int
    log: str
    file: str | None

    @property
    def refusal(self) -> str | None:
        """The reason why there is no firmware; a size is one, whatever else is said."""
        if "greater than maximum" in self.log:
            return CannotBuild.TOO_LARGE
        if self.code == 0 and self.file == WHOLE_FILE:
            return None
        is_offline = "Compiling" not in self.log and "HTTP" in self.log
        return CannotBuild.UNREACHABLE if is_offline else CannotBuild.FAILED


WHOLE_FILE = ":0400000001020304F2\n:00000001FF\n"
LOGS = (
    "",
    "Compiling a\n",
    *["Compiling a\nsize (33000 bytes) is greater than maximum allowed (32256 bytes)\n"] * 4,
    "Tool Manager: Installing a\nHTTPClientError\n",
    "Tool Manager: Installing a\nHTTP\nCompiling a\n",
)


class DrawnProgress(Progress):
    """Draws at once, on a terminal."""

    drawn: ClassVar[set[Progress]] = set()

    def draw(self, done_units: int) -> bool:
        self.drawn.add(self)
        return True

    def end(self) -> None:
        self.drawn.discard(self)


class PlatformIO:
    """Is `children.run`: each run ends as one of `ends`."""

    def __init__(self, robot: Robot, sources: Sources) -> None:
        self.robot, self.sources = robot, sources
        self.ends: list[Played] = []
        self.commands: list[list[str]] = []  # without the folder
        self.folders = set[Path]()

    def __call__(
        self,
        command: list[str],
        folder: Path,
        on_output: Callable[[str], None],
        environment: dict[str, str],
    ) -> tuple[int, str]:
        end = self.ends[len(self.commands)]
        words = command[command.index("-d") :]
        assert words[1] == str(folder) and words[2] == "-e"
        assert "PLATFORMIO_BUILD_FLAGS" not in environment
        assert environment["PLATFORMIO_SETTING_ENABLE_TELEMETRY"] == "no"
        files = dict(self.sources.files)
        files[building.HEADER_FILE] = building.header(self.robot).encode()
        found = {
            path.relative_to(folder).as_posix(): path.read_bytes()
            for path in folder.rglob("*")
            if path.is_file() and ".pio" not in path.parts
        }
        assert found == files
        self.folders.add(folder)
        self.commands.append(words[3:])
        on_output(end.log)
        if end.file is not None:
            path = folder / ".pio" / "build" / words[3] / "firmware.hex"
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(end.file)
        return end.code, end.log


@pytest.fixture
def play(monkeypatch: pytest.MonkeyPatch) -> Callable[[Robot, list[Played]], PlatformIO]:
    # Sources that a person has built from still have the header of another robot.
    sources = Sources({"platformio.ini": b"[env]\n", "src/a.cpp": b"a", building.HEADER_FILE: b"?"})
    monkeypatch.setattr(building, "platformio", lambda: ["pio"])
    monkeypatch.setenv("PLATFORMIO_BUILD_FLAGS", "other")

    def begin(robot: Robot, ends: list[Played]) -> PlatformIO:
        played = PlatformIO(robot, sources)
        played.ends = ends
        monkeypatch.setattr(children, "run", played)
        return played

    return begin


def random_end(rng: Random) -> Played:
    code, file = rng.choice((0, 0, 0, 1, -9)), rng.choice((WHOLE_FILE, WHOLE_FILE, ROW, None))
    return Played(code, rng.choice(LOGS), file)


@pytest.mark.parametrize("seed", range(10))
def test_a_firmware_is_that_of_a_build_that_has_succeeded(
    play: Callable[[Robot, list[Played]], PlatformIO], seed: int
) -> None:
    """Only a size that is too large is tried again, smaller; the next build is like the first."""
    rng = Random(seed)
    for _ in range(25):
        name, chip = rng.choice(("tinibot", "tinibot2")), rng.choice(("uno", "nano", "mega"))
        robot = load(name, chip)
        has_breakpoints = building.can_have_breakpoints(robot) and rng.random() < 0.5
        first = f"{chip}_tinibot2" if name == "tinibot2" and chip != "mega" else chip
        environments = [f"{chip}_breakpoints" if has_breakpoints else first]
        ends = [random_end(rng), random_end(rng)]
        if ends[0].refusal == CannotBuild.TOO_LARGE and environments == [chip] and chip != "mega":
            environments.append({"uno": "uno_without_tasks", "nano": "nano_without_remote"}[chip])
        end, steps = ends[len(environments) - 1], list[StepProgress]()
        played = play(robot, ends)
        if end.refusal is None:
            data = building.build(played.sources, robot, steps.append, has_breakpoints)
            assert data == WHOLE_FILE.encode()
        else:
            with pytest.raises(CannotBuild) as exception_info:
                building.build(played.sources, robot, steps.append, has_breakpoints)
            error = exception_info.value
            assert (error.reason, error.log) == (end.refusal, end.log) and error.last_output
        assert played.commands == [[name] for name in environments]
        smaller_phases = [step.phase for step in steps if step.phase.startswith("less_")]
        assert len(smaller_phases) == len(environments) - 1
        assert not any(folder.exists() for folder in played.folders)


@pytest.mark.parametrize("seed", range(10))
def test_only_a_firmware_that_was_built_is_written(
    play: Callable[[Robot, list[Played]], PlatformIO], seed: int
) -> None:
    """It is written where there is a port, and says so where that fails."""
    rng, robot = Random(seed), load("tinibot32")
    for _ in range(10):
        ends, port = [random_end(rng)._replace(file=None) for _ in "ab"], rng.choice((None, "COM5"))
        built = ends[0]._replace(file=WHOLE_FILE).refusal  # it makes no HEX file
        played = play(robot, ends)
        reason = built or (CannotBuild.NOT_WRITTEN if port and ends[1].code else None)
        with pytest.raises(CannotBuild) if reason else nullcontext() as exception_info:
            building.upload(played.sources, robot, port, lambda _: None)
        assert exception_info is None or exception_info.value.reason == reason
        writes = [["esp32dev", "-t", "upload", "--upload-port", "COM5"]] if port else []
        assert played.commands == [["esp32dev"], *(writes if built is None else [])]
        assert not any(folder.exists() for folder in played.folders)


FAILURES = (
    CannotBuild(CannotBuild.FAILED, "error", "first log"),
    CannotBuild(CannotBuild.FAILED, "error", "another log"),
    CannotBuild(CannotBuild.FAILED, "no output"),
    OSError(errno.ENOSPC, "full"),
)


@pytest.mark.parametrize("seed", range(10))
def test_a_firmware_is_built_once_for_each_robot_and_its_sources(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], seed: int
) -> None:
    """One that failed is built again; its output is kept until the next failure."""
    rng, built = Random(seed), dict[str, str]()
    versions = [Sources({"src/a.cpp": bytes((k,))}) for k in range(2)]
    log_path = ready.firmware_cache() / firmware_build.LOG_FILE
    monkeypatch.setattr(building, "platformio", lambda: ["pio"])
    monkeypatch.setattr(building, "missing_mb", lambda _: 0)
    monkeypatch.setattr(firmware_build, "Progress", DrawnProgress)
    for number in range(30):
        language, has_breakpoints = rng.choice(("en", "es")), rng.random() < 0.4
        robot = load("tinibot", rng.choice(("uno", "nano"))).with_language(language)
        sources, failure = rng.choice(versions), rng.choice((None, None, *FAILURES))
        # Firmware with breakpoints answers no text: its language is none.
        key = f"{versions.index(sources)} {robot.board.chip} {has_breakpoints or language}"
        hex_text = f":01000000{number:02X}{255 - number:02X}\n:00000001FF\n"
        calls: list[bool] = []

        def build(
            sources_: Sources, robot_: Robot, on_progress: Callable[[StepProgress], None],
            has_breakpoints: bool, calls: list[bool] = calls, sources: Sources = sources,
            failure: Exception | None = failure, hex_text: str = hex_text,
        ) -> bytes:  # fmt: skip
            assert sources_ is sources
            calls.append(has_breakpoints)
            on_progress(StepProgress(FETCHING, 5, "a package"))
            on_progress(StepProgress(FETCHING, 50, "a package"))
            on_progress(StepProgress(COMPILING, 50))
            if failure is not None:
                raise failure
            return hex_text.encode()

        monkeypatch.setattr(building, "build", build)
        monkeypatch.setattr(building, "sources", lambda sources=sources: sources)
        log_before = log_path.read_text() if log_path.exists() else None
        if key in built or failure is None:
            file = firmware_build.firmware(robot, Namespace(yes=True), "en", has_breakpoints)
            assert calls == ([] if key in built else [has_breakpoints])
            assert file.path.read_text() == built.setdefault(key, hex_text)
            assert file.board == robot.board.chip
            log_after = log_before
        else:
            with pytest.raises(CommandError) as exception_info:
                firmware_build.firmware(robot, Namespace(yes=True), "en", has_breakpoints)
            is_ours = isinstance(failure, CannotBuild)
            key_expected = "flash_build_failed" if is_ours else "flash_no_room"
            assert (exception_info.value.exit_code, exception_info.value.key) == (2, key_expected)
            log_after = (
                failure.log if isinstance(failure, CannotBuild) and failure.log else log_before
            )
        assert (log_path.read_text() if log_path.exists() else None) == log_after
        assert capsys.readouterr().err.count("a package") == len(calls)
        assert not DrawnProgress.drawn, "nothing is left of the bar"


# -- with a PlatformIO whose output is scripted


def fake_platformio(folder: Path, body: str) -> dict[str, str]:
    """Return the variables with which a Python has this for its PlatformIO."""
    package = folder / "pretending" / "platformio"
    package.mkdir(parents=True)
    (package / "__init__.py").write_text("")
    (package / "__main__.py").write_text(f"import os, subprocess, sys, time\n{body}\n")
    return {"PYTHONPATH": str(package.parent)}


TOO_LARGE = """\
print("Compiling a"); \
print("Error: The program size (33000 bytes) is greater than maximum allowed (32256 bytes)"); \
sys.exit(1)"""
# Makes the file of a board: its name, and the rows in it.
BUILD_CODE = """
def make(name, rows):
    made = os.path.join(sys.argv[sys.argv.index("-d") + 1], ".pio", "build", name)
    os.makedirs(made)
    print("Compiling a", flush=True)
    open(os.path.join(made, "firmware.hex"), "w").write(rows)
"""


def build_firmware(clone: Path, environment: dict[str, str], *words: str) -> CommandResult:
    path = environment["PYTHONPATH"] + os.pathsep + str(clone)
    return tsc(clone, "--build", *words, **{**environment, "PYTHONPATH": path})


OFFLINE = 'print("Platform Manager: Installing atmelavr\\nHTTPClientError: "); sys.exit(1)'


def test_an_offline_build_names_the_next_step(clone: Path, tmp_path: Path) -> None:
    result = build_firmware(clone, fake_platformio(tmp_path, OFFLINE), "--lang", "es")
    result.gives(2, "¿Tiene internet esta computadora?", "(HTTPClientError)", out="")
    log = Path(result.err.split()[-1])
    assert log.parent == ready.firmware_cache() and "Installing atmelavr" in log.read_text()
    assert not ready.files(ready.firmware_cache())


@pytest.mark.sampled("body", "reason", keep=2)
@pytest.mark.parametrize(("body", "reason"), [
    ('print("Compiling a\\nsrc/a.cpp:3:1: error: no such thing"); sys.exit(1)', "no such thing"),
    ('print("Compiling a\\nLinking"); sys.exit(0)', "Linking"),  # the build writes no file
    ("sys.exit(7)", "exit code 7"),
    ('os.write(1, b"Compiling \\xff\\x1b[2J error\\n" * 100_000); sys.exit(1)', "error"),
])  # fmt: skip
def test_a_build_that_fails_has_its_reason(
    body: str, reason: str, clone: Path, tmp_path: Path
) -> None:
    result = build_firmware(clone, fake_platformio(tmp_path, body)).gives(2, reason, out="")
    assert "\x1b" not in result.err


def test_firmware_too_large_for_the_board_is_refused_before_writing(
    clone: Path, tmp_path: Path
) -> None:
    result = build_firmware(clone, fake_platformio(tmp_path, TOO_LARGE))
    result.gives(2, "does not fit on", "33000 > 32256", out="")
    assert "upgrade" not in result.err
    assert not ready.files(ready.firmware_cache())


@pytest.mark.parametrize(
    ("chip", "missing_text"), [("uno", "sin TASK ni WHEN"), ("nano", "sin control remoto")]
)
def test_oversized_firmware_is_built_with_fewer_features_and_a_notice(
    chip: str, missing_text: str, clone: Path, tmp_path: Path
) -> None:
    body = f"""
{BUILD_CODE}
name = sys.argv[sys.argv.index("-e") + 1]
if name == "{chip}":
    {TOO_LARGE}
make(name, ":00000001FF\\n")
"""
    words = ("--chip", chip, "--lang", "es")
    result = build_firmware(clone, fake_platformio(tmp_path, body), *words).gives(0)
    assert result.err.count(f"queda {missing_text}") == 1, result
    assert len(list(ready.firmware_cache().glob("*.hex"))) == 1


def test_a_partial_file_from_platformio_is_not_kept(clone: Path, tmp_path: Path) -> None:
    body = f'{BUILD_CODE}\nmake("uno", ":0400")'
    build_firmware(clone, fake_platformio(tmp_path, body)).gives(2, "could not be built")
    assert not list(ready.firmware_cache().glob("*.hex"))


@pytest.mark.sampled("end", keep=2)
@pytest.mark.parametrize("end", CHILD_ENDS)
def test_a_failed_build_leaves_nothing(end: str, clone: Path, tmp_path: Path) -> None:
    """Files that it leaves do not count."""
    body = f'import signal\n{BUILD_CODE}\nmake("uno", ":00000001FF\\n")\n{end}'
    build_firmware(clone, fake_platformio(tmp_path, body)).gives(2, "could not be built")
    assert not list(ready.firmware_cache().glob("*.hex"))


def test_custom_settings_do_not_affect_the_build(clone: Path, tmp_path: Path) -> None:
    """Settings for a project of the person's own would change the build or its place."""
    body = 'print("Compiling", *sorted(n for n in os.environ if "PLATFORMIO" in n)); sys.exit(1)'
    environment = fake_platformio(tmp_path, body)
    for name in ("BUILD_FLAGS", "SRC_DIR", "BUILD_DIR", "WORKSPACE_DIR", "DEFAULT_ENVS"):
        environment[f"PLATFORMIO_{name}"] = "other"
    environment["PLATFORMIO_CORE_DIR"] = "kept"
    build_firmware(clone, environment)
    lines = (ready.firmware_cache() / "build.log").read_text().split()[1:]
    assert "PLATFORMIO_CORE_DIR" in lines and "PLATFORMIO_SETTING_ENABLE_TELEMETRY" in lines
    assert not [name for name in lines if re.search("FLAGS|SRC|BUILD|WORKSPACE|ENVS", name)]


def test_a_pupils_files_are_not_mistaken_for_platformios(clone: Path, tmp_path: Path) -> None:
    """A folder with programs may have a `serial.py` of the pupil's own."""
    own_folder = tmp_path / "mine"
    own_folder.mkdir()
    (own_folder / "serial.py").write_text('print("Compiling my own"); raise SystemExit(1)')
    completed = subprocess.run(
        command("--build"),
        cwd=own_folder,
        env={**os.environ, **fake_platformio(tmp_path, "import serial\nprint(serial.__file__)")},
        capture_output=True,
        text=True,
    )
    assert completed.returncode == 2
    log = (ready.firmware_cache() / "build.log").read_text()
    assert "my own" not in log and "serial" in log


def test_an_unwritable_cache_is_reported(clone: Path, tmp_path: Path) -> None:
    body = f'{BUILD_CODE}\nmake("uno", ":00000001FF\\n")'
    (tmp_path / "cache").write_text("a file")
    result = build_firmware(clone, fake_platformio(tmp_path, body))
    result.gives(2, "make room there", str(tmp_path / "cache"))


def test_an_undeletable_file_fails_no_build(monkeypatch: pytest.MonkeyPatch) -> None:
    """A virus scanner on Windows may still hold it."""

    def raise_busy(path: object, **_: object) -> None:
        raise OSError(errno.EBUSY, "held", path)

    with building._temporary_folder() as folder:
        monkeypatch.setattr(os, "rmdir", raise_busy)
    monkeypatch.undo()
    folder.rmdir()


def test_ctrl_c_ends_platformio_and_its_children(clone: Path, tmp_path: Path) -> None:
    path = tmp_path / "told"
    body = f"""
child = subprocess.Popen([sys.executable, "-c", "import time; time.sleep(600)"])
open({str(path)!r} + ".new", "w").write(f"{{os.getpid()}} {{child.pid}}")
os.rename({str(path)!r} + ".new", {str(path)!r})
time.sleep(600)
"""
    environment = fake_platformio(tmp_path, body)
    environment["PYTHONPATH"] += os.pathsep + str(clone)
    run_interrupted(path, "--build", **environment).gives(2)
    for number in path.read_text().split():
        until(partial(has_ended, number), f"the end of {number}")


# -- missing parts


def test_a_missing_platformio_is_reported_with_its_installation(
    tsc: Tsc, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Here pip may not install; `tests/cli/test_fetching.py` covers the rest."""
    monkeypatch.setattr(building, "find_spec", lambda name: None)
    monkeypatch.setattr(install_advice, "install_command", lambda extra: None)
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setenv("HOME", str(tmp_path))
    result = tsc("firmware", "--build").gives(2, out="")
    assert f'pip install -e "{ROOT}[firmware]"' in result.err.replace(f"{sys.executable} -m ", "")
    assert "PlatformIO" in result.err


@pytest.mark.parametrize("place", ["bin/pio", ".platformio/penv/bin/pio"])
def test_the_platformio_of_the_editor_is_found(
    place: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(building, "find_spec", lambda name: None)
    monkeypatch.setenv("PATH", str(tmp_path / "bin"))
    monkeypatch.setenv("HOME", str(tmp_path))
    assert building.platformio() is None
    (tmp_path / place).parent.mkdir(parents=True)
    (tmp_path / place).touch(mode=0o755)
    assert building.platformio() == [str(tmp_path / place)]


def test_a_package_without_sources_names_their_origin(tmp_path: Path) -> None:
    tsc(copy_package(tmp_path), "--build").gives(2, 'pip install ".[firmware]"')


# -- how far it is


@pytest.mark.parametrize(("expected", "progress"), [
    ("Processing uno (board: uno)\n", None),
    ("Platform Manager: Installing atmelavr\n", StepProgress(FETCHING, 0, "atmelavr")),
    ("Tool Manager: Installing platformio/toolchain-atmelavr @ ~1.70300.0\nDownloading 0% 10%",
     StepProgress(FETCHING, 10, "platformio/toolchain-atmelavr")),
    ("Tool Manager: Installing a\nDownloading 100%\nTool Manager: Installing b\n",
     StepProgress(FETCHING, 0, "b")),
    ("Building in release mode\nCompiling a\nCompiling b\n", StepProgress(COMPILING, 20)),
    ("Compiling a\nWriting at 0x1... (7 %)\nWriting at 0x2... (42 %)\n", StepProgress(WRITING, 42)),
    ("Writing at 0x00010000 [===>  ] 12.5% 1/8 bytes\n", StepProgress(WRITING, 12)),
    ("Compiling a\n" * 50, StepProgress(COMPILING, 99)),
])  # fmt: skip
def test_progress_is_parsed_from_the_output(expected: str, progress: StepProgress | None) -> None:
    assert building.parse_progress(expected, 10) == progress


PLATFORM_OF_ROBOT = {"tinibot": "atmelavr", "tinibot32": "espressif32"}


@pytest.mark.parametrize("suffix", ["", "@6.9.0"])
@pytest.mark.parametrize("present_robot", PLATFORM_OF_ROBOT)
@pytest.mark.parametrize("files", [(), ("README.md",), ("README.md", "platform.json")])
@pytest.mark.parametrize(("variable", "subfolder"), [
    ("HOME", ".platformio/platforms"), ("PLATFORMIO_CORE_DIR", "platforms"),
    ("PLATFORMIO_PLATFORMS_DIR", "."),
])  # fmt: skip
def test_compilers_are_there_once_their_platform_is_whole(
    variable: str, subfolder: str, files: Sequence[str], present_robot: str, suffix: str,
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    """An interrupted download leaves a folder; what tells of all of it comes last."""
    for name in ("PLATFORMIO_CORE_DIR", "PLATFORMIO_PLATFORMS_DIR"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv(variable, str(tmp_path))
    folder = tmp_path / subfolder / f"{PLATFORM_OF_ROBOT[present_robot]}{suffix}"
    folder.mkdir(parents=True)
    for file in files:
        (folder / file).write_text("{}", encoding="utf-8")
    for name in PLATFORM_OF_ROBOT:
        is_there = name == present_robot and "platform.json" in files
        assert (building.missing_mb(robots.load(name)) == 0) == is_there


def test_a_build_needs_more_than_the_sources(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Arduino's own files follow."""
    script = tmp_path / "pretends.py"
    script.write_text(
        "from pathlib import Path\n"
        "for path in Path().rglob('*'):\n"
        "    if path.suffix in ('.cpp', '.S'):\n"
        "        print('Compiling', path)\n",
        encoding="utf-8",
    )
    monkeypatch.setattr(building, "platformio", lambda: [sys.executable, str(script)])
    sources, steps = building.sources(), list[StepProgress]()
    assert sources is not None
    with pytest.raises(building.CannotBuild):
        building.build(sources, robots.load("tinibot"), steps.append)
    assert {progress.phase for progress in steps} <= {COMPILING}, (
        "nothing is left out for what fails so"
    )
    assert 60 < steps[-1].percent < 90


# -- a robot with an ESP32: PlatformIO builds and writes it


ESP32 = """
words = sys.argv[1:]
print("Compiling .pio/build/esp32dev/src/main.cpp.o")
if "upload" in words:
    assert words[words.index("--upload-port") + 1] == os.environ["ITS_PORT"]
    print("Writing at 0x00010000... (7 %)\\nWriting at 0x00020000... (100 %)")
    code = int(os.environ["ITS_CODE"])
    os.kill(os.getpid(), -code) if code < 0 else sys.exit(code)
assert os.path.exists("partitions.csv") and "esp32dev" in words
"""


def write_firmware(clone: Path, tmp_path: Path, *words: str, code: int = 0) -> CommandResult:
    main_end, its_end = os.openpty()
    port = os.ttyname(its_end)
    environment = fake_platformio(tmp_path, ESP32)
    environment = {"PYTHONPATH": environment["PYTHONPATH"] + os.pathsep + str(clone),
                 "ITS_PORT": port, "ITS_CODE": str(code)}  # fmt: skip
    try:
        return tsc(clone, "--robot", "tinibot32", "--port", port, *words, **environment)
    finally:
        os.close(main_end)
        os.close(its_end)


def test_an_esp32_is_built_and_written_in_one_command(clone: Path, tmp_path: Path) -> None:
    result = write_firmware(clone, tmp_path)
    result.gives(3, "no robot responds", out="firmware for tinibot32 was written to the esp32dev")


@pytest.mark.parametrize("code", [1, -9])
def test_a_failed_write_of_an_esp32_is_reported(clone: Path, tmp_path: Path, code: int) -> None:
    write_firmware(clone, tmp_path, "--lang", "es", code=code).gives(2, "botón BOOT", out="")


def test_an_esp32_is_only_built_on_request(clone: Path, tmp_path: Path) -> None:
    write_firmware(clone, tmp_path, "--build", code=1).gives(0, out="the firmware is built.")
