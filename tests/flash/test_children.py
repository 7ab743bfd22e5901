"""However a child program ends, its own children no longer hold the port, and Ctrl-C works as
before.
"""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path
from random import Random

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


def run_in_thread(command: list[str], folder: Path, variables: dict[str, str]) -> tuple[int, str]:
    with ThreadPoolExecutor(1) as pool:
        return pool.submit(children.run, command, folder, let_continue, variables).result()


def run_here(command: list[str], folder: Path, variables: dict[str, str]) -> tuple[int, str]:
    return children.run(command, folder, let_continue, variables)


@pytest.fixture
def typed_line() -> Iterator[None]:
    """Somebody has typed a line."""
    stdin, (reader, writer) = os.dup(0), os.pipe()
    os.write(writer, b"typed\n")
    os.close(writer)
    os.dup2(reader, 0)
    yield
    os.dup2(stdin, 0)
    for end in (stdin, reader):
        os.close(end)


@pytest.mark.usefixtures("typed_line")
@pytest.mark.parametrize("run", [run_here, run_in_thread])
def test_a_child_has_its_folder_and_variables_and_nobody_to_ask(
    tmp_path: Path, run: Callable[..., tuple[int, str]]
) -> None:
    """The second one has nothing of the first one."""
    for number in (3, 0):
        folder = tmp_path / str(number)
        folder.mkdir()
        variables = {f"OWN_{number}": "its own", "PATH": os.environ["PATH"]}
        script = f'pwd; cat; env | grep ^OWN; echo "an error" >&2; exit {number}'
        code, output = run(["sh", "-c", script], folder, variables)
        assert (code, output) == (number, f"{folder}\nOWN_{number}=its own\nan error\n")


def test_the_last_bytes_of_a_long_output_are_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(children, "LOG_BYTES", 1000)
    for last in ("the end", "another end"):
        script = f"head -c 100000 /dev/zero | tr '\\0' x; printf '{last}'"
        _, output = children.run(["sh", "-c", script], None, let_continue)
        assert output == "x" * (1000 - len(last)) + last


@pytest.mark.parametrize("seed", range(20))
def test_the_reason_is_the_first_error_or_the_last_line(seed: int) -> None:
    rng = Random(seed)
    errors = ("a.cpp:3: error: no such thing", "npm ERROR! it fails", "Error 1")
    like_errors = ("HTTPClientError:", "OSError: [Errno 28] x")
    others = ("Compiling a", "  Linking  ", "terror", "==== ----", "", "\t")
    kinds = rng.choice((others, (*others, *like_errors), (*others, *like_errors, *errors)))
    rows = [rng.choice(kinds) for _ in range(6)]
    written_rows = [row.strip() for row in rows if row.strip(" \t=-")]
    error_rows = [row for row in written_rows if row in errors] or [
        row for row in written_rows if row in like_errors
    ]
    expected = (error_rows or written_rows[-1:] or [""])[0]
    assert children.reason("\n".join(rows)) == expected.rstrip(": ")
    assert (
        children.reason(f"{'x' * 500} error: at its end")
        == ("x" * 500 + " error: at its end")[-200:]
    )


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
