"""An avrdude that comes to no end: it is ended, with all that it has started."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
from functools import partial
from pathlib import Path
from socket import socketpair
from time import sleep as sleep_s

import pytest

from tests.support.texts import texts_in_all_languages
from tests.support.waiting import has_ended, until
from tiniscript.flash import avrdude, children
from tiniscript.flash.avrdude import StepProgress, WriteResult
from tiniscript.flash.bootloaders import UNO

WRITING_CODE = "import sys\nwhile True: sys.stdout.write({said!r}); sys.stdout.flush()\n"
HALF_OUTPUT = "Reading | ### |\\nWriting | " + "#" * 25


def write_and_watch(folder: Path, body: str) -> tuple[WriteResult, list[StepProgress | None]]:
    """Write a firmware with this avrdude; return the result and the progress seen.

    The file `seen` appears with the first output.
    """
    program = folder / "avrdude.py"
    program.write_text(body, encoding="utf-8")
    steps: list[StepProgress | None] = []

    def note_progress(progress: StepProgress | None) -> None:
        steps.append(progress)
        if progress:
            (folder / "seen").touch()

    return avrdude.write([sys.executable, str(program)], UNO, "x", folder, note_progress), steps


@pytest.mark.parametrize("message", ["avrdude: warning\n", "x" * 4096, "\x1b[31m", "#"])
def test_an_avrdude_that_writes_for_ever_is_ended(tmp_path: Path, message: str) -> None:
    assert (
        write_and_watch(tmp_path, WRITING_CODE.format(said=message))[0].outcome == avrdude.ENDLESS
    )


def test_progress_is_reported_until_avrdude_is_ended(tmp_path: Path) -> None:
    wait_code = f"import os\nwhile not os.path.exists({str(tmp_path / 'seen')!r}): pass\n"
    body = (
        f'print("{HALF_OUTPUT}", flush=True)\n' + wait_code + WRITING_CODE.format(said=" waiting\n")
    )
    result, steps = write_and_watch(tmp_path, body)
    assert result.outcome == avrdude.ENDLESS
    assert StepProgress(avrdude.WRITING, 50) in steps


def test_an_avrdude_that_prints_for_ever_is_ended(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Though it is never silent, it times out."""
    monkeypatch.setattr(avrdude, "RUN_TIMEOUT_S", 1.0)
    body = 'import time\nwhile True: print(".", flush=True); time.sleep(0.02)\n'
    assert write_and_watch(tmp_path, body)[0].outcome == avrdude.ENDLESS


def test_an_avrdude_that_closes_its_output_but_stays_is_ended(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(avrdude, "EXIT_TIMEOUT_S", 0.1)
    body = "import os, time\nos.close(1); os.close(2); time.sleep(600)\n"
    assert write_and_watch(tmp_path, body)[0].outcome == avrdude.ENDLESS


def test_a_slow_reader_reads_nothing_of_the_next_opened_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A number of a file that is closed is the next one's: that is the port."""
    real_read = os.read

    def read_slowly(number: int, count: int) -> bytes:
        sleep_s(0.1)
        return real_read(number, count)

    monkeypatch.setattr(os, "read", read_slowly)
    body = "import time\nprint('attempt 1 of 10, attempt 2 of 10', flush=True)\ntime.sleep(600)\n"
    threads_before = {*threading.enumerate()}
    assert write_and_watch(tmp_path, body)[0].outcome == avrdude.NOBODY
    assert {*threading.enumerate()} <= threads_before, "nobody reads any more"
    next_ones = [end for _ in range(4) for end in socketpair()]
    for end in next_ones:
        end.setblocking(False)
        end.send(b"?")
    sleep_s(0.2)
    assert [end.recv(2) for end in next_ones] == [b"?"] * 8
    for end in next_ones:
        end.close()


@pytest.mark.skipif(sys.platform == "win32", reason="there a program gets no Ctrl-C")
def test_a_second_ctrl_c_leaves_nothing_behind(monkeypatch: pytest.MonkeyPatch) -> None:
    child = subprocess.Popen(["sleep", "600"], start_new_session=True)

    def interrupt_wait(seconds_s: float) -> int:
        monkeypatch.undo()
        raise KeyboardInterrupt

    monkeypatch.setattr(child, "wait", interrupt_wait)
    with pytest.raises(KeyboardInterrupt):
        children._end(child)
    assert child.poll() is not None


@pytest.mark.skipif(not Path("/proc/self").exists(), reason="looks at processes as Linux has them")
@pytest.mark.parametrize("parent_code", [WRITING_CODE.format(said="x"), "sys.exit(1)"])
def test_children_of_avrdude_end_with_it(tmp_path: Path, parent_code: str) -> None:
    note = tmp_path / "child"
    sleep = f"[{sys.executable!r}, '-c', 'import time; time.sleep(600)']"
    body = (
        f"import subprocess, sys\nchild = subprocess.Popen({sleep}, stdout=subprocess.DEVNULL,"
        f" stderr=subprocess.DEVNULL)\nopen({str(note)!r}, 'w').write(str(child.pid))\n"
        f"{parent_code}\n"
    )
    write_and_watch(tmp_path, body)
    until(partial(has_ended, note.read_text()), "its child has ended")


def test_the_message_names_the_next_step() -> None:
    for sentence in texts_in_all_languages("flash_endless"):
        assert "avrdude" in sentence and "{port}" in sentence


def test_ctrl_c_during_the_start_of_avrdude_ends_it(monkeypatch: pytest.MonkeyPatch) -> None:
    """The signal is heard before anybody knows the program."""
    processes: list[subprocess.Popen[bytes]] = []
    real_popen = subprocess.Popen

    def interrupt_first(*arguments: object, **options: object) -> subprocess.Popen[bytes]:
        processes.append(real_popen(*arguments, **options))  # type: ignore[call-overload]
        if len(processes) == 1:  # Windows starts another program to end it
            signal.raise_signal(signal.SIGINT)
        return processes[-1]

    monkeypatch.setattr(subprocess, "Popen", interrupt_first)
    with pytest.raises(KeyboardInterrupt):
        children.run([sys.executable, "-c", "import time; time.sleep(600)"], None, print)
    assert processes[0].poll() is not None
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
