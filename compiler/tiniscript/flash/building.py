"""Builds the firmware of a robot with PlatformIO, from the sources that are in `vm_arduino`.

It knows where sources and PlatformIO are, and how to read PlatformIO's output during a build. It
prints nothing: progress is returned as data. A build is for one robot on one board; the header
`own.h` describes the robot, whether it is a shipped one or not.
"""

from __future__ import annotations

import hashlib
import os
import re
import shutil
import sys
import tempfile
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path
from typing import NamedTuple

from tiniscript.flash import children
from tiniscript.flash.ready import is_complete_hex
from tiniscript.robots import firmware
from tiniscript.robots.profile import Robot

PACKAGE = Path(__file__).resolve().parent.parent
# A wheel contains the sources; in a clone they are next to `compiler`.
SOURCE_FOLDERS = (PACKAGE / "flash" / "vm_arduino", PACKAGE.parent.parent / "vm_arduino")
SETTINGS_FILE, PARTITIONS_FILE = "platformio.ini", "partitions.csv"
HEADER_FILE = "src/boards/kits/own.h"
HEADER_ORIGIN = "tsc firmware, from a robot profile."

FETCHING, COMPILING, WRITING = "fetching", "compiling", "writing"
# It is too large, and is built once more, without tasks or without a remote control.
WITHOUT_TASKS, WITHOUT_REMOTE = "less_tasks", "less_remote"
CORE_FILE_COUNT = 26  # approximate number of files in Arduino's core
# Environments for robots whose full firmware is too large: those with more devices than tinibot.
SMALLER_FIRMWARE = {
    "uno": ("uno_without_tasks", WITHOUT_TASKS),
    "nano": ("nano_without_remote", WITHOUT_REMOTE),
}
# Environments for robots with discs, whose code replaces the reader of text.
ENVIRONMENT_WITH_DISCS = {"uno": "uno_tinibot2", "nano": "nano_tinibot2"}
# Breakpoints are there, too: a Mega and an ESP32 have them always.
ENVIRONMENT_WITH_BREAKPOINTS = {"uno": "uno_breakpoints", "nano": "nano_breakpoints"}
PLATFORMIO_MB = 4  # measured download size of PlatformIO
# PlatformIO's downloads for a board with these chips: its platform, and the megabytes of compiler,
# core and build tools, estimated from public indexes of the archives for Linux.
_COMPILER_PACKAGES = {"esp32dev": ("espressif32", 350), "esp32c3": ("espressif32", 430)}
_AVR_COMPILER_PACKAGE = ("atmelavr", 50)

# The user's PlatformIO settings that would change the build or its folder.
_UNWANTED_LINE = re.compile(
    r"PLATFORMIO_(.*FLAGS|EXTRA_SCRIPTS|DEFAULT_ENVS|FORCE_ANSI"
    r"|(SRC|INCLUDE|LIB|DATA|TEST|BUILD|WORKSPACE|SHARED|BUILD_CACHE)_DIR)"
)
_COMPILING = re.compile(r"^Compiling ", re.M)
_INSTALLING = re.compile(r"^.*Manager: Installing (\S+)", re.M)
# Output that shows a need for the internet.
_NETWORK_MESSAGE = re.compile(r"Installing|HTTP|Internet|[Cc]onnection")
_WRITING = re.compile(r"Writing at 0x[0-9a-f]+.*?(\d+)(?:\.\d+)? ?%")  # esptool
_PERCENT = re.compile(r"(\d+)%")
_TOO_LARGE = re.compile(r"size \((\d+) bytes\) is greater than maximum allowed \((\d+) bytes")


class StepProgress(NamedTuple):
    """The current step, its progress in percent, and the name of what it downloads."""

    phase: str
    percent: int
    file_name: str = ""


class CannotBuild(Exception):
    """The reason, a name from below; the last output of PlatformIO, and the whole output."""

    NO_SOURCES, NO_PLATFORMIO = "no_sources", "no_platformio"
    UNREACHABLE, FAILED, TOO_LARGE = "unreachable", "build_failed", "too_large"
    NOT_WRITTEN = "not_written"

    def __init__(self, reason: str, last_output: str = "", log: str = "") -> None:
        super().__init__(last_output or reason)
        self.reason = reason
        self.last_output = last_output
        self.log = log


class Sources(NamedTuple):
    """The sources of a firmware without the robot: bytes by path."""

    files: Mapping[str, bytes]

    def digest(self, robot: Robot, has_breakpoints: bool = False) -> str:
        """Return a digest that is unique to these sources, this robot and its board, and whether it
        is built with breakpoints."""
        key = hashlib.sha256(f"{robot.board.chip}\n{header(robot)}".encode())
        if has_breakpoints:
            key.update(b"breakpoints\n")
        for name, data in self.files.items():
            key.update(f"{name}\n{len(data)}\n".encode() + data)
        return key.hexdigest()[:16]


def sources() -> Sources | None:
    """Return the sources, or None if this package has none."""
    for folder in SOURCE_FOLDERS:
        if (folder / SETTINGS_FILE).is_file():
            paths = [
                folder / SETTINGS_FILE,
                folder / PARTITIONS_FILE,
                *sorted((folder / "src").rglob("*")),
            ]
            names = {path.relative_to(folder).as_posix(): path for path in paths if path.is_file()}
            names.pop(HEADER_FILE, None)
            return Sources({name: path.read_bytes() for name, path in names.items()})
    return None


def header(robot: Robot) -> str:
    return firmware.header([robot], HEADER_ORIGIN)


def platformio() -> list[str] | None:
    """Return the command that runs PlatformIO: of this Python, on PATH, or of its editor."""
    if find_spec("platformio"):
        return [sys.executable, "-m", "platformio"]
    home = Path.home() / ".platformio" / "penv"
    for name in ("pio", "platformio", str(home / "bin" / "pio"), str(home / "Scripts" / "pio.exe")):
        path = shutil.which(name)
        if path:
            return [path]
    return None


def missing_mb(robot: Robot) -> int:
    """Return the approximate megabytes that PlatformIO downloads to build for a board."""
    platform, mb = _COMPILER_PACKAGES.get(robot.board.chip, _AVR_COMPILER_PACKAGE)
    core_folder = Path(os.environ.get("PLATFORMIO_CORE_DIR") or _core_folder())
    platforms_folder = Path(os.environ.get("PLATFORMIO_PLATFORMS_DIR") or core_folder / "platforms")
    return 0 if any(platforms_folder.glob(f"{platform}*/platform.json")) else mb


def _core_folder() -> Path:
    """Return PlatformIO's download folder; on Windows, a short path comes first."""
    home = Path.home() / ".platformio"
    short_folder = Path(home.drive + "\\.platformio")
    return short_folder if sys.platform == "win32" and short_folder.is_dir() else home


class _Project:
    """A folder with the sources of a firmware and the header of its robot."""

    def __init__(
        self, sources: Sources, robot: Robot, folder: Path, has_breakpoints: bool = False
    ) -> None:
        command = platformio()
        if command is None:
            raise CannotBuild(CannotBuild.NO_PLATFORMIO)
        self.folder = folder
        self.command = [*command, "run", "-d", str(folder), "-e"]
        chip = robot.board.chip
        self.environment = ENVIRONMENT_WITH_DISCS.get(chip, chip) if robot.board.discs else chip
        if has_breakpoints:
            self.environment = ENVIRONMENT_WITH_BREAKPOINTS[chip]
        self.file_count = (
            sum(name.endswith((".cpp", ".S")) for name in sources.files) + CORE_FILE_COUNT
        )
        for name, data in {**sources.files, HEADER_FILE: header(robot).encode()}.items():
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            (folder / name).write_bytes(data)

    @property
    def hex_file(self) -> Path:
        return self.folder / ".pio" / "build" / self.environment / "firmware.hex"

    def run(self, on_progress: Callable[[StepProgress], None], *words: str) -> tuple[int, str]:
        """Run PlatformIO; return its exit code, and its output.

        It runs in the folder: Python finds modules where it begins, and not in a pupil's.
        """

        def read_progress(output: str) -> None:
            if progress := parse_progress(output, self.file_count):
                on_progress(progress)

        command = [*self.command, self.environment, *words]
        return children.run(command, self.folder, read_progress, _environment())

    def build(self, on_progress: Callable[[StepProgress], None], is_hex: bool) -> None:
        exit_code, log = self.run(on_progress)
        if too_large := _TOO_LARGE.search(log):
            raise CannotBuild(CannotBuild.TOO_LARGE, "{} > {}".format(*too_large.groups()), log)
        if exit_code != 0 or (is_hex and not is_complete_hex(self.hex_file)):
            has_begun = _COMPILING.search(log) or not _NETWORK_MESSAGE.search(log)
            reason = CannotBuild.FAILED if has_begun else CannotBuild.UNREACHABLE
            raise CannotBuild(reason, children.reason(log) or f"exit code {exit_code}", log)


def can_have_breakpoints(robot: Robot) -> bool:
    """Return whether a board can have breakpoints instead of the reader of text; discs already
    replace it.
    """
    return robot.board.chip in ENVIRONMENT_WITH_BREAKPOINTS and not robot.board.discs


def build(
    sources: Sources, robot: Robot, on_progress: Callable[[StepProgress], None],
    has_breakpoints: bool = False,
) -> bytes:  # fmt: skip
    """Return the firmware of a robot for its board, an Intel HEX file.

    `on_progress` is called often. Raises CannotBuild, and OSError if there is no room to build.
    """
    with _temporary_folder() as folder:
        project = _Project(sources, robot, folder, has_breakpoints)
        try:
            project.build(on_progress, is_hex=True)
        except CannotBuild as error:
            if error.reason != CannotBuild.TOO_LARGE or project.environment not in SMALLER_FIRMWARE:
                raise
            project.environment, phase = SMALLER_FIRMWARE[project.environment]
            on_progress(StepProgress(phase, 0))
            project.build(on_progress, is_hex=True)
        return project.hex_file.read_bytes()


def upload(
    sources: Sources, robot: Robot, port: str | None, on_progress: Callable[[StepProgress], None]
) -> None:
    """Build the firmware of a robot with an ESP32, and write it to the board on a port, if any.

    PlatformIO brings the program that writes. Raises CannotBuild and OSError.
    """
    with _temporary_folder() as folder:
        project = _Project(sources, robot, folder)
        project.build(on_progress, is_hex=False)
        if port is None:
            return
        exit_code, log = project.run(on_progress, "-t", "upload", "--upload-port", port)
        if exit_code != 0:
            reason = children.reason(log) or f"exit code {exit_code}"
            raise CannotBuild(CannotBuild.NOT_WRITTEN, reason, log)


@contextmanager
def _temporary_folder() -> Iterator[Path]:
    with tempfile.TemporaryDirectory(prefix="tiniscript-", ignore_cleanup_errors=True) as folder:
        yield Path(folder)


def _environment() -> dict[str, str]:
    environment = {
        name: value for name, value in os.environ.items() if not _UNWANTED_LINE.fullmatch(name)
    }
    return {**environment, "PLATFORMIO_SETTING_ENABLE_TELEMETRY": "no"}


def parse_progress(output: str, file_count: int) -> StepProgress | None:
    """Return the progress, from its whole output; `file_count` is the total number of files."""
    percent_texts = _WRITING.findall(output)
    if percent_texts:
        return StepProgress(WRITING, min(100, int(percent_texts[-1])))
    compiled_count = len(_COMPILING.findall(output))
    if compiled_count:
        return StepProgress(COMPILING, min(99, 100 * compiled_count // file_count))
    installs = list(_INSTALLING.finditer(output))
    if installs:
        percents = _PERCENT.findall(output, installs[-1].end())
        percent = min(100, int(percents[-1])) if percents else 0
        return StepProgress(FETCHING, percent, installs[-1][1])
    return None
