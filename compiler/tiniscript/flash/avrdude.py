"""Runs avrdude, which writes a firmware through a bootloader: finds it and reads its messages.

Knows its messages from version 6.3 on. It prints nothing: progress and outcome are returned as
data.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from time import monotonic
from typing import NamedTuple

from tiniscript.flash import children
from tiniscript.flash.bootloaders import Bootloader

# Timeouts without output: before a bootloader has answered, and after that.
NO_ANSWER_TIMEOUT_S, SILENCE_TIMEOUT_S = 15.0, 30.0
EXIT_TIMEOUT_S = 5.0  # time to exit after its last output
RUN_TIMEOUT_S = (
    300.0  # timeout of the whole run: writing and reading back a Mega's 256 KB takes 50 s
)
MAX_OUTPUT_BYTES = 200_000  # limit of its output; about 2,000 are normal
MAX_ATTEMPTS = 2  # attempts before giving up; avrdude would make ten, of five seconds each
BAR_MARKS = 50  # marks of a full bar

WRITING, READING = "writing", "reading"
# The possible outcomes.
DONE, NOBODY, OTHER_CHIP, DIFFERS = "done", "nobody", "other_chip", "differs"
PORT_FAILED, BROKEN_OFF, FAILED, ENDLESS = "port", "broken_off", "failed", "endless"
OUTCOMES = (DONE, NOBODY, OTHER_CHIP, DIFFERS, PORT_FAILED, BROKEN_OFF, FAILED, ENDLESS)

_PROGRESS_BAR = re.compile(r"(Writing|Reading)[^|\n]*\|[ \r]*(#*)")
_ATTEMPT = re.compile(r"attempt (\d+) of")
_CAUSES = (
    (OTHER_CHIP, r"expected signature|invalid device signature|signature .*(?:mismatch|wrong)"),
    (DIFFERS, r"verification (?:error|mismatch)|content mismatch|failed to verify"),
    (PORT_FAILED, r"(?:can't|cannot|unable to) open (?:device|port|serial)|permission denied"),
    (NOBODY, r"not in sync|not responding|timeout|cannot set sck|unable to open programmer"
     r"|initialization failed|protocol error|can't communicate"),
)  # fmt: skip


class WriteResult(NamedTuple):
    """The outcome, a name from above, and the last lines of output if they help."""

    outcome: str
    output: str = ""


class StepProgress(NamedTuple):
    """The current step, and its progress in percent."""

    phase: str
    percent: int


def find_avrdude() -> list[str] | None:
    """Return the command that runs avrdude: from PATH, or where other programs have put it."""
    path = shutil.which("avrdude")
    if path:
        return [path]
    if sys.platform == "win32":  # distributed as a package of its own
        try:
            from avrdude_windows import get_avrdude_path
        except ImportError:
            pass
        else:
            return [str(get_avrdude_path())]
    for program in _bundled_avrdudes(Path.home()):
        for folder in (program.parent.parent / "etc", program.parent):
            if (folder / "avrdude.conf").is_file():
                return [str(program), "-C", str(folder / "avrdude.conf")]
    return None


def _bundled_avrdudes(home: Path) -> list[Path]:
    """Return the avrdudes of the Arduino IDE and of PlatformIO, the newest first."""
    name = "avrdude.exe" if sys.platform == "win32" else "avrdude"
    folders = [home / ".arduino15", home / "Library" / "Arduino15"]
    if os.environ.get("LOCALAPPDATA"):
        folders.append(Path(os.environ["LOCALAPPDATA"]) / "Arduino15")
    programs: list[Path] = []
    for folder in folders:
        tools = folder / "packages" / "arduino" / "tools" / "avrdude"
        programs += sorted(tools.glob(f"*/bin/{name}"), key=_version, reverse=True)
    platformio = home / ".platformio" / "packages" / "tool-avrdude"
    return [*programs, *sorted(platformio.glob(f"**/{name}"))]


def _version(program: Path) -> list[int]:
    """Return the numbers in the name of a program's folder, as in `6.3.0-arduino17`."""
    return [int(number) for number in re.findall(r"\d+", program.parent.parent.name)]


def write(
    command: list[str],
    bootloader: Bootloader,
    port: str,
    firmware: Path,
    on_progress: Callable[[StepProgress | None], None],
) -> WriteResult:
    """Write a firmware, read it back, and compare. `on_progress` is called periodically."""
    arguments = [
        *command,
        "-c",
        bootloader.programmer,
        "-p",
        bootloader.part,
        "-P",
        port,
        "-b",
        str(bootloader.baud),
        "-D",
    ]
    arguments += ["-U", f"flash:w:{firmware}:i"]
    try:
        exit_code, output = children.run(
            arguments, None, _Watch(on_progress), exit_timeout_s=EXIT_TIMEOUT_S
        )
    except _GivenUp as given_up:
        return given_up.result
    except subprocess.TimeoutExpired:
        return WriteResult(ENDLESS)
    except children.CannotStart as error:
        return WriteResult(FAILED, str(error.strerror or error))
    return result_of(exit_code, output)


class _GivenUp(Exception):
    """Raised when the wait for a program is over."""

    def __init__(self, outcome: str) -> None:
        super().__init__(outcome)
        self.result = WriteResult(outcome)


class _Watch:
    """Looks at its whole output again and again. Raises _GivenUp."""

    def __init__(self, on_progress: Callable[[StepProgress | None], None]) -> None:
        self._on_progress = on_progress
        self._output = ""
        self._began_s = self._output_s = monotonic()

    def __call__(self, output: str) -> None:
        now_s, progress = monotonic(), parse_progress(output)
        self._on_progress(progress)
        if output != self._output:
            self._output, self._output_s = output, now_s
        if now_s - self._began_s >= RUN_TIMEOUT_S or len(output) > MAX_OUTPUT_BYTES:
            raise _GivenUp(ENDLESS)
        if progress is not None:
            if now_s - self._output_s >= SILENCE_TIMEOUT_S:
                raise _GivenUp(BROKEN_OFF)
        elif now_s - self._output_s >= NO_ANSWER_TIMEOUT_S or _attempt(output) >= MAX_ATTEMPTS:
            raise _GivenUp(NOBODY)


def _attempt(output: str) -> int:
    """Return the number of its last attempt."""
    return max(map(int, _ATTEMPT.findall(output)), default=0)


def parse_progress(output: str) -> StepProgress | None:
    """Return the progress, from its whole output."""
    bars = _PROGRESS_BAR.findall(output)
    step_names = [name for name, _ in bars]
    if "Writing" not in step_names:
        return None  # the bar before that is for the signature
    name, marks = bars[-1]
    phase = READING if name == "Reading" else WRITING
    return StepProgress(phase, min(100, 100 * len(marks) // BAR_MARKS))


def result_of(exit_code: int, output: str) -> WriteResult:
    """Return the outcome, from its exit code and its whole output."""
    if exit_code == 0:
        return WriteResult(DONE)
    began_to_write = parse_progress(output) is not None
    for outcome_name, pattern in _CAUSES:
        if re.search(pattern, output, re.IGNORECASE):
            if began_to_write and outcome_name != DIFFERS:
                return WriteResult(BROKEN_OFF)
            return WriteResult(outcome_name)
    rows = [row.strip() for row in output.splitlines() if row.strip() and "done." not in row]
    if began_to_write:
        return WriteResult(BROKEN_OFF)
    return WriteResult(
        FAILED, rows[-1].removeprefix("avrdude: ") if rows else f"exit code {exit_code}"
    )
