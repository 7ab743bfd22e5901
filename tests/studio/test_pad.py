"""The page as a remote control: the messages to its robot, on a clock of the script.

Held keys are sent at each change and every 200 ms; without held keys, the pad is silent.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from tests.support.node import in_node, page_data
from tiniscript.link.remote import REPEAT_MS
from tiniscript.studio import classroom

__all__ = ["page_data"]

WAYS_SCRIPT = Path(__file__).with_name("keys_in_node.mjs")
SCRIPT = Path(__file__).with_name("pad_in_node.mjs")
HISTORIES_SCRIPT = Path(__file__).with_name("pad_histories_in_node.mjs")
HISTORIES = 40
ALL_READINGS = ["KEY_UP", "KEY_DOWN", "KEY_LEFT", "KEY_RIGHT", "KEY_A", "KEY_B", "PAD_X", "PAD_Y"]
DRIVING_OFFER: Any = ["offer", "driving", {"remoteWords": ALL_READINGS}]
UP_KEY, A_KEY = 1, 16
NO_KEYS = [0, 0, 0]


def play_story(path: Path, *story: Any) -> dict[str, Any]:
    (line,) = in_node(SCRIPT, str(path), json.dumps(story))
    outcome: dict[str, Any] = json.loads(line)
    return outcome


def sent_to_robot(path: Path, *story: Any) -> list[Any]:
    """Return the messages to the robot, without its side."""
    return [[ms, *held_keys] for ms, _, *held_keys in play_story(path, *story)["told"]]


def test_held_keys_are_sent_at_each_change_and_repeatedly(page_data: Path) -> None:
    packets = sent_to_robot(
        page_data, DRIVING_OFFER, ["wait", 1000], ["down", "KEY_UP", 1], ["wait", 450],
        ["up", "KEY_UP", 1], ["wait", 2000],
    )  # fmt: skip
    assert REPEAT_MS == 200
    assert packets == [
        [1000, UP_KEY, 0, 0],
        [1200, UP_KEY, 0, 0],
        [1400, UP_KEY, 0, 0],
        [1450, *NO_KEYS],
    ]


def test_a_stick_follows_the_finger_and_returns_when_released(page_data: Path) -> None:
    packets = sent_to_robot(
        page_data, DRIVING_OFFER, ["down", "stick", 1, 80, 40], ["move", "stick", 1, 500, 60],
        ["move", "stick", 1, 501, 60], ["up", "stick", 1, 500, 60], ["wait", 900],
    )  # fmt: skip
    assert packets == [[0, 0, 50, 50], [0, 0, 100, 0], [0, *NO_KEYS]]


def test_two_fingers_hold_two_parts_and_a_second_one_moves_no_stick(page_data: Path) -> None:
    packets = sent_to_robot(
        page_data, DRIVING_OFFER, ["down", "stick", 1, 60, 20], ["down", "KEY_A", 2],
        ["down", "stick", 3, 99, 60], ["move", "stick", 3, 99, 60], ["up", "stick", 3],
        ["up", "stick", 1], ["down", "KEY_A", 4], ["up", "KEY_A", 2], ["cancel", "KEY_A", 4],
    )  # fmt: skip
    assert packets == [[0, 0, 0, 100], [0, A_KEY, 0, 100], [0, A_KEY, 0, 0], [0, *NO_KEYS]]


def test_keyboard_keys_are_keys_and_arrows_move_a_lone_stick(page_data: Path) -> None:
    key_events = [["keydown", "ArrowUp"], ["keydown", "A"], ["keyup", "ArrowUp"], ["keyup", "A"]]
    assert sent_to_robot(page_data, DRIVING_OFFER, *key_events) == [
        [0, UP_KEY, 0, 0], [0, UP_KEY | A_KEY, 0, 0], [0, A_KEY, 0, 0], [0, *NO_KEYS],
    ]  # fmt: skip
    stick = ["offer", "driving", {"remoteWords": ["PAD_Y", "KEY_A"]}]
    assert sent_to_robot(page_data, stick, *key_events) == [
        [0, 0, 0, 100], [0, A_KEY, 0, 100], [0, A_KEY, 0, 0], [0, *NO_KEYS],
    ]  # fmt: skip
    assert sent_to_robot(page_data, stick, ["keydown", "ArrowUp"], ["keydown", "ArrowLeft"]) == [
        [0, 0, 0, 100], [0, 0, -71, 71],
    ]  # fmt: skip


@pytest.mark.parametrize("fields", [{"on": "field"}, {"ctrlKey": True}, {"repeat": True}], ids=str)
def test_keys_typed_into_other_elements_are_ignored(
    page_data: Path, fields: dict[str, Any]
) -> None:
    """Keys of a text field, of the browser, or held before."""
    assert (
        sent_to_robot(page_data, DRIVING_OFFER, ["keydown", "ArrowUp", fields], ["wait", 500]) == []
    )


def test_the_space_bar_holds_a_focused_button(page_data: Path) -> None:
    on = {"on": "KEY_A"}
    assert sent_to_robot(page_data, DRIVING_OFFER, ["keydown", " ", on], ["keyup", " ", on]) == [
        [0, A_KEY, 0, 0],
        [0, *NO_KEYS],
    ]


def test_whatever_hands_do_what_is_held_and_nothing_else_is_told_to_the_driven_robot(
    page_data: Path,
) -> None:
    """Fingers, keys and gamepads, while robots come, go and are replaced, and after each STOP."""
    lines = in_node(HISTORIES_SCRIPT, str(page_data), "0", str(HISTORIES))
    actions = {act for line in lines for act in json.loads(line)}
    assert len(lines) == HISTORIES
    assert actions >= {"held", "gamepads", "stop", "Escape", "blur", "pagehide", "freeze", "hidden"}


RELEASES = [["hide"], ["event", "blur"], ["event", "pagehide"], ["stop"],
          ["side", "side_real"], ["offer", "driving", None],
          ["keydown", "Escape"]]  # fmt: skip


@pytest.mark.parametrize("end", RELEASES, ids=str)
def test_releasing_everything_requires_new_presses(page_data: Path, end: list[Any]) -> None:
    gamepad = ["gamepads", [[0, -1], [0]]]
    packets = sent_to_robot(
        page_data, DRIVING_OFFER, gamepad, ["event", "gamepadconnected"],
        ["down", "stick", 1, 60, 20],
        ["keydown", "b"], ["wait", 10], end, ["wait", 500], ["see"], ["side", "side_virtual"],
        DRIVING_OFFER, ["move", "stick", 1, 99, 60], ["keydown", "b", {"repeat": True}],
        ["wait", 500],
        ["up", "stick", 1], ["keyup", "b"], ["wait", 500],
        ["gamepads", [[0, 0], []]], ["wait", 100], ["keydown", "b"],
    )  # fmt: skip
    release_index = packets.index([10, *NO_KEYS])
    assert [10, A_KEY | 32, 0, 100] in [
        [10, *held_keys] for _, *held_keys in packets[:release_index]
    ]
    assert [held_keys for _, *held_keys in packets[release_index + 1 :]] == [[32, 0, 0]]


def test_a_key_with_a_missed_release_is_dropped_at_the_next_one(page_data: Path) -> None:
    """The key was released in another window."""
    story = [["keydown", "b"], ["event", "blur"], ["keydown", "ArrowUp"]]
    helds = [held_keys for _, *held_keys in sent_to_robot(page_data, DRIVING_OFFER, *story)]
    assert helds == [[32, 0, 0], NO_KEYS, [UP_KEY, 0, 0]]


def test_a_gamepad_holds_until_it_is_unplugged(page_data: Path) -> None:
    packets = sent_to_robot(
        page_data, DRIVING_OFFER, ["gamepads", [[0.1, -0.05], []]], ["event", "gamepadconnected"],
        ["wait", 50], ["gamepads", [[0.1, -1], [14, 1]]], ["wait", 20], ["gamepads"],
        ["wait", 500],
    )  # fmt: skip
    assert [held_keys for _, *held_keys in packets] == [[4 | 32, 10, 100], NO_KEYS]
    assert packets[1][0] - packets[0][0] <= 20, "it need not be told of"


def test_only_controls_that_the_program_reads_are_shown(page_data: Path) -> None:
    for readings in (ALL_READINGS, ["KEY_A"], ["PAD_X"], ["KEY_LEFT", "PAD_Y"], []):
        offer = ["offer", "driving", {"remoteWords": readings}]
        parts = [reading for reading in readings if reading.startswith("KEY")]
        stick = ["stick"] if any(reading.startswith("PAD") for reading in readings) else []
        assert play_story(page_data, offer)["shown"] == parts + stick
    assert play_story(page_data, DRIVING_OFFER, ["offer", "driving", None])["shown"] == []
    # It differs from the visible offer.
    hidden_offer = ["offer", "link", {"remoteWords": ALL_READINGS}]
    assert play_story(page_data, hidden_offer)["shown"] == []


def test_a_robot_without_a_remote_control_gets_no_key_messages(page_data: Path) -> None:
    deaf = ["offer", "link", {"remoteWords": ALL_READINGS, "lacksRemote": True}]
    outcome = play_story(
        page_data, ["side", "side_real"], deaf, ["keydown", "ArrowUp"], ["wait", 500], ["stop"],
        ["gamepads", [[0, -1], [0]]], ["event", "gamepadconnected"], ["wait", 500],
    )  # fmt: skip
    assert outcome["told"] == [] == outcome["shown"]
    assert outcome["said"].startswith("This robot has no remote control.")


def test_a_newly_shown_robot_gets_only_later_presses(
    page_data: Path,
) -> None:
    """The one before hears that all is let go."""
    link_offer = ["offer", "link", {"remoteWords": ALL_READINGS}]
    outcome = play_story(
        page_data, DRIVING_OFFER, link_offer, ["down", "KEY_UP", 1], ["wait", 10],
        ["side", "side_real"],
        ["wait", 500], ["up", "KEY_UP", 1], ["down", "KEY_A", 1], ["side", "side_virtual"],
        ["wait", 500],
    )  # fmt: skip
    assert outcome["told"] == [
        [0, "driving", UP_KEY, 0, 0], [10, "driving", *NO_KEYS],
        [510, "link", A_KEY, 0, 0], [510, "link", *NO_KEYS],
    ]  # fmt: skip


def test_the_same_robot_keeps_its_held_keys(page_data: Path) -> None:
    packets = sent_to_robot(
        page_data,
        DRIVING_OFFER,
        ["down", "KEY_UP", 1],
        ["wait", 10],
        DRIVING_OFFER,
        ["wait", 190],
    )
    assert packets == [[0, UP_KEY, 0, 0], [200, UP_KEY, 0, 0]]


@pytest.mark.parametrize("stick_kind", ["host", "direct"])
def test_a_constantly_moving_stick_is_sent_with_its_current_position(
    page_data: Path, stick_kind: str
) -> None:
    """No more often than the link says it, no word after a newer one, and the release at once."""
    packets = json.loads(in_node(WAYS_SCRIPT, str(page_data), stick_kind)[0])
    moved = [y for _, y in packets["sent"][:-1]]
    assert moved == sorted(set(moved)) and len(moved) > 100
    assert packets["sent"][-1][1] == 0
    assert len(packets["sent"]) <= packets["asked"], "one word at a time: the newest"
    assert packets["sent"][-1][0] - packets["released"] <= (31 if stick_kind == "host" else 150)
    assert not packets["over"]
    if stick_kind == "host":
        seconds = 6
        assert packets["asked"] / seconds < classroom.REQUEST_RATE[1] - 1000 / 300, (
            "and it looks for its turn"
        )
