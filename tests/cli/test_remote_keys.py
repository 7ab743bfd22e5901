"""A terminal as a remote control, which does not report the release of keys."""

from __future__ import annotations

import random

import pytest

from tiniscript.cli.robot.remote_keys import FIRST_HOLD_S, REPEAT_HOLD_S, HeldKeys
from tiniscript.link.remote import NOTHING_PRESSED, remote_state_of

UP, LEFT = "\x1b[A", "\x1b[D"
KEYS = (
    (UP, "UP"), ("\x1b[B", "DOWN"), ("\x1b[C", "RIGHT"), (LEFT, "LEFT"), ("\x1bOA", "UP"),
    ("\x1bOD", "LEFT"), ("\x1b[1;2A", "UP"), ("a", "A"), ("A", "A"), ("b", "B"), ("B", "B"),
)  # fmt: skip


@pytest.mark.parametrize(("typed_text", "name"), KEYS)
def test_a_first_press_holds_for_long_and_a_repeat_briefly(typed_text: str, name: str) -> None:
    keys, held_state = HeldKeys(), remote_state_of([name])
    assert not keys.press_typed(typed_text, 10.0)
    assert keys.keys_at(10.0) == keys.keys_at(10.0 + FIRST_HOLD_S - 0.01) == held_state
    assert keys.keys_at(10.0 + FIRST_HOLD_S) == NOTHING_PRESSED
    for k in range(20):  # a terminal repeats it after 0.66 s, 25 times a second
        assert keys.keys_at(20.66 + k / 25 - 0.01) == (held_state if k else NOTHING_PRESSED)
        keys.press_typed(typed_text, 20.66 + k / 25)
    last = 20.66 + 19 / 25
    assert keys.keys_at(last + REPEAT_HOLD_S - 0.01) == held_state
    assert keys.keys_at(last + REPEAT_HOLD_S) == NOTHING_PRESSED


def test_a_held_key_is_held_without_a_gap_from_the_first_press_on() -> None:
    for delay_s in (0.25, 0.5, 0.66):
        keys = HeldKeys()
        keys.press_typed(UP, 0.0)
        now_s = 0.0
        while now_s < 2.0:
            if now_s >= delay_s:
                keys.press_typed(UP, now_s)
            for _ in range(4):
                assert keys.keys_at(now_s) == remote_state_of(["UP"]), (delay_s, now_s)
                now_s += 0.01


@pytest.mark.parametrize("cut", [1, 2])
def test_a_key_that_comes_in_two_pieces(cut: int) -> None:
    keys = HeldKeys()
    keys.press_typed("a" + UP[:cut], 0.0)
    assert keys.keys_at(0.1) == remote_state_of(["A"])
    keys.press_typed(UP[cut:] + LEFT, 0.1)
    assert keys.keys_at(0.2) == remote_state_of(["A", "UP", "LEFT"])


@pytest.mark.parametrize("typed_text", ["\x1b", "x", "\x1b[3~", "\x1bOP", "\n", "7", "\x1bx", "é"])
def test_what_is_no_key_of_a_remote_control_holds_nothing(typed_text: str) -> None:
    keys = HeldKeys()
    assert not keys.press_typed(typed_text + "\x1b", 0.0)
    assert not keys.press_typed("b", 0.1) and keys.keys_at(0.1) in (
        NOTHING_PRESSED,
        remote_state_of(["B"]),
    )
    assert not keys.press_typed("b", 0.2)
    assert keys.keys_at(0.2) == remote_state_of(["B"])


@pytest.mark.parametrize("typed_text", ["q", "Q", "\x04", UP + "q", "aaaq"])
def test_who_wants_to_leave(typed_text: str) -> None:
    assert HeldKeys().press_typed(typed_text, 0.0)


OTHERS = ("\x1b", "x", "\x1b[3~", "\x1bOP", "\n", "7", "é", "q", "\x04")


@pytest.mark.parametrize("seed", range(50))
def test_what_comes_in_pieces_is_what_comes_whole(seed: int) -> None:
    """Keys may be split anywhere, after any input: no part of a key is left for the next."""
    chance = random.Random(seed)
    whole, cut = HeldKeys(), HeldKeys()
    for k in range(20):
        typed_text, now_s = (
            chance.choice([*(typed_text for typed_text, _ in KEYS), *OTHERS]),
            2.0 * k,
        )
        at = chance.randrange(len(typed_text) + 1)
        leaves = [
            cut.press_typed(piece, now_s) for piece in (typed_text[:at], "", typed_text[at:], "")
        ]
        assert any(leaves) == whole.press_typed(typed_text, now_s), (k, typed_text)
        assert cut.keys_at(now_s) == whole.keys_at(now_s), (k, typed_text)
