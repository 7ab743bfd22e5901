"""Something is missing, and this computer can fetch it: how much that is, a question, the progress.

Knows pip, and how a program that fetches is watched. It does not know what is missing.
"""

from __future__ import annotations

import os
import re
import sys
import tempfile
from argparse import Namespace
from collections.abc import Callable, Mapping, Sequence
from importlib import invalidate_caches
from pathlib import Path
from time import monotonic
from typing import NamedTuple

from tiniscript.base import files
from tiniscript.cli.errors import CommandError
from tiniscript.cli.inputs import printable_name
from tiniscript.cli.terminal.asking import can_ask, confirm
from tiniscript.cli.terminal.progress import Progress
from tiniscript.cli.texts import text
from tiniscript.flash import children
from tiniscript.library import install_advice

LOG_FILE = "fetch.log"  # output of the last program that failed, in the cache folder
MEASURE_INTERVAL_S = 1.0
# Printed by pip once it has downloaded everything.
INSTALLING_MESSAGE = "Installing collected packages"
_NO_ROOM = re.compile(r"ENOSPC|No space left", re.IGNORECASE)
_OFFLINE = re.compile(
    r"ENOTFOUND|EAI_AGAIN|ECONN|ETIMEDOUT|EHOSTUNREACH|ENETUNREACH|connection|No matching dist"
)


class Part(NamedTuple):
    """A download: `key` names its texts, `mb` is its approximate size in megabytes."""

    key: str
    mb: int


class Step(NamedTuple):
    """The current step: the key of its texts, and its progress in percent."""

    key: str
    percent: int


class FolderProgress:
    """The growth of a folder, in percent of `mb`, while another program fills it."""

    def __init__(self, folder: Path, mb: int) -> None:
        self.folder, self.mb = folder, mb
        self._percent, self._next_measure_s = 0, 0.0

    def percent(self) -> int:
        if monotonic() >= self._next_measure_s:
            measured_percent = size_of(self.folder) // (10_000 * self.mb)
            self._percent = min(
                99, max(self._percent, measured_percent)
            )  # files that were put away count as fetched
            self._next_measure_s = monotonic() + MEASURE_INTERVAL_S
        return self._percent


def size_of(folder: Path) -> int:
    """Return the bytes of a folder's files; those that go away meanwhile do not count."""
    size_bytes = 0
    for path, _, names in os.walk(folder):
        for name in names:
            try:
                size_bytes += os.lstat(os.path.join(path, name)).st_size  # noqa: PTH118, is called often
            except OSError:
                continue
    return size_bytes


def ask_to_fetch(
    missing_text: str, parts: Sequence[Part], minutes: int, options: Namespace, language: str
) -> None:
    """Print the missing parts and the downloads, and ask. Raises CommandError without a yes."""
    parts_text = ", ".join(text(part.key, language).format(mb=part.mb) for part in parts)
    values = {
        "mb": str(sum(part.mb for part in parts)),
        "parts": parts_text,
        "minutes": str(minutes),
    }
    sentence = (
        f"{missing_text} {text('fetch_size' if parts else 'fetch_none', language).format(**values)}"
    )
    if not options.yes and not can_ask():
        raise CommandError(2, "fetch_unasked", said=sentence)
    print(sentence, file=sys.stderr, flush=True)
    if not options.yes and not confirm(text("fetch_asks", language)):
        raise CommandError(2, "fetch_declined")


def install(extra: str, part: Part, language: str) -> None:
    """Install the packages of an extra for this Python, which can. Raises CommandError."""
    command = install_advice.install_command(extra)
    assert command is not None, extra
    with tempfile.TemporaryDirectory(prefix="tiniscript-", dir=sys.prefix) as scratch:
        progress = FolderProgress(Path(scratch), part.mb)
        # It fetches into the folder for temporary files: this one, which can be measured.
        variables = {**os.environ, **dict.fromkeys(("TMPDIR", "TEMP", "TMP"), scratch)}
        run(
            command,
            Path(scratch),
            lambda output: Step(f"{part.key}_now", progress.percent()),
            language,
            variables,
            lambda output: INSTALLING_MESSAGE not in output,  # half of a package looks whole
        )
    invalidate_caches()  # this process has cached that the package was missing


def run(
    command: list[str],
    folder: Path,
    read_step: Callable[[str], Step],
    language: str,
    environment: Mapping[str, str] | None = None,
    may_end: Callable[[str], bool] = lambda output: True,
) -> None:
    """Run a program that fetches or builds, and show how far it is. Raises CommandError."""
    progress = Progress(language, 100)
    step_key = ""

    def show_progress(output: str) -> None:
        nonlocal step_key
        step = read_step(output)
        if step.key != step_key:
            step_key = step.key
            progress.end()
            progress.label = text(step_key, language)
            if not sys.stderr.isatty():
                print(f"{progress.label} …", file=sys.stderr, flush=True)
        progress.draw(step.percent)

    try:
        exit_code, log = children.run(command, folder, show_progress, environment, may_end)
    except children.CannotStart as error:
        exit_code, log = 1, str(error)
    finally:
        progress.end()
    if exit_code:
        raise _failure(text(step_key, language) if step_key else command[0], log)


def _failure(step_text: str, log: str) -> CommandError:
    """Return the sentence for a program that has failed, and keep its output."""
    log_path = files.cache_folder() / LOG_FILE
    # If the file cannot be written, the message has no path.
    files.keep(log_path, log.encode("utf-8", "replace"))
    key_patterns = (("fetch_no_room", _NO_ROOM), ("fetch_offline", _OFFLINE))
    key = next((key for key, pattern in key_patterns if pattern.search(log)), "fetch_failed")
    cause = printable_name(children.reason(log))
    return CommandError(2, key, doing=step_text, why=cause, log=printable_name(str(log_path)))
