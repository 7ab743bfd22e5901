"""A terminal as a remote control, which does not report the release of keys."""

from __future__ import annotations

import random
from collections.abc import Callable
from itertools import pairwise
from types import SimpleNamespace
from typing import Any, cast

import pytest

from tiniscript.cli.robot import remote_keys
from tiniscript.cli.robot.connect import Connection
from tiniscript.cli.robot.remote_keys import (
    FIRST_HOLD_S,
    POLL_S,
    REPEAT_HOLD_S,
    SEND_INTERVAL_S,
    HeldKeys,
    TerminalRemote,
)
from tiniscript.link.connection import PendingRequest
from tiniscript.link.messages import REMOTE, STATUSES
from tiniscript.link.outcomes import CANCELLED, LOST
from tiniscript.link.remote import NOTHING_PRESSED, RemoteState, remote_state_of
from tiniscript.link.requests import OK, Reply

UP_KEY, LEFT_KEY = "\x1b[A", "\x1b[D"
KEYS = (
    (UP_KEY, "UP"), ("\x1b[B", "DOWN"), ("\x1b[C", "RIGHT"), (LEFT_KEY, "LEFT"), ("\x1bOA", "UP"),
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
    last_s = 20.66 + 19 / 25
    assert keys.keys_at(last_s + REPEAT_HOLD_S - 0.01) == held_state
    assert keys.keys_at(last_s + REPEAT_HOLD_S) == NOTHING_PRESSED


def test_a_held_key_is_held_without_a_gap_from_the_first_press_on() -> None:
    for delay_s in (0.25, 0.5, 0.66):
        keys = HeldKeys()
        keys.press_typed(UP_KEY, 0.0)
        now_s = 0.0
        while now_s < 2.0:
            if now_s >= delay_s:
                keys.press_typed(UP_KEY, now_s)
            for _ in range(4):
                assert keys.keys_at(now_s) == remote_state_of(["UP"]), (delay_s, now_s)
                now_s += 0.01


@pytest.mark.parametrize("split", [1, 2])
def test_a_key_that_comes_in_two_pieces(split: int) -> None:
    keys = HeldKeys()
    keys.press_typed("a" + UP_KEY[:split], 0.0)
    assert keys.keys_at(0.1) == remote_state_of(["A"])
    keys.press_typed(UP_KEY[split:] + LEFT_KEY, 0.1)
    assert keys.keys_at(0.2) == remote_state_of(["A", "UP", "LEFT"])


@pytest.mark.parametrize("typed_text", ["\x1b", "x", "\x1b[3~", "\x1bOP", "\n", "7", "\x1bx", "é"])
def test_anything_but_a_remote_control_key_holds_nothing(typed_text: str) -> None:
    keys = HeldKeys()
    assert not keys.press_typed(typed_text + "\x1b", 0.0)
    assert not keys.press_typed("b", 0.1) and keys.keys_at(0.1) in (
        NOTHING_PRESSED,
        remote_state_of(["B"]),
    )
    assert not keys.press_typed("b", 0.2)
    assert keys.keys_at(0.2) == remote_state_of(["B"])


@pytest.mark.parametrize("typed_text", ["q", "Q", "\x04", UP_KEY + "q", "aaaq"])
def test_quit_keys_leave(typed_text: str) -> None:
    assert HeldKeys().press_typed(typed_text, 0.0)


OTHER_KEYS = ("\x1b", "x", "\x1b[3~", "\x1bOP", "\n", "7", "é", "q", "\x04")


@pytest.mark.parametrize("seed", range(50))
def test_keys_in_pieces_count_like_whole_keys(seed: int) -> None:
    """Keys may be split anywhere, after any input: no part of a key is left for the next."""
    rng = random.Random(seed)
    whole_keys, split_keys = HeldKeys(), HeldKeys()
    for k in range(20):
        typed_text, now_s = (
            rng.choice([*(typed_text for typed_text, _ in KEYS), *OTHER_KEYS]),
            2.0 * k,
        )
        offset = rng.randrange(len(typed_text) + 1)
        leave_flags = [
            split_keys.press_typed(piece, now_s)
            for piece in (typed_text[:offset], "", typed_text[offset:], "")
        ]
        assert any(leave_flags) == whole_keys.press_typed(typed_text, now_s), (k, typed_text)
        assert split_keys.keys_at(now_s) == whole_keys.keys_at(now_s), (k, typed_text)


@pytest.mark.parametrize("seed", range(20))
def test_keys_typed_earlier_are_no_longer_held(seed: int) -> None:
    rng, used_keys, unused_keys, now_s = random.Random(seed), HeldKeys(), HeldKeys(), 0.0
    for _ in range(20):
        used_keys.press_typed(rng.choice(KEYS)[0], now_s)
        now_s += rng.random()
    now_s += FIRST_HOLD_S
    for _ in range(20):
        typed_text = rng.choice(KEYS)[0]
        used_keys.press_typed(typed_text, now_s)
        unused_keys.press_typed(typed_text, now_s)
        for _ in range(rng.randrange(9)):
            assert used_keys.keys_at(now_s) == unused_keys.keys_at(now_s)
            now_s += 0.1


# -- a terminal and a robot ------------------------------------------------------------------------


class KeysRefused(Exception):
    """The robot accepts no keys."""


class Table:
    """A terminal, the connection to a robot, and a clock."""

    def __init__(self, features: int = REMOTE) -> None:
        self.now_s, self.typed_keys, self.is_entered = 0.0, "", False
        self.device_info = SimpleNamespace(values=SimpleNamespace(features=features))
        self.words: list[tuple[float, RemoteState]] = []
        self.status: int | None = None  # of the answers

    def __enter__(self) -> None:
        self.is_entered = True

    def __exit__(self, *_: object) -> None:
        self.is_entered = False

    def read_keys(self) -> str:
        typed_keys, self.typed_keys = self.typed_keys, ""
        return typed_keys

    def begin_request(
        self, make_request: Callable[[Any], PendingRequest[Any]]
    ) -> PendingRequest[Any]:
        return make_request(self)

    def press(self, *state: int) -> PendingRequest[Any]:
        self.words.append((self.now_s, RemoteState(*state)))
        request: PendingRequest[Any] = PendingRequest()
        request.outcome = None if self.status is None else Reply(self.status)
        return request

    def error_for_reply(self, reply: Reply[Any]) -> Exception:
        return KeysRefused(reply.status)


def remote_at(table: Table, monkeypatch: pytest.MonkeyPatch) -> TerminalRemote:
    monkeypatch.setattr(remote_keys, "monotonic", lambda: table.now_s)
    monkeypatch.setattr(remote_keys, "Keys", lambda: table)
    return TerminalRemote(cast(Connection, table))


@pytest.mark.parametrize("seed", range(10))
def test_held_keys_are_sent_at_once_and_repeatedly(
    seed: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It hears nothing while nothing is held."""
    rng, table, held_keys = random.Random(seed), Table(), HeldKeys()
    with remote_at(table, monkeypatch) as remote:
        for _ in range(1500):
            table.typed_keys = rng.choice(KEYS)[0] if rng.random() < 0.05 else ""
            held_keys.press_typed(table.typed_keys, table.now_s)
            table.status = rng.choice((OK, CANCELLED, LOST, None))
            remote.poll()
            held_state = held_keys.keys_at(table.now_s)
            sent_s, sent_state = table.words[-1] if table.words else (0.0, NOTHING_PRESSED)
            assert sent_state == held_state
            assert held_state == NOTHING_PRESSED or table.now_s - sent_s < SEND_INTERVAL_S
            table.now_s += POLL_S
        assert table.is_entered
    assert not table.is_entered
    for (before_s, earlier_word), (after_s, later_word) in pairwise(table.words):
        is_due = after_s - before_s > SEND_INTERVAL_S - POLL_S and later_word != NOTHING_PRESSED
        assert earlier_word != later_word or is_due


@pytest.mark.parametrize("name", ["NOT_OWNER", "NO_REMOTE", "LATCHED"])
def test_a_robot_that_accepts_no_keys_is_an_error(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    table = Table()
    with remote_at(table, monkeypatch) as remote, pytest.raises(KeysRefused):
        table.status, table.typed_keys = STATUSES[name], "a"
        remote.poll()
        remote.poll()
    assert not table.is_entered
    older_table = Table(features=0)
    with pytest.raises(KeysRefused), remote_at(older_table, monkeypatch):
        pass
    assert not older_table.is_entered and not older_table.words


def test_q_interrupts_like_ctrl_c_but_is_distinguishable(monkeypatch: pytest.MonkeyPatch) -> None:
    table = Table()
    with remote_at(table, monkeypatch) as remote:
        remote.poll()
        assert not remote.has_quit
        table.typed_keys = "aq"
        with pytest.raises(KeyboardInterrupt):
            remote.poll()
        assert remote.has_quit and not table.words
