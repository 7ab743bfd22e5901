"""The page's way onto a board: its own code in node, over ptys, onto the boards' bootloaders."""

from __future__ import annotations

import json
import os
import pty
import threading
import tty
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

import pytest

from tests.machines.bootloaders import bootloader
from tests.machines.uno import skip_unless_available
from tests.support.command import run_subprocess
from tests.support.node import in_node
from tests.support.platformio import firmware, shared_folder

SCRIPT = Path(__file__).with_name("flash_in_node.mjs")
PAGE_BYTES = 128
IN_SYNC, OK, END_OF_COMMAND = b"\x14", b"\x10", 0x20
UNO = b"\x1e\x95\x0f"


def flash(port: str, board: str, file: Path, *cancelled: str) -> str:
    """Return the result of the page's code; `cancelled`: at which part of the work."""
    return "\n".join(in_node(SCRIPT, port, board, str(file), *cancelled))


def hex_file(folder: Path, data: bytes) -> Path:
    # Rows as linkers write them, followed by data at 0.
    rows = [b"\2\0\0\4\0\0\xfa", b"\2\0\0\2\0\0\xfc"]
    for offset in range(0, len(data), 16):
        part = data[offset : offset + 16]
        row = bytes([len(part), offset >> 8, offset & 255, 0]) + part
        rows.append(row + bytes([-sum(row) & 255]))
    file = folder / "firmware.hex"
    lines = [f":{row.hex().upper()}" for row in rows]
    file.write_text("\n".join([*lines, ":00000001FF"]) + "\n", encoding="ascii")
    return file


# -- onto boards that lose and delay, on a clock of the script

SLOW_SCRIPT = Path(__file__).with_name("slow_board_in_node.mjs")
TRY_COUNT, SYNC_MS, ANSWER_MS = 8, 250, 1000  # values in the page's code


def test_a_progressing_write_is_finished_and_a_stalled_one_is_ended() -> None:
    """A board is found that answers one of eight times; then each answer may take its second."""
    rows = [json.loads(line) for line in in_node(SLOW_SCRIPT, "120")]
    assert len(rows) == 120
    outcomes = {row["ended"] for row in rows if row["slow_ms"] < SYNC_MS}
    assert outcomes == {"done", "flash_broken_off", "flash_nobody"}
    for row in rows:
        assert (row["ended"] == "done") == (row["last"] == 1 and row["isSame"]), row
        if row["losses"] < TRY_COUNT and row["slow_ms"] < SYNC_MS and not row["silent"]:
            assert row["ended"] == "done", row
        if row["losses"] >= TRY_COUNT:
            assert row["ended"] == "flash_nobody", row
        request_count = 4 * row["pages"] + 3
        finds_ms = 2 * TRY_COUNT * (SYNC_MS + ANSWER_MS)
        assert row["took_ms"] <= finds_ms + request_count * row["slow_ms"] + 2 * ANSWER_MS, row


# -- onto simulated boards


@pytest.mark.sampled("board")
@pytest.mark.parametrize("board", ["uno", "nano"])
def test_a_new_board_becomes_a_robot(
    board: str, tmp_path: Path, tmp_path_factory: pytest.TempPathFactory
) -> None:
    """An old Nano is found at the second speed, as by `tsc firmware`; an Uno left without firmware
    by a cancelled write is no worse than a new one."""
    skip_unless_available()
    from tests.support.flashed_boards import new_board, to_hex

    elf = firmware(board, tmp_path, shared_folder(tmp_path_factory))
    to_hex(elf, tmp_path / "firmware.hex")
    with new_board(bootloader(board)) as uno:
        if board == "uno":
            assert flash(uno.pty, board, tmp_path / "firmware.hex", "0.25") == "flash_cancelled"
        assert flash(uno.pty, board, tmp_path / "firmware.hex") == "done"
        identified = run_subprocess("doctor", "--identify", "--port", uno.pty)
        assert identified.code == 0, identified.err
        assert identified.out.startswith(f"tinibot on {uno.pty}")


def test_a_board_with_a_sketch_but_no_bootloader_is_not_changed(
    tmp_path: Path, tmp_path_factory: pytest.TempPathFactory
) -> None:
    skip_unless_available()
    from tools.uno import Uno

    elf = firmware("uno", tmp_path, shared_folder(tmp_path_factory))
    with Uno(elf, tells_sleep=False) as uno:
        uno.go()
        assert flash(uno.pty, "uno", hex_file(tmp_path, b"x" * 500)) == "flash_nobody"
        assert run_subprocess("doctor", "--identify", "--port", uno.pty).code == 0


# -- onto boards that a test plays


class FakeBoard:
    """A bootloader of its own: `bends` may change or drop an answer."""

    def __init__(self, bends: Callable[[int, bytes], bytes | None] | None = None) -> None:
        self.flash = bytearray(b"\xff" * 0x8000)
        self.commands: list[int] = []
        self._bends = bends or (lambda command, answer: answer)
        self._address = 0

    def run(self, file: int) -> None:
        heard_bytes = b""
        with suppress(OSError):  # the device is unplugged
            while True:
                heard_bytes += os.read(file, 4096)
                while (length := self._length(heard_bytes)) and len(heard_bytes) >= length:
                    command, heard_bytes = heard_bytes[:length], heard_bytes[length:]
                    self.commands.append(command[0])
                    answer = self._bends(command[0], IN_SYNC + self._answer(command) + OK)
                    if answer is None:
                        os.close(file)
                        return
                    os.write(file, answer)

    @staticmethod
    def _length(heard_bytes: bytes) -> int:
        if not heard_bytes:
            return 0
        return {0x55: 4, 0x64: 5 + PAGE_BYTES, 0x74: 5}.get(heard_bytes[0], 2)

    def _answer(self, command: bytes) -> bytes:
        assert command[-1] == END_OF_COMMAND
        if command[0] == 0x75:
            return UNO
        if command[0] == 0x55:
            self._address = 2 * int.from_bytes(command[1:3], "little")
        elif command[0] == 0x64 and 0x50 in self.commands:  # programming mode was entered
            self.flash[self._address : self._address + PAGE_BYTES] = command[4:-1]
        elif command[0] == 0x74:
            return bytes(self.flash[self._address : self._address + PAGE_BYTES])
        return b""


@contextmanager
def plug_in(board: FakeBoard) -> Iterator[str]:
    file, device = pty.openpty()
    tty.setraw(device)
    thread = threading.Thread(target=board.run, args=(file,), daemon=True)
    thread.start()
    try:
        yield os.ttyname(device)
    finally:
        os.close(device)
        with suppress(OSError):
            os.close(file)


def changed_answer(
    changed_command: int, *, by: bytes | None, times: int = 10_000
) -> Callable[[int, bytes], bytes | None]:
    """Answer a command otherwise; None: the cable is pulled. `times`: from which time on."""
    count = 0

    def change_answer(command: int, answer: bytes) -> bytes | None:
        nonlocal count
        count += command == changed_command
        return by if command == changed_command and count >= times else answer

    return change_answer


def test_all_bytes_are_written_and_verified(tmp_path: Path) -> None:
    data = bytes(k * 7 % 251 for k in range(1000))
    board = FakeBoard()
    with plug_in(board) as port:
        assert flash(port, "uno", hex_file(tmp_path, data)) == "done"
    assert board.flash[:1000] == data and set(board.flash[1000:]) == {255}
    assert board.commands.count(0x64) == board.commands.count(0x74) == 8
    assert board.commands[-1] == 0x51


@pytest.mark.sampled("bends", "ended_text", keep=5)
@pytest.mark.parametrize(
    ("bends", "ended_text"),
    [
        (changed_answer(0x30, by=b"", times=1), "flash_nobody"),
        (changed_answer(0x30, by=b"\x00\xff" * 40, times=1), "flash_nobody"),
        (changed_answer(0x75, by=b"\x14\x1e\x98\x01\x10", times=1), "flash_other_chip"),
        (changed_answer(0x75, by=b"", times=1), "flash_nobody"),
        (changed_answer(0x30, by=None, times=1), "port_gone"),
        (changed_answer(0x64, by=None, times=3), "flash_broken_off"),
        (changed_answer(0x64, by=b"", times=3), "flash_broken_off"),
        (changed_answer(0x64, by=b"\x15\x10", times=3), "flash_broken_off"),
        (changed_answer(0x74, by=None, times=2), "flash_broken_off"),
        (changed_answer(0x74, by=IN_SYNC + b"\x00" * PAGE_BYTES + OK, times=2), "flash_differs"),
        (changed_answer(0x51, by=b"", times=1), "done"),
    ],
    ids=["silent", "noise", "other chip", "half", "pulled early", "pulled", "hangs", "refuses",
         "pulled while reading", "differs", "begins at once"],
)  # fmt: skip
def test_each_failure_of_a_write_is_reported(
    bends: Callable[[int, bytes], bytes | None], ended_text: str, tmp_path: Path
) -> None:
    board = FakeBoard(bends)
    with plug_in(board) as port:
        assert flash(port, "uno", hex_file(tmp_path, b"\x01" * 1000)) == ended_text
    if ended_text in ("flash_nobody", "flash_other_chip", "port_gone"):
        assert set(board.flash) == {255}  # no byte was written


def test_a_write_can_be_cancelled(tmp_path: Path) -> None:
    """Before the first byte the board stays as it is; in the middle it is left without firmware;
    after the last byte it cannot be cancelled any more."""
    file = hex_file(tmp_path, b"\x01" * 1000)
    for part, ended_text in (("-1", "flash_not_begun"), ("0.25", "flash_cancelled"),
                      ("0.75", "flash_cancelled"), ("1", "done")):  # fmt: skip
        board = FakeBoard()
        with plug_in(board) as port:
            assert flash(port, "uno", file, part) == ended_text
        page_count = board.commands.count(0x64)
        assert page_count == {"-1": 0, "0.25": 4}.get(part, 8)


def test_firmware_does_not_overlap_the_bootloader(tmp_path: Path) -> None:
    board = FakeBoard()
    with plug_in(board) as port:
        assert flash(port, "uno", hex_file(tmp_path, b"\x01" * 0x7E01)) == "flash_large"
        assert 0x64 not in board.commands


@pytest.mark.parametrize(
    "text",
    ["", ":00000001FF", "hello", ":0100000001FF\n:00000001FF", ":0100000001FE",
     ":0100000001FE\n:00000001FF\n:0100000001FE", ":020000021000EC\n:0100000001FE\n:00000001FF",
     ":0200000001FD\n:00000001FF", ":01800000017E\n:00000001FF",
     ":0100000001FE\n:0100000900F6\n:00000001FF"],
)  # fmt: skip
def test_anything_but_firmware_is_refused(text: str, tmp_path: Path) -> None:
    file = tmp_path / "x.hex"
    file.write_text(text, encoding="ascii")
    assert flash("/dev/null", "uno", file) == "bad_file"
