"""The start button, pressed in every state of the firmware, follows the document's table.

The wire goes through the button's own code, whose results go to the whole firmware.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache

import pytest

from tests.support.button_signals import button_events
from tests.support.button_states import (
    LINE_POWER,
    OTHER_POWER,
    SAVED_POWER,
    STATES,
    TYPED_POWER,
    Table,
)
from tests.support.casefile import ROOT
from tests.support.images import image_of
from tests.support.owners import BUTTON_HELD, BUTTON_PRESSED, BUTTON_RELEASED
from tests.support.text_robot import type_text
from tiniscript.link.requests import OK

FLAGS = {"P": BUTTON_PRESSED, "H": BUTTON_HELD, "R": BUTTON_RELEASED}
EDGE_COLUMN, SHORT_COLUMN, LATE_COLUMN, TWO_SECONDS_COLUMN = range(4)  # columns of the table


def chatter(edge_ms: int) -> list[int]:
    return [edge_ms * 1000 + us for us in (0, 700, 1500, 1900, 4000)]


# Levels of the wire in us, and the table columns with the expected results.
PRESSES: dict[str, tuple[list[int], tuple[int, ...]]] = {
    "a spike": ([0, 150], (EDGE_COLUMN,)),
    "many spikes": (
        [us for k in range(40) for us in (k * 17_000, k * 17_000 + 150)],
        (EDGE_COLUMN,),
    ),
    "chatter": ([*range(0, 20_000, 900)][:22], (EDGE_COLUMN,)),
    "short": ([0, 200_000], (EDGE_COLUMN, SHORT_COLUMN)),
    "the shortest": ([0, 34_000], (EDGE_COLUMN, SHORT_COLUMN)),
    "short, with chatter": (
        [*chatter(0), *chatter(300), 305_000][:10],
        (EDGE_COLUMN, SHORT_COLUMN),
    ),
    "just short": ([0, 930_000], (EDGE_COLUMN, SHORT_COLUMN)),
    "just long": ([0, 1_040_000], (EDGE_COLUMN, LATE_COLUMN)),
    "long, with chatter": ([*chatter(0), *chatter(1500)], (EDGE_COLUMN, LATE_COLUMN)),
    "held 2 s": ([0, 2_200_000], (EDGE_COLUMN, LATE_COLUMN, TWO_SECONDS_COLUMN)),
    "released late": ([0, 5_000_000], (EDGE_COLUMN, LATE_COLUMN, TWO_SECONDS_COLUMN)),
    "held for ever": ([0, 12_000_000], (EDGE_COLUMN, TWO_SECONDS_COLUMN)),
}
HELD_FOR_EVER = "held for ever"


@lru_cache
def letters() -> dict[str, list[tuple[int, str]]]:
    """Return the button's events for each press: the millisecond, and P, H or R."""
    event_rows = button_events([(100, 0, edges) for edges, _ in PRESSES.values()])
    rows = {}
    for name, row in zip(PRESSES, event_rows, strict=True):
        rows[name] = [(us // 1000, letter) for us, letter in row]
        if name == HELD_FOR_EVER:
            rows[name] = [row for row in rows[name] if row[1] != "R"]
    return rows


@lru_cache
def read_table() -> dict[str, list[str]]:
    """Return the table of the document."""
    text = (ROOT / "docs" / "develop" / "link.md").read_text(encoding="utf-8")
    rows = text.split("<!-- button -->\n")[1].split("\n\n")[0].splitlines()[2:]
    cells = [[cell.strip() for cell in row.strip("|").split("|")] for row in rows]
    return {name: rest for name, *rest in cells}


def test_the_document_has_every_state() -> None:
    assert list(read_table()) == list(STATES)


def test_presses_match_their_names() -> None:
    letters_by_name = {
        name: "".join(letter for _, letter in row) for name, row in letters().items()
    }
    for name, (_, columns) in PRESSES.items():
        is_press = columns != (EDGE_COLUMN,)
        expected = "PH" + "R" * (name != HELD_FOR_EVER)
        assert (
            letters_by_name[name] == expected if is_press else set(letters_by_name[name]) <= {"P"}
        ), name
        assert letters_by_name[name]


def press_button(table: Table, press: str) -> None:
    """Press and release the button, and let some time pass."""
    now_ms = 0
    for at_ms, letter in letters()[press]:
        if table.is_reset_down and letter == "P":
            continue  # the button was down before a program could see it
        table.talk(max(0, at_ms - now_ms))
        table.talk(1, FLAGS[letter])
        now_ms = max(at_ms, now_ms) + 1
    table.talk(13_000 if press == HELD_FOR_EVER else 700)


@pytest.mark.sampled("press", keep=3)
@pytest.mark.parametrize("press", PRESSES)
@pytest.mark.parametrize("state", STATES)
def test_the_button_acts_as_documented_in_each_state(state: str, press: str) -> None:
    table = Table()
    STATES[state](table)
    robot, began_ms = table.robot, table.robot.now_ms
    was_latched, count_before = robot.is_latched, len(robot.did)
    press_button(table, press)
    rows = [row.split(" ", 1) for row in robot.did[count_before:]]
    moves = [(int(ms) - began_ms, action) for ms, action in rows if action.startswith("MOTORS")]
    expected_texts, columns = read_table()[state], PRESSES[press][1]
    first_ms = letters()[press][0][0]
    stops = expected_texts[EDGE_COLUMN] == "stops it"
    assert was_latched != stops, "a robot that runs, or one that does not"
    starts = SHORT_COLUMN in columns and expected_texts[SHORT_COLUMN].startswith("starts")
    assert not any(
        expected_texts[event] not in ("-", "stops it") for event in (EDGE_COLUMN, LATE_COLUMN)
    )
    if stops:
        assert [action for _, action in moves] == ["MOTORS 0 0"]
        assert moves[0][0] <= first_ms + 2
        assert robot.is_latched
    elif starts:
        assert [action for _, action in moves] == [f"MOTORS {table.program} {table.program}"]
        up_ms = letters()[press][-1][0]
        assert up_ms <= moves[0][0]
        assert not robot.is_latched
    else:
        assert moves == []
        assert robot.is_latched
    beeps = [action for _, action in rows if action.startswith("BEEP 1568")]
    is_forgotten = table.is_reset_down and press == HELD_FOR_EVER
    assert len(beeps) == (
        is_forgotten
        or (
            TWO_SECONDS_COLUMN in columns and expected_texts[TWO_SECONDS_COLUMN].startswith("beeps")
        )
    )


@pytest.mark.parametrize("has_draft", [True, False])
@pytest.mark.parametrize("press", PRESSES)
def test_only_a_start_discards_text(press: str, has_draft: bool) -> None:
    """An open block continues after presses that start no program."""
    table = Table(has_draft)
    STATES["has an open block of text"](table)
    press_button(table, press)
    answers = " ".join(type_text(table.robot, "END_LOOP\n", 100))
    if SHORT_COLUMN in PRESSES[press][1]:
        assert "MOTORS 80 80" in " ".join(table.robot.did)
        assert "MOTORS 40 40" not in " ".join(table.robot.did), answers
    else:
        assert "MOTORS 40 40" in " ".join(table.robot.did), answers


@pytest.mark.parametrize("press", PRESSES)
def test_only_a_start_discards_an_upload(press: str) -> None:
    table = Table()
    table.upload_program(SAVED_POWER)
    image = image_of(f"SI|{f'F(1, {OTHER_POWER}); ' * 90}")
    request = table.session.upload(image)
    while request.done_bytes < 60:
        table.talk(1)
    now_ms = 0
    for at_ms, letter in letters()[press][:3]:
        table.robot.wait(max(1, at_ms - now_ms))
        table.robot.step(flags=FLAGS[letter])
        now_ms = at_ms
    if press != HELD_FOR_EVER and now_ms < 2500:
        outcome = table.robot.until(table.session, request, 30_000)
        drives = f"MOTORS {OTHER_POWER} {OTHER_POWER}" in " ".join(table.robot.did)
        assert (outcome == OK) == drives == (SHORT_COLUMN not in PRESSES[press][1])


# The state changes while the button is down: only a robot that was stopped all the time starts at
# the release.
ACTIONS_DURING_PRESS: dict[str, Callable[[Table], object]] = {
    "nothing": lambda table: None,
    "a line": lambda table: table.session.live(image_of(f"SI|F(600, {LINE_POWER})").code),
    "a short line": lambda table: table.session.live(image_of(f"SI|F(0.05, {LINE_POWER})").code),
    "an upload": lambda table: table.session.upload(
        image_of(f"SI|F(600, {OTHER_POWER})"), saves=False
    ),
    "text": lambda table: type_text(table.robot, f"SI|F(0.05, {TYPED_POWER})\n"),
    "a stop": lambda table: table.session.stop(table.robot.now_ms),
    "zeros": lambda table: table.robot.step(bytes(4)),
    "a stop by text": lambda table: type_text(table.robot, "S\n"),
}


@pytest.mark.parametrize("is_sure", [True, False])
@pytest.mark.parametrize("meanwhile", ACTIONS_DURING_PRESS)
def test_a_release_starts_nothing_after_a_run_or_a_stop(meanwhile: str, is_sure: bool) -> None:
    table = Table()
    table.upload_program(SAVED_POWER)
    if "text" in meanwhile:
        table.fall_silent()
    table.talk(1, BUTTON_PRESSED)
    table.talk(31 if is_sure else 5)
    if is_sure:
        table.talk(1, BUTTON_HELD)
    ACTIONS_DURING_PRESS[meanwhile](table)
    table.talk(300)
    if not is_sure:
        table.talk(1, BUTTON_HELD)
    table.talk(1, BUTTON_RELEASED)
    table.talk(700)
    starts = f"MOTORS {SAVED_POWER} {SAVED_POWER}" in " ".join(table.robot.did)
    assert starts == (meanwhile == "nothing")
