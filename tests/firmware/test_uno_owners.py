"""Owners on the simulated Uno: the pin of its button, the time of its EEPROM and of a hash."""

from __future__ import annotations

from pathlib import Path

from tests.machines.wired import Wired
from tests.support.owners import Keys
from tiniscript import robots
from tiniscript.link.authority import OF_ANOTHER, YOUR_OWN, whose
from tiniscript.link.messages import KEY_OWNER
from tiniscript.link.session import Session
from tools.bench.firmware_stack import pin
from tools.uno import Uno

ROBOT = robots.load("tinibot")
HASH_MS = 12  # from a tag to its answer, beside the bytes: a stop is in the interrupt


def session(keys: Keys | None, nonce: int) -> Session:
    return Session(nonce, ROBOT.board.baud, ROBOT.kit.fingerprint, keys=keys)


def owner_of(wired: Wired) -> str:
    assert wired.until(wired.session.hello()) == 0
    assert wired.session.robot
    return whose(wired.session.robot)


def test_a_tag_takes_milliseconds_and_a_claim_outlives_a_reset(sketch: Path) -> None:
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
        uno.reset("external")
        uno.run_ms(300)
        for nonce, shown, owner in ((3, keys, YOUR_OWN), (4, None, OF_ANOTHER)):
            wired.session = session(shown, nonce)
            assert owner_of(wired) == owner
