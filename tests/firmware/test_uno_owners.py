"""Owners on the simulated Uno: the pin of its button, the time of its EEPROM and of a hash."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.machines.uno import needed
from tests.machines.wired import Wired
from tests.support.owners import Keys
from tests.support.platformio import firmware, shared
from tiniscript import robots
from tiniscript.link.authority import FREE, OF_ANOTHER, YOUR_OWN, whose
from tiniscript.link.messages import KEY_OWNER, KEY_TEACHER, STATUSES
from tiniscript.link.session import Session
from tools.bench.firmware_stack import pin
from tools.uno import Uno

ROBOT = robots.load("tinibot")
HASH_MS = 12  # from a tag to its answer, beside the bytes: a stop is in the interrupt


@pytest.fixture(autouse=True)
def needs_a_chip() -> None:
    needed()


@pytest.fixture(scope="module")
def sketch(tmp_path_factory: pytest.TempPathFactory) -> Path:
    needed()
    return firmware("uno", tmp_path_factory.mktemp("sketch"), shared(tmp_path_factory))


def session(keys: Keys | None, nonce: int) -> Session:
    return Session(nonce, ROBOT.board.baud, ROBOT.kit.fingerprint, keys=keys)


def owner_of(wired: Wired) -> str:
    assert wired.until(wired.session.hello()) == 0
    assert wired.session.robot
    return whose(wired.session.robot)


@pytest.mark.sampled(of="long ways of a chip")
def test_a_claim_outlives_a_reset_and_ten_seconds_of_the_button_forget_it(sketch: Path) -> None:
    keys = Keys()
    with Uno(sketch, baud=ROBOT.board.baud, tells_sleep=False) as uno:
        button = pin(ROBOT, ROBOT.board.start_button)
        uno.run_ms(300)
        wired = Wired(uno, session(keys, 1))
        assert owner_of(wired) == FREE
        request = wired.session.claim(KEY_OWNER)
        wired.run(300)
        uno.press(button, 1900)
        wired.run(2500)
        assert request.outcome is None  # too short
        uno.press(button, 2100)
        assert wired.until(request) == 0
        assert wired.until(wired.session.trim()) == 0
        wired.session = session(None, 2)
        assert owner_of(wired) == OF_ANOTHER
        assert wired.until(wired.session.start()) == STATUSES["NOT_OWNER"]
        uno.reset("external")
        uno.run_ms(300)
        wired.session = session(keys, 3)
        assert owner_of(wired) == YOUR_OWN
        uno.press(button, 10_700)  # down before the reset
        uno.run_ms(100)
        uno.reset("external")
        uno.run_ms(9_500)
        wired.session = session(keys, 4)
        assert owner_of(wired) == YOUR_OWN
        uno.run_ms(1500)
        wired.session = session(keys, 5)
        assert owner_of(wired) == FREE
        assert wired.until(wired.session.claim(KEY_TEACHER), 40_000) == STATUSES["HOLD_BUTTON"]


def test_a_stop_acts_at_once_while_a_tag_is_made(sketch: Path) -> None:
    """A key that is shown takes the main loop some milliseconds, and no more."""
    keys = Keys()
    with Uno(sketch, baud=ROBOT.board.baud, tells_sleep=False) as uno:
        uno.run_ms(300)
        wired = Wired(uno, session(keys, 1))
        request = wired.session.claim(KEY_OWNER)
        wired.run(300)
        uno.press(pin(ROBOT, ROBOT.board.start_button), 2100)
        assert wired.until(request) == 0
        wired.session = session(keys, 2)
        begun_ms = wired.now_ms
        assert wired.until(wired.session.hello()) == 0
        # HELLO and its answer, a challenge, a tag: about 150 bytes on the line
        bytes_ms = 150 * 10 * 1000 / ROBOT.board.baud
        assert wired.now_ms - begun_ms <= bytes_ms + 2 * HASH_MS + 8
