"""A long text on a terminal: shown by `$PAGER`, or by `less`, a page at a time.

If the output is not a terminal, the text is short, or no pager can be started, the text is printed.
"""

from __future__ import annotations

import os
import shlex
import subprocess
import sys
from contextlib import suppress
from shutil import get_terminal_size, which

from tiniscript.cli.texts import text

# Exit codes of a shell for a command that cannot be started.
NOT_STARTED_CODES = (126, 127)


def show(text: str, language: str) -> None:
    """Show a text; a long one with a pager, until the person leaves that."""
    sys.stdout.flush()
    command = _command(language) if _needs_pager(text) else ""
    if not command or not _run_pager(text, command):
        print(text, end="")


def _needs_pager(text: str) -> bool:
    """Return whether a person uses a terminal with fewer lines than the text."""
    is_person = sys.stdin.isatty() and sys.stdout.isatty() and os.environ.get("TERM") != "dumb"
    return is_person and text.count("\n") >= get_terminal_size().lines


def _command(language: str) -> str:
    """Return the pager's command for the shell. An empty `$PAGER` means no pager.

    Without `$PAGER`, the prompt of `less` shows its keys, because the user may not know them.
    """
    command = os.environ.get("PAGER")
    if command is None:
        less_path = which("less") if os.name != "nt" else None  # consoles of Windows scroll
        keys = text("pager_keys", language).replace(":", r"\:")
        command = shlex.join([less_path, "-R", f"-Ps{keys}"]) if less_path else ""
    return command.strip()


def _run_pager(text: str, command: str) -> bool:
    """Show a text with a pager; return whether it could be started.

    Ctrl-C belongs to the pager: tsc waits until the pager has left the terminal.
    """
    environ = {"LESS": "FRX", "LESSCHARSET": "utf-8", **os.environ}
    data = text.encode(sys.stdout.encoding or "utf-8", "backslashreplace")
    try:
        pager = subprocess.Popen(command, shell=True, stdin=subprocess.PIPE, env=environ)
    except OSError:
        return False
    assert pager.stdin is not None
    while True:
        try:
            if not pager.stdin.closed:
                with suppress(OSError):  # the person has left already
                    pager.stdin.write(data)
                    pager.stdin.close()
            return pager.wait() not in NOT_STARTED_CODES
        except KeyboardInterrupt:
            continue
