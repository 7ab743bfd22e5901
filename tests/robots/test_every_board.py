"""Every board that has firmware is in each table that knows boards: the message names the one."""

from __future__ import annotations

import re

import pytest

from tests.machines.board import VARIANTS
from tests.support.casefile import ROOT
from tiniscript.base.languages import languages
from tiniscript.cli.texts.options import OPTIONS
from tiniscript.codegen.sketch import writing
from tiniscript.flash import bootloaders
from tiniscript.robots import firmware
from tiniscript.robots.boards import CHIPS
from tiniscript.robots.ports import AVRS
from tiniscript.robots.wiring.headers import SIDES

INI = ROOT / "vm_arduino" / "platformio.ini"


@pytest.mark.parametrize("board", firmware.BOARDS)
def test_a_board_is_drawn_and_built(board: str) -> None:
    assert board in CHIPS, "robots/boards.py says what its pins can do"
    assert board in SIDES, "robots/wiring/headers.py says where its pins are"
    environments = re.findall(r"(?m)^\[env:(.+)\]$", INI.read_text(encoding="utf-8"))
    assert board in environments, "vm_arduino/platformio.ini has an environment of its name"


@pytest.mark.parametrize("board", AVRS)
def test_a_board_with_an_avr_is_written_and_has_sketches(board: str) -> None:
    flashed_boards = {firmware_board for firmware_board, _ in bootloaders.BOARDS.values()}
    assert board in flashed_boards, "flash/bootloaders.py says how its firmware is written"
    assert board in writing.BOARD_TITLES, "sketch/writing.py says how a sketch calls it"
    assert board in VARIANTS, "tests/machines/board.py names the core's folder with its pins"


def test_every_board_is_documented() -> None:
    (option,) = (
        option for option in OPTIONS if (option.flags, option.verbs) == ("--chip", "firmware")
    )
    for language in languages():
        assert set(bootloaders.BOARDS) <= set(re.findall(r"[\w-]+", option.help(language))), (
            "the catalogue help names the values of --chip"
        )
    sample = ROOT / "compiler" / "tiniscript" / "robots" / "tinibot.toml"
    comment = re.search(r"(?m)^chip = .*# (.*)$", sample.read_text(encoding="utf-8"))
    assert comment and set(re.findall(r"\w+", comment[1])) >= set(CHIPS), (
        "robots/tinibot.toml names the boards that a profile may have"
    )


def test_no_table_has_a_board_without_firmware() -> None:
    assert set(SIDES) | set(writing.BOARD_TITLES) <= set(firmware.BOARDS)
    assert {board for board, _ in bootloaders.BOARDS.values()} <= set(firmware.BOARDS)


def test_every_chip_has_firmware() -> None:
    """If a chip had none, `tsc firmware --board` and `tsc firmware --wiring` would report it."""
    assert set(CHIPS) == set(firmware.BOARDS)
