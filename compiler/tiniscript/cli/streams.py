"""The abilities of an output: its characters, its width, colors and a moving cursor.

A console window of Windows shows every character, but output to a file or a pipe is in cp1252,
cp850 or another code page, without Ω, arrows and dots. A sign that has a plain counterpart becomes
it; any other character becomes its number, as `\\u03c0`.

Terminals of Unix read sequences. A console of Windows 10 or newer does when it is asked to:
PowerShell and the Windows Terminal ask for the commands they start, cmd only for itself, and then a
command that does not ask prints `←[1;31m`.
"""

from __future__ import annotations

import codecs
import os
import re
import stat
import sys
from time import monotonic
from typing import Any, TextIO

from tiniscript.cli.texts import Sentence

READER_TIMEOUT_S = 1.0  # timeout for a reader when a command is interrupted
ERROR_HANDLER = "tiniscript_plain"  # name of the error handler
# Replacements for drawings; each is as wide as its original.
_SAME_WIDTH = ("│─├┤█▌▐♪↑↖←↙↓↘→↗", "|-||#==~^\\</v\\>/")
DRAWING_SUBSTITUTES = str.maketrans(_SAME_WIDTH[0] + "…", _SAME_WIDTH[1] + ".")
_SUBSTITUTE_WORDS = {
    "Ω": "ohm", "−": "-", "–": "-", "—": "-", "…": "...", "‘": "'", "’": "'", "“": '"',
    "”": '"', "×": "x", "\N{REPLACEMENT CHARACTER}": "?",
}  # fmt: skip
PLAIN_SUBSTITUTES = {**dict(zip(*_SAME_WIDTH, strict=True)), **_SUBSTITUTE_WORDS}


def register() -> None:
    """Make the handler known to Python's streams."""
    codecs.register_error(ERROR_HANDLER, _replacement)


def _replacement(error: UnicodeError) -> tuple[str | bytes, int]:
    if isinstance(error, UnicodeEncodeError):
        end = error.start + 1
        substitute = PLAIN_SUBSTITUTES.get(error.object[error.start : end])
        if substitute is not None:
            return substitute, end
        error.end = end
    return codecs.backslashreplace_errors(error)


# Flag of SetConsoleMode.
PROCESSED_OUTPUT = 0x0001
VIRTUAL_TERMINAL_PROCESSING = 0x0004


def reads_sequences(stream: TextIO) -> bool:
    """Return whether sequences that are written to a stream are read. Asks the console to."""
    if not stream.isatty():
        return False
    if sys.platform != "win32":
        return True
    import ctypes
    import msvcrt
    from ctypes import wintypes

    console = ctypes.windll.kernel32
    mode = wintypes.DWORD()
    try:
        handle = wintypes.HANDLE(msvcrt.get_osfhandle(stream.fileno()))
    except (OSError, ValueError):  # no file of the system
        return False
    if not console.GetConsoleMode(handle, ctypes.byref(mode)):  # a device such as NUL
        return False
    if mode.value & VIRTUAL_TERMINAL_PROCESSING:
        return True
    new_mode = mode.value | PROCESSED_OUTPUT | VIRTUAL_TERMINAL_PROCESSING
    return bool(console.SetConsoleMode(handle, wintypes.DWORD(new_mode)))


def has_colors(stream: TextIO) -> bool:
    """Return whether a stream shows colors, and the person has not declined them."""
    return not os.environ.get("NO_COLOR") and reads_sequences(stream)


def drop_unread_output() -> None:
    """Redirect outputs without a reader to the null device, so that an interrupted command neither
    writes to them nor waits.

    A pipe whose reader is merely slow accepts the output within READER_TIMEOUT_S.
    """
    if sys.platform == "win32":
        return
    for stream in (sys.stdout, sys.stderr):
        try:
            descriptor = stream.fileno()
            is_pipe = stat.S_ISFIFO(os.fstat(descriptor).st_mode)
        except (OSError, ValueError, AttributeError):  # no file of the system, or closed
            continue
        if is_pipe and not _write_all(stream, descriptor):
            null_descriptor = os.open(os.devnull, os.O_WRONLY)
            os.dup2(null_descriptor, descriptor)
            os.close(null_descriptor)


def raise_if_reader_gone() -> None:
    """Raise BrokenPipeError if the reader of the output has gone: a process that writes nothing
    does not notice. Windows does not report this."""
    if sys.platform == "win32":
        return
    try:
        descriptor = sys.stdout.fileno()
        mode = os.fstat(descriptor).st_mode
    except (OSError, ValueError, AttributeError):  # no file of the system, or closed
        return
    if not (stat.S_ISFIFO(mode) or stat.S_ISSOCK(mode)):
        return
    import select  # asked only if there may be no output for long

    poller = select.poll()
    poller.register(descriptor, 0)
    if poller.poll(0):
        raise BrokenPipeError


def _write_all(stream: TextIO, pipe: int) -> bool:
    """Write the pending output to a pipe; return whether all of it was accepted in time."""
    if sys.platform == "win32":
        return False
    import select  # the module may have been interrupted while loading

    end_s = monotonic() + READER_TIMEOUT_S
    os.set_blocking(pipe, False)
    try:
        while True:
            try:
                stream.flush()
            except BlockingIOError:
                left_s = end_s - monotonic()
                if left_s <= 0 or not select.select([], [pipe], [], left_s)[1]:
                    return False
            else:
                # less than this may be taken at once: then the next row would wait
                return bool(select.select([], [pipe], [], max(0, end_s - monotonic()))[1])
    except OSError:  # the reader has closed the pipe: that has its own exit code
        return True
    finally:
        os.set_blocking(pipe, True)


class WrappingStream:
    """A terminal that breaks each `Sentence` at its width. Frames and tables do not count."""

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)

    def write(self, text: str) -> int:
        if isinstance(text, Sentence):
            from shutil import get_terminal_size

            text = wrap(text, get_terminal_size().columns)
        return self._stream.write(text)


# A command, or a sentence: it stays in one row if there is room. People copy a command: one that
# begins with the path of a program is never broken.
_COMMAND = re.compile(r"(?<=[^ ] {2})[^ \n]+(?: [^ \n]+)*")


def wrap(sentence: str, columns: int) -> str:
    """Return a sentence in rows; text after two blanks is a command."""
    from textwrap import fill

    def keep_spaces(match: re.Match[str]) -> str:
        fits = len(match[0]) < columns or os.sep in match[0].partition(" ")[0]
        return match[0].replace(" ", "\0") if fits else match[0]

    rows = []
    for row in _COMMAND.sub(keep_spaces, sentence).split("\n"):
        indent = row[: len(row) - len(row.lstrip(" "))]
        wrapped_row = fill(row, columns, replace_whitespace=False, subsequent_indent=indent,
                      break_long_words=False, break_on_hyphens=False)  # fmt: skip
        rows.append(wrapped_row if len(row) > columns else row)
    return "\n".join(rows).replace("\0", " ")
