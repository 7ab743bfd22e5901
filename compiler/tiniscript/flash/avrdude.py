"""Runs avrdude, which writes a firmware through a bootloader: finds it and reads its messages.

Knows its messages from version 6.3 on. Prints nothing: progress and outcome are returned as data.
"""

from __future__ import annotations

import os
import re
import shutil
import signal
import subprocess
import sys
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from queue import Empty, SimpleQueue
from threading import Thread
from time import monotonic
from typing import IO, NamedTuple

from tiniscript.flash.bootloaders import Bootloader

# Timeouts without output: before a bootloader has answered, and after that.
NOBODY_S, SILENCE_S = 15.0, 30.0
WHOLE_S = 300.0  # timeout of the whole run: writing and reading back a Mega's 256 KB takes 50 s
MOST_BYTES = 200_000  # limit of its output; about 2,000 are normal
LEAVE_S = 5.0  # timeout of its exit after its last output
LOOK_S = 0.1
MOST_ATTEMPTS = 2  # of its ten, which take five seconds each
MARKS = 50  # of a whole bar

WRITING, READING = "writing", "reading"
# How it may end.
DONE, NOBODY, OTHER_CHIP, DIFFERS = "done", "nobody", "other_chip", "differs"
PORT, BROKEN_OFF, FAILED, ENDLESS = "port", "broken_off", "failed", "endless"
ENDS = (DONE, NOBODY, OTHER_CHIP, DIFFERS, PORT, BROKEN_OFF, FAILED, ENDLESS)

_BAR = re.compile(r"(Writing|Reading)[^|\n]*\|[ \r]*(#*)")
_ATTEMPT = re.compile(r"attempt (\d+) of")
_CAUSES = (
    (OTHER_CHIP, r"expected signature|invalid device signature|signature .*(?:mismatch|wrong)"),
    (DIFFERS, r"verification (?:error|mismatch)|content mismatch|failed to verify"),
    (PORT, r"(?:can't|cannot|unable to) open (?:device|port|serial)|permission denied"),
    (NOBODY, r"not in sync|not responding|timeout|cannot set sck|unable to open programmer"
     r"|initialization failed|protocol error|can't communicate"),
)  # fmt: skip


class Ended(NamedTuple):
    """The outcome, a name from above, and the last lines of output if they help."""

    how: str
    said: str = ""


class Seen(NamedTuple):
    """The current step, and its progress in percent."""

    phase: str
    percent: int


def found() -> list[str] | None:
    """Return the command that runs avrdude: from PATH, or where other programs have put it."""
    on_path = shutil.which("avrdude")
    if on_path:
        return [on_path]
    if sys.platform == "win32":  # comes as a package of its own
        try:
            from avrdude_windows import get_avrdude_path
        except ImportError:
            pass
        else:
            return [str(get_avrdude_path())]
    for program in _elsewhere(Path.home()):
        for settings in (program.parent.parent / "etc", program.parent):
            if (settings / "avrdude.conf").is_file():
                return [str(program), "-C", str(settings / "avrdude.conf")]
    return None


def _elsewhere(home: Path) -> list[Path]:
    """Return the avrdudes of the Arduino IDE and of PlatformIO, the newest first."""
    name = "avrdude.exe" if sys.platform == "win32" else "avrdude"
    folders = [home / ".arduino15", home / "Library" / "Arduino15"]
    if os.environ.get("LOCALAPPDATA"):
        folders.append(Path(os.environ["LOCALAPPDATA"]) / "Arduino15")
    programs: list[Path] = []
    for folder in folders:
        tools = folder / "packages" / "arduino" / "tools" / "avrdude"
        programs += sorted(tools.glob(f"*/bin/{name}"), reverse=True)
    platformio = home / ".platformio" / "packages" / "tool-avrdude"
    return [*programs, *sorted(platformio.glob(f"**/{name}"))]


def write(
    command: list[str],
    to: Bootloader,
    port: str,
    firmware: Path,
    look: Callable[[Seen | None], None],
) -> Ended:
    """Write a firmware, read it back, and compare. `look` is called periodically."""
    words = [*command, "-c", to.programmer, "-p", to.part, "-P", port, "-b", str(to.baud), "-D"]
    try:
        running = subprocess.Popen(
            [*words, "-U", f"flash:w:{firmware}:i"],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            start_new_session=sys.platform != "win32",  # so that its children end with it
        )
    except OSError as why:
        return Ended(FAILED, str(why.strerror or why))
    try:
        return _watched(running, look)
    finally:
        _kill(running)


def _kill(running: subprocess.Popen[bytes]) -> None:
    """End it and all that it has started: a child would keep the port."""
    with suppress(OSError):  # it has ended, and nothing is left of it
        if sys.platform != "win32":
            os.killpg(running.pid, signal.SIGKILL)
        elif running.poll() is None:
            words = ["taskkill", "/F", "/T", "/PID", str(running.pid)]
            subprocess.run(words, capture_output=True, check=False)
    running.kill()
    running.wait()


def _watched(running: subprocess.Popen[bytes], look: Callable[[Seen | None], None]) -> Ended:
    assert running.stdout
    heard: SimpleQueue[bytes] = SimpleQueue()
    Thread(target=_listen, args=(running.stdout, heard), daemon=True).start()
    output, said, silent_s, end_s = b"", "", 0.0, monotonic() + WHOLE_S
    while True:
        if monotonic() >= end_s or len(output) > MOST_BYTES:
            return Ended(ENDLESS)
        try:
            data = heard.get(timeout=LOOK_S)
        except Empty:
            silent_s += LOOK_S
            look(seen(said))
            has_begun = seen(said) is not None
            if silent_s >= (SILENCE_S if has_begun else NOBODY_S):
                return Ended(BROKEN_OFF if has_begun else NOBODY)
            continue
        if not data:
            try:
                return outcome(running.wait(LEAVE_S), said)
            except subprocess.TimeoutExpired:
                return Ended(ENDLESS)
        silent_s = 0.0
        output += data
        said = output.decode(errors="replace")
        look(seen(said))
        attempts = [int(number) for number in _ATTEMPT.findall(said)]
        if attempts and attempts[-1] >= MOST_ATTEMPTS and seen(said) is None:
            return Ended(NOBODY)


def _listen(pipe: IO[bytes], heard: SimpleQueue[bytes]) -> None:
    """Pass its output on in pieces; an empty piece marks the end.

    Stops after MOST_BYTES: the rest is not read. Closes the pipe itself: closed by another thread,
    its number may be that of the port that is opened next, whose bytes would be read here.
    """
    said_bytes = 0
    with pipe:
        while said_bytes <= MOST_BYTES:
            data = os.read(pipe.fileno(), 4096)
            heard.put(data)
            said_bytes += len(data)
            if not data:
                return


def seen(said: str) -> Seen | None:
    """Return the progress, from its whole output."""
    bars = _BAR.findall(said)
    names = [name for name, _ in bars]
    if "Writing" not in names:
        return None  # the bar before that is for the signature
    name, marks = bars[-1]
    phase = READING if name == "Reading" else WRITING
    return Seen(phase, min(100, 100 * len(marks) // MARKS))


def outcome(code: int, said: str) -> Ended:
    """Return the outcome, from its exit code and its whole output."""
    if code == 0:
        return Ended(DONE)
    began_to_write = seen(said) is not None
    for how, pattern in _CAUSES:
        if re.search(pattern, said, re.IGNORECASE):
            if began_to_write and how != DIFFERS:
                return Ended(BROKEN_OFF)
            return Ended(how)
    rows = [row.strip() for row in said.splitlines() if row.strip() and "done." not in row]
    if began_to_write:
        return Ended(BROKEN_OFF)
    return Ended(FAILED, rows[-1].removeprefix("avrdude: ") if rows else f"exit code {code}")
