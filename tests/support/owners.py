"""Shared parts of tests about owners: keys in memory, and a robot with its computer."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from tests.machines.host_firmware import EMPTY_EEPROM, HostFirmware
from tests.support.images import image_of
from tiniscript import robots
from tiniscript.link.authority import KeyRing, RobotKey, ownership_of
from tiniscript.link.connection import PendingRequest
from tiniscript.link.frames import Frame, decode_frame, encode_frame
from tiniscript.link.messages import BY_NAME, BY_NUMBER, FIRST_EVENT, STATUS_NAMES
from tiniscript.link.session import Session

KIT = robots.load("tinibot").kit
BUTTON_PRESSED, BUTTON_RELEASED, BUTTON_HELD = 1, 2, 32
FOREVER = "SI|F(200, 40)"
# Requests that anyone may send to a claimed robot.
UNSEALED_REQUESTS = {"HELLO", "PING", "STATUS", "STOP", "IDENTIFY"}


class Keys(KeyRing):
    """A `KeyRing` in memory. Keys are numbered, so each run has the same."""

    def __init__(self, first_number: int = 1) -> None:
        self.stored_keys: list[RobotKey] = []
        self.next_number = first_number
        self.is_full = False
        self.id_by_place: dict[str, int] = {}
        self.accepted_ids: set[int] = set()

    def robot_at(self, place: str) -> int | None:
        return self.id_by_place.get(place)

    def remember_robot(self, place: str, robot: int) -> None:
        self.id_by_place[place] = robot

    def accepts(self, robot: int) -> bool:
        return robot in self.accepted_ids

    def _stored_keys(self) -> list[RobotKey]:
        return self.stored_keys

    def _change_keys(self, change: Callable[[list[RobotKey]], list[RobotKey]]) -> bool:
        self.stored_keys = change(self.stored_keys)
        return True

    def create_pending_key(self, robot: int, kind: int, name: str) -> RobotKey | None:
        if self.is_full:
            return None
        key = RobotKey(robot, kind, bytes([self.next_number] * 16), name, True)
        self.next_number += 1
        self.stored_keys.append(key)
        return key


NO_SEALS_DEFINES = ("tiniscript_without_seals",)


@pytest.fixture(autouse=True, params=[(), NO_SEALS_DEFINES], ids=["seals", "no seals"])
def robots_of_both_kinds(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """The tests of a file that imports this are done with robots that seal, and with others."""
    monkeypatch.setattr(OwnedRobot, "DEFINES", request.param)


class OwnedRobot:
    """A robot and one computer after the other."""

    DEFINES: tuple[str, ...] = ()

    def __init__(
        self,
        memory: bytes = EMPTY_EEPROM,
        seed: int = 0x12345678,
        defines: tuple[str, ...] | None = None,
    ) -> None:
        all_defines = self.DEFINES if defines is None else defines
        self.robot = HostFirmware(KIT, memory, seed=seed, defines=all_defines)
        self.robot.wait(300)

    @property
    def seals(self) -> bool:
        return self.DEFINES != NO_SEALS_DEFINES

    def session(self, keys: Keys | None = None, nonce: int = 1, place: str = "") -> Session:
        return Session(nonce, 115200, KIT.fingerprint, keys=keys, place=place)

    def outcome(self, session: Session, request: PendingRequest[Any]) -> str:
        return STATUS_NAMES.get(status := self.robot.until(session, request, 60_000), str(status))

    def frames(
        self, session: Session, request: PendingRequest[Any]
    ) -> tuple[list[bytes], list[bytes]]:
        """Let both talk until a request is done; return the frames to the robot, and those back."""
        requests = replies = b""
        while request.outcome is None:
            data = session.poll(self.robot.now_ms)
            reply = self.robot.step(data)
            session.receive(reply, self.robot.now_ms)
            requests, replies = requests + data, replies + reply
        assert request.outcome.status == 0
        return [part for part in requests.split(b"\0") if part], [
            part for part in replies.split(b"\0") if part
        ]

    def answer(self, frame: Frame | bytes) -> Frame | None:
        """Return the robot's answer to a frame, or to its bytes."""
        data = frame + b"\0" if isinstance(frame, bytes) else encode_frame(frame)
        frames = [part for part in self.robot.wait(20, b"\0" + data).split(b"\0") if part]
        return decode_frame(frames[0]) if frames else None

    def ask_unsealed(self, session: Session, name: str, payload: bytes) -> bytes:
        """Return the robot's answer to the next frame of a session, without a seal."""
        session._seq = (session._seq + 1) & 0xFF
        answer = self.answer(Frame(BY_NAME[name].number, session._seq, session._epoch, payload))
        assert answer, name
        return answer.payload

    def hold(self, session: Session | None, milliseconds: int) -> None:
        """Hold the button down, while a computer talks."""
        self.advance_time(session, 1, BUTTON_PRESSED)
        self.advance_time(session, 30)
        self.advance_time(session, milliseconds - 31, BUTTON_HELD)
        self.advance_time(session, 1, BUTTON_RELEASED)

    def advance_time(self, session: Session | None, milliseconds: int, flags: int = 0) -> None:
        self.robot.advance_time(session, milliseconds, flags)

    def claim(self, session: Session, kind: int = 0) -> str:
        request = session.claim(kind)
        self.advance_time(session, 500)
        self.hold(session, 2200)
        return self.outcome(session, request)

    def claim_session(self, keys: Keys, kind: int = 0) -> Session:
        session = self.session(keys)
        assert self.claim(session, kind) == "OK"
        return session

    def try_to_drive(self, session: Session) -> str:
        """Return the robot's answer to a client that wants to drive."""
        return self.outcome(session, session.upload(image_of(FOREVER), saves=False))


def owner_of(table: OwnedRobot, session: Session) -> str:
    assert table.outcome(session, session.hello()) == "OK"
    assert session.robot
    return ownership_of(session.robot)


def state_of(table: OwnedRobot, session: Session) -> int:
    return table.robot.complete(session, session.status()).state


def grants_key_request(sent_bytes: bytes) -> bool:
    """Return whether an answer says that something was done for which it takes a key."""
    frame = decode_frame(sent_bytes)
    if frame is None or frame.number not in BY_NUMBER or not frame.payload:
        return False
    message = BY_NUMBER[frame.number]
    if message.name == "AUTHENTICATE":  # a challenge is for anybody
        is_open = len(frame.payload) == 1 + 2 + 8
    else:
        is_open = message.name in UNSEALED_REQUESTS or message.number >= FIRST_EVENT
    return frame.payload[0] == 0 and not is_open
