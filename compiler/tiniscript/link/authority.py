"""The exchanges about a robot's owner: to authenticate, to claim a robot, to give it up.

It knows the order of messages and the format of a tag. Knows no file: a `KeyRing` keeps the keys.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from typing import NamedTuple

from tiniscript.link import requests
from tiniscript.link.messages import KEY_BYTES, KEY_TEACHER, OWNED, SEALS, STATUSES, YOURS
from tiniscript.link.outcomes import UNKEPT
from tiniscript.link.payloads import AuthenticateReply, EmptyReply
from tiniscript.link.port_names import canonical_name
from tiniscript.link.requests import ACCEPTING_STATUSES, OK, DeviceInfo, Exchange, Reply, Request
from tiniscript.link.seal import Seal, session_key, siphash

NOT_OWNER, WRONG_KEY, HOLD_BUTTON, STALE = (
    STATUSES[name] for name in ("NOT_OWNER", "WRONG_KEY", "HOLD_BUTTON", "STALE")
)
MAX_PENDING_KEYS = 1  # keys tried before a new one, because each takes time
HOLD_PAUSE_MS = 200  # pause between questions while the button is up
FREE, OWNED_BY_YOU, OWNED_BY_OTHER = "free", "yours", "other"


class RobotKey(NamedTuple):
    """A key of a robot. `kind` is one of KEYS; `name` is the robot's.

    `is_pending`: it is not known whether the robot has taken it; `is_stale`: the robot has refused
    it, so it is shown only if something depends on it; `uses_seals`: the robot seals, so unsealed
    frames are not trusted.
    """

    id: int
    kind: int
    key: bytes
    name: str = ""
    is_pending: bool = False
    is_stale: bool = False
    uses_seals: bool = False

    @property
    def slot(self) -> tuple[int, int]:
        """A robot and a person, who share one key."""
        return self.id, self.kind

    def __repr__(self) -> str:  # a key is in no message
        return f"RobotKey({self.id:08x}, {self.kind})"


class KeyRing:
    """The keys of a person; a class of it says where they are. No method raises an exception."""

    def _stored_keys(self) -> list[RobotKey]:
        """Return all keys."""
        raise NotImplementedError

    def _change_keys(self, change: Callable[[list[RobotKey]], list[RobotKey]]) -> bool:
        """Change the stored keys; return whether that was possible."""
        raise NotImplementedError

    def keys_of_robot(self, robot_id: int | None) -> list[RobotKey]:
        """Return the keys of a robot, or of all."""
        return [key for key in self._stored_keys() if robot_id in (None, key.id)]

    def create_pending_key(self, robot_id: int, kind: int, name: str) -> RobotKey | None:
        """Make a key and keep it as a pending one; None if it cannot be kept."""
        key = RobotKey(robot_id, kind, os.urandom(KEY_BYTES), name, is_pending=True)

        def with_key_added(keys: list[RobotKey]) -> list[RobotKey]:
            pending_keys = [
                robot_key
                for robot_key in keys
                if robot_key.is_pending and robot_key.slot == key.slot
            ]
            return [
                *(
                    robot_key
                    for robot_key in keys
                    if robot_key not in pending_keys[:-MAX_PENDING_KEYS]
                ),
                key,
            ]

        return key if self._change_keys(with_key_added) else None

    def robot_at(self, place: str) -> int | None:
        """Return the robot of ours that has proved its identity at a place."""
        return None

    def remember_robot(self, place: str, robot_id: int) -> None:
        """Remember the place at which one of our robots has proved its identity."""

    def accepts(self, robot_id: int) -> bool:
        """Return whether a robot may answer in the place of one of ours."""
        return False

    def settle_key(self, key: RobotKey) -> None:
        """The robot has taken a pending key: it replaces the one before."""
        settled_key = key._replace(is_pending=False, is_stale=False)

        def with_key_settled(keys: list[RobotKey]) -> list[RobotKey]:
            if settled_key in keys:
                return keys
            return [*(robot_key for robot_key in keys if robot_key.slot != key.slot), settled_key]

        self._change_keys(with_key_settled)

    def mark_stale(self, key: RobotKey) -> None:
        """The robot has another key than this one: it is stale, until it is right after all."""
        self._change_keys(lambda keys_before: [
            item._replace(is_stale=True) if item[:3] == key[:3] else item for item in keys_before
        ])  # fmt: skip

    def drop_key(self, key: RobotKey) -> None:
        """The robot has not taken, or no longer has, this key."""
        self._change_keys(
            lambda keys_before: [robot_key for robot_key in keys_before if robot_key.key != key.key]
        )


def ownership_of(robot: DeviceInfo) -> str:
    """Return whether a robot is FREE, OWNED_BY_YOU or OWNED_BY_OTHER."""
    features = robot.values.features
    if not features & OWNED:
        return FREE
    return OWNED_BY_YOU if features & YOURS else OWNED_BY_OTHER


def has_to_seal(ring: KeyRing | None, robot: DeviceInfo | None) -> bool:
    """Return whether our keys say that a robot seals; if no robot is known, whether any does."""
    if ring is None:
        return False
    keys = ring.keys_of_robot(None if robot is None else robot.id)
    return any(key.uses_seals and not key.is_pending for key in keys)


def is_impostor(ring: KeyRing | None, place: str, robot: DeviceInfo) -> bool:
    """Return whether another device answers in the place of one of our sealing robots: at its last
    place, or with its name. A robot whose key we have must prove its identity.
    """
    our_keys = [] if ring is None else ring.keys_of_robot(None)
    our_keys = [key for key in our_keys if key.uses_seals and not key.is_pending]
    if ring is None or any(key.id == robot.id for key in our_keys) or ring.accepts(robot.id):
        return False
    known_id, name = ring.robot_at(place), canonical_name(robot.name)
    return any(key.id == known_id or canonical_name(key.name) == name != "" for key in our_keys)


def authenticate(
    ring: KeyRing | None,
    robot: DeviceInfo,
    nonce: int,
    current_epoch: Callable[[], int],
    kind: int | None = None,
    is_needed: bool = True,
) -> Exchange[AuthenticateReply]:
    """Try our keys of a robot, the teacher's first, until one is right; only `kind` if it is given.

    Then it is known of a pending key whether the robot has taken it. A stale key is tried only if
    it `is_needed`, since trying it takes time.
    """
    reply: Reply[AuthenticateReply] = Reply(NOT_OWNER)
    keys = [] if ring is None else ring.keys_of_robot(robot.id)
    for key in sorted(keys, key=_key_order):
        if kind not in (None, key.kind) or (key.is_stale and not is_needed):
            continue
        reply = yield from _authenticate_with(key, robot, nonce, current_epoch)
        if reply.status == STALE:  # a stop or a fault came between: the tag was one of before
            reply = yield from _authenticate_with(key, robot, nonce, current_epoch)
        if ring is not None and reply.status == OK:
            proven_key = key._replace(
                is_pending=False, is_stale=False, uses_seals=_can_seal(robot) or key.uses_seals
            )
            if proven_key != key:
                ring.settle_key(proven_key)
        if ring is not None and reply.status == WRONG_KEY:
            ring.mark_stale(key)  # stored anyway: the robot may have accepted it
        if reply.status != WRONG_KEY:
            break
    return reply


def _can_seal(robot: DeviceInfo) -> bool:
    return bool(robot.values.features & SEALS)


def _key_order(key: RobotKey) -> tuple[bool, bool, bool]:
    return key.is_stale, key.kind != KEY_TEACHER, key.is_pending


def _authenticate_with(
    key: RobotKey, robot: DeviceInfo, nonce: int, current_epoch: Callable[[], int]
) -> Exchange[AuthenticateReply]:
    challenge_request = Request("AUTHENTICATE", {"kind": key.kind, "tag": b""})
    reply = yield from requests.retry_while_busy(challenge_request, AuthenticateReply)
    if reply.status != OK:
        return reply
    challenge = reply.values.challenge
    message = challenge + nonce.to_bytes(4, "little") + bytes([current_epoch(), key.kind])
    seal = None
    if _can_seal(robot):
        robot_nonce = robot.values.nonce
        seal = Seal(session_key(key.key, challenge, nonce, robot_nonce, current_epoch(), key.kind))
    tag = siphash(key.key, message)
    tag_request = Request("AUTHENTICATE", {"kind": key.kind, "tag": tag}, seal=seal)
    return (yield from requests.retry_while_busy(tag_request, AuthenticateReply))


def claim(ring: KeyRing, robot: DeviceInfo, kind: int) -> Exchange[EmptyReply]:
    """Claim the robot with a new key, if its button was held during the request."""
    key = ring.create_pending_key(robot.id, kind, robot.name)
    if key is None:
        return Reply(UNKEPT)
    request = Request("CLAIM", {"kind": kind, "key": key.key})
    reply = yield from requests.save_and_confirm(request, EmptyReply)
    while reply.status == HOLD_BUTTON:
        reply = yield from requests.save_and_confirm(
            request._replace(pause_ms=HOLD_PAUSE_MS), EmptyReply
        )
    if reply.status == OK:
        ring.settle_key(key._replace(uses_seals=_can_seal(robot)))
    elif reply.status not in ACCEPTING_STATUSES:
        ring.drop_key(key)
    return reply


def disown(ring: KeyRing, robot: DeviceInfo, kind: int) -> Exchange[EmptyReply]:
    """Take a key away from the robot."""
    request = Request("CLAIM", {"kind": kind, "key": b""})
    reply = yield from requests.save_and_confirm(request, EmptyReply)
    if reply.status == OK:
        for key in ring.keys_of_robot(robot.id):
            if key.kind == kind:
                ring.drop_key(key)
    return reply
