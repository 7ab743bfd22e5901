"""However a child program ends, its own children no longer hold the port, and Ctrl-C works as
before.
"""

from __future__ import annotations

import signal
import subprocess
import sys
from collections.abc import Callable
from functools import partial
from pathlib import Path

import pytest

from tests.support.waiting import until
from tiniscript.flash import children

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="needs a shell")

# Starts a program with closed standard streams, and continues as its last argument says.
PARENT_SCRIPT = 'sleep 3600 </dev/null >/dev/null 2>&1 & echo $! > "$1"; echo begun; {}'


class ProgressError(Exception):
    """The look at it has failed."""


def let_continue(text: str) -> None:
    """Let the program continue."""


def break_at_begin(text: str) -> None:
    if "begun" in text:
        raise ProgressError


def interrupt_at_begin(text: str) -> None:
    if "begun" in text:
        raise KeyboardInterrupt


FIRST_WAITS_FOR_END = "it may not be ended, as what writes a firmware"
CHILD_ENDS: dict[str, tuple[str, Callable[[str], None], type[BaseException] | None]] = {
    "it ends well": ("true", let_continue, None),
    "it fails": ("exit 3", let_continue, None),
    "it is killed": ("kill -9 $$", let_continue, None),
    "it closes its ends and stays": ("exec sleep 3600 >&- 2>&-", let_continue,
                                     subprocess.TimeoutExpired),
    "it is not waited for": ("sleep 3600", break_at_begin, ProgressError),
    "Ctrl-C": ("sleep 3600", interrupt_at_begin, KeyboardInterrupt),
    "it takes no Ctrl-C": ("trap '' INT; sleep 3600", break_at_begin, ProgressError),
    FIRST_WAITS_FOR_END: ("sleep 0.2", break_at_begin, ProgressError),
}  # fmt: skip


def is_over(process: int) -> bool:
    """Return whether it has ended, even as a zombie."""
    completed = subprocess.run(
        ["ps", "-o", "stat=", "-p", str(process)], capture_output=True, text=True
    )
    return completed.stdout.strip()[:1] in ("", "Z")


@pytest.mark.parametrize("end_kind", CHILD_ENDS)
def test_no_child_process_is_left(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, end_kind: str
) -> None:
    end, on_output, failure = CHILD_ENDS[end_kind]
    monkeypatch.setattr(children, "KILL_DELAY_S", 0.2)
    for round_ in range(2):  # the second one as the first one
        noted_path = tmp_path / f"{round_}"
        words = ["sh", "-c", PARENT_SCRIPT.format(end), "sh", str(noted_path)]
        if failure is None:
            code, text = children.run(words, None, on_output)
            assert text == "begun\n" and (code == 0) == (end_kind == "it ends well")
        else:
            with pytest.raises(failure):
                children.run(
                    words, None, on_output, None, lambda _: end_kind != FIRST_WAITS_FOR_END, 0.2
                )
        child = int(noted_path.read_text(encoding="utf-8"))
        until(partial(is_over, child), "what it has started ends")


# Exceptions of Popen for a program that cannot be started.
REFUSALS = (FileNotFoundError, PermissionError, MemoryError, ValueError)


@pytest.mark.parametrize("is_pressed", [False, True], ids=["", "Ctrl-C meanwhile"])
@pytest.mark.parametrize("refusal", REFUSALS)
def test_ctrl_c_works_if_no_process_could_be_started(
    monkeypatch: pytest.MonkeyPatch, refusal: type[Exception], is_pressed: bool
) -> None:
    def refuse(*_: object, **__: object) -> None:
        if is_pressed:
            signal.raise_signal(signal.SIGINT)
        raise refusal

    monkeypatch.setattr(subprocess, "Popen", refuse)
    failure = children.CannotStart if issubclass(refusal, OSError) else refusal
    for _ in range(2):  # the second one as the first one
        with pytest.raises(KeyboardInterrupt if is_pressed else failure):
            children.run(["none"], None, let_continue)
        with pytest.raises(KeyboardInterrupt):
            signal.raise_signal(signal.SIGINT)
