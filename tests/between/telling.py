"""A command's output at a terminal, with times and silences.

Time goes by as on the wall, or slower where this computer is busy.
"""

from __future__ import annotations

import os
import re
import time
from collections.abc import Mapping, Sequence
from contextlib import suppress
from itertools import pairwise
from pathlib import Path
from threading import Thread

from tests.support.command import rest_of
from tests.support.terminal import Terminal

STEP_S = 0.01
LONGEST_S = 0.05  # longest step between two looks at the clock
ESCAPED = re.compile(r"\x1b\[[0-9;?]*[A-Za-z]")
# Messages about a continuing action or a wait, valid until the next message.
STANDING = re.compile(r"…$|…Asking [^…]*$|: running$|Ctrl-C|hold its start button")

ADVICE = "Try:"  # belongs to the line above it
# Prefix of lines that it reads as text, such as the rest of a frame after a reset.
ROBOT = "The robot says:"


class Clock:
    """Stands while this process gets no time."""

    def __init__(self) -> None:
        self.now_s = 0.0
        Thread(target=self._run, daemon=True).start()

    def _run(self) -> None:
        last_s = time.monotonic()
        while True:
            time.sleep(STEP_S)
            now_s = time.monotonic()
            self.now_s += min(now_s - last_s, LONGEST_S)
            last_s = now_s

    def wait(self, seconds: float) -> None:
        end_s = self.now_s + seconds
        while self.now_s < end_s:
            time.sleep(STEP_S)


CLOCK = Clock()


def own_folders(folder: str) -> dict[str, str]:
    names = {"XDG_CACHE_HOME": "cache", "XDG_CONFIG_HOME": "settings"}
    made = {name: str(Path(folder) / value) for name, value in names.items()}
    return {**made, "LC_ALL": "C.UTF-8"}


class Teller(Terminal):
    """A command at a terminal of its own."""

    def __init__(self, words: Sequence[str], env: Mapping[str, str]) -> None:
        self.began_s = CLOCK.now_s  # also set at the first byte or at the connection
        self.timed_output: list[tuple[float, str]] = []  # "" is a person's action
        self.ended_s: float | None = None
        self.suspended: list[tuple[float, float]] = []
        super().__init__(*words, env=env, size=(300, 24))

    def _read_on(self) -> None:
        part = b"begun"
        while part:
            part = rest_of(self._our_end)
            if part:
                self.output_bytes += part
                self.timed_output.append((CLOCK.now_s, part.decode(errors="replace")))
        self.process.wait()
        self.ended_s = CLOCK.now_s

    def interrupt(self) -> None:
        self.timed_output.append((CLOCK.now_s, ""))
        super().interrupt()

    def end(self) -> int:
        """End it, if it is still running; return its exit code."""
        if self.process.poll() is None:
            self.process.kill()
        self._reader.join()
        os.close(self._our_end)
        return self.process.wait()

    def wait(self, timeout_s: float) -> bool:
        """Wait until it has ended; return whether it has."""
        end_s = CLOCK.now_s + timeout_s
        while self.ended_s is None and CLOCK.now_s < end_s:
            time.sleep(STEP_S)
        return self.ended_s is not None

    def has_socket(self) -> bool:
        """Return whether it is connected to another command."""
        with suppress(OSError):
            files = Path(f"/proc/{self.process.pid}/fd").iterdir()
            return any(str(file.readlink()).startswith("socket:") for file in files)
        return False

    def has_said(self, pattern: str) -> bool:
        return re.search(pattern, self.text) is not None

    @property
    def text(self) -> str:
        return ESCAPED.sub("", "".join(text for _, text in list(self.timed_output)))

    @property
    def shown_lines(self) -> list[str]:
        """The lines left on the screen: the last state of each redrawn line."""
        lines: list[str] = []
        for line in self.text.replace("\r\n", "\n").split("\n"):
            shown_texts = [part.strip() for part in line.split("\r") if part.strip()]
            lines += shown_texts[-1:]
        return lines

    def repeated_lines(self) -> list[str]:
        """Return repeated lines; those about a wait may repeat after another line."""
        parts = re.findall(r"([^\r\n]+)(\r*\n|\r|$)", self.text)
        words = [(text.strip(), end) for text, end in parts
                 if text.strip() and not text.strip().startswith(ROBOT)]  # fmt: skip
        announced_waits = [word for (word, end), (after, _) in pairwise(words)
                   if word == after and end.endswith("\n")]  # fmt: skip
        own_lines = [line for line in self.shown_lines if not line.startswith((ADVICE, ROBOT))]
        others = [line for line in own_lines if not STANDING.search(line)]
        return sorted({*announced_waits, *(line for line in others if others.count(line) > 1)})

    def longest_silence_s(self) -> float:
        """Return the longest silence, except during announced waits.

        It counts from the first byte on: how long a process takes to begin is another question.
        """
        assert self.ended_s is not None
        last_s, is_standing, longest_s = self.began_s, False, 0.0
        for at_s, text in [*self.timed_output, (self.ended_s, "")]:
            parts = [part.strip() for part in re.split(r"[\r\n]", ESCAPED.sub("", text))]
            parts = [part for part in parts if part]
            if not parts and text:
                continue  # a line is cleared
            if not is_standing:
                away_s = sum(
                    max(0.0, min(end_s, at_s) - max(begin_s, last_s))
                    for begin_s, end_s in self.suspended
                )
                longest_s = max(longest_s, at_s - last_s - away_s)
            last_s = at_s
            is_standing = bool(parts) and STANDING.search(parts[-1]) is not None
        return longest_s
