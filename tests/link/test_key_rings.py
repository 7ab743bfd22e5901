"""The keys of a person, in a file or in a page, with any operations in any order."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from random import Random
from types import SimpleNamespace
from typing import Any, TypeVar, cast

import pytest

from tiniscript.link import authority
from tiniscript.link.authority import MAX_PENDING_KEYS, KeyRing, RobotKey
from tiniscript.link.keys import KeyFile, encode_keys
from tiniscript.link.messages import KEY_BYTES, KEY_OWNER, KEY_TEACHER, SEALS, STATUSES
from tiniscript.link.payloads import AuthenticateReply, EmptyReply
from tiniscript.link.requests import ACCEPTING_STATUSES, OK, DeviceInfo, Exchange, Reply, Request
from tiniscript.link.seal import siphash
from tiniscript.studio.page_line import PageKeys

SLOTS = [(robot, kind) for robot in (1, 2) for kind in (KEY_OWNER, KEY_TEACHER)]
CHANGE_COUNT = 40
CHALLENGE, NONCE = b"12345678", 7
T = TypeVar("T")


def add(ring: KeyRing, keys: Iterable[RobotKey]) -> None:
    if isinstance(ring, PageKeys):
        ring.add(encode_keys(keys))
    else:
        assert isinstance(ring, KeyFile)
        ring.add(keys)


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("kind", [KeyFile, PageKeys])
def test_a_claim_stays_until_it_is_confirmed_or_given_up(
    kind: type[KeyRing], seed: int, tmp_path: Path
) -> None:
    """The robot may have taken its key, and keeps no second copy. A robot that confirms another key
    does not have the claimed one; only the newest claims of a robot and a person are kept."""
    rng = Random(seed)
    ring: KeyRing = KeyFile(tmp_path / "keys.json") if kind is KeyFile else PageKeys(b"")
    claims: list[RobotKey] = []
    lists = [
        [RobotKey(*slot, rng.randbytes(KEY_BYTES)) for slot in rng.sample(SLOTS, k)]
        for k in (1, 2, len(SLOTS))
    ]
    for _ in range(CHANGE_COUNT):
        slot, known_keys = rng.choice(SLOTS), ring.keys_of_robot(None)
        key = rng.choice([*known_keys, *rng.choice(lists)])
        match rng.choice(["claim", "import", "refuse", "confirm", "drop", "forget", "load"]):
            case "claim":
                claim = ring.create_pending_key(*slot, "TINI")
                assert claim is not None
                older_claims = [claim for claim in claims if claim.slot == slot]
                claims = [c for c in claims if c not in older_claims[:-MAX_PENDING_KEYS]] + [claim]
            case "import":
                add(ring, rng.choice(lists))
            case "refuse":
                ring.mark_stale(key)
            case "confirm":
                ring.settle_key(key)
                if key._replace(is_pending=False, is_stale=False) not in known_keys:
                    claims = [claim for claim in claims if claim.slot != key.slot]
            case "drop":
                ring.drop_key(key)
                claims = [claim for claim in claims if claim.key != key.key]
            case "forget" if isinstance(ring, KeyFile):
                ring.forget(slot[0])
                claims = [claim for claim in claims if claim.id != slot[0]]
            case "load" if isinstance(ring, PageKeys):
                ring = PageKeys(ring.file().encode())
        new_keys = ring.keys_of_robot(None)
        assert [key[:3] for key in new_keys if key.is_pending] == [key[:3] for key in claims]
        settled_slots = [key.slot for key in new_keys if not key.is_pending]
        assert len(settled_slots) == len({*settled_slots}), "of the others, each slot has one"


class Robot:
    """A robot that has a key for each person who has claimed it. Its answers are lost now and then,
    and its answer to a new key is arbitrary: it has it, it will keep it, or it accepts none."""

    def __init__(self, rng: Random) -> None:
        self.rng = rng
        self.keys: dict[int, bytes] = {}
        self.loss = 0.0
        self.has_seals = False
        self._status_by_key: dict[bytes, int] = {}
        self._is_stale = False

    @property
    def info(self) -> DeviceInfo:
        values = SimpleNamespace(features=SEALS * self.has_seals, nonce=1)
        return cast(DeviceInfo, SimpleNamespace(id=1, name="TINI", values=values))

    def answer(self, exchange: Exchange[T]) -> Reply[T] | None:
        """Answer an exchange; return the result, or None if the link was lost."""
        try:
            request = next(exchange)
            while True:
                is_heard, is_answered = (self.rng.random() >= self.loss for _ in range(2))
                reply = self._reply(request) if is_heard else None
                if reply is None or not is_answered:
                    return None
                request = exchange.send(reply)
        except StopIteration as end:
            return cast(Reply[T], end.value)

    def _reply(self, request: Request) -> Reply[Any]:
        kind = int(request.values["kind"])
        if request.name == "CLAIM":
            status = self._take(kind, cast(bytes, request.values["key"]))
            return Reply(status, 0, EmptyReply())
        assert request.name == "AUTHENTICATE"
        tag, key = request.values["tag"], self.keys.get(kind)
        if not tag:
            return Reply(OK, 0, AuthenticateReply(0, CHALLENGE))
        self._is_stale = not self._is_stale and self.rng.random() < 0.2
        if self._is_stale:  # it was stopped in this moment
            return Reply(STATUSES["STALE"])
        message = CHALLENGE + NONCE.to_bytes(4, "little") + bytes([0, kind])
        is_right = key is not None and tag == siphash(key, message)
        return Reply(OK, 0, AuthenticateReply(0, b"")) if is_right else Reply(STATUSES["WRONG_KEY"])

    def _take(self, kind: int, key: bytes) -> int:
        if not key:
            self.keys.pop(kind, None)
            return OK
        statuses = [OK, *ACCEPTING_STATUSES, STATUSES["NOT_OWNER"]]
        status = self._status_by_key.setdefault(key, self.rng.choice(statuses))
        if status in (OK, *ACCEPTING_STATUSES):
            self.keys[kind] = key
        return status


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("kind", [KeyFile, PageKeys])
def test_a_robot_stays_its_owners_whatever_claims_were_lost(
    kind: type[KeyRing], seed: int, tmp_path: Path
) -> None:
    """The key that a robot has is never gone here, and it is shown; then it is known that this one
    is right, and that its robot seals, for ever."""
    rng = Random(seed)
    ring: KeyRing = KeyFile(tmp_path / "keys.json") if kind is KeyFile else PageKeys(b"")
    robot = Robot(rng)
    sealing_keys = set[bytes]()
    for _ in range(CHANGE_COUNT):
        robot.loss, role = rng.choice((0.0, 0.3)), rng.choice((KEY_OWNER, KEY_TEACHER))
        robot.has_seals = rng.random() < 0.5  # it may have older firmware
        if rng.random() < 0.7:
            robot.answer(authority.claim(ring, robot.info, role))
        else:
            robot.answer(authority.disown(ring, robot.info, role))
        robot.answer(authority.authenticate(ring, robot.info, NONCE, lambda: 0, is_needed=False))
        kept_keys = {key.key for key in ring.keys_of_robot(1)}
        assert {*robot.keys.values()} <= kept_keys
        robot.loss = 0.0  # before the claim, another client has connected
        for role, robot_key in robot.keys.items():
            key_proof = authority.authenticate(
                ring, robot.info, NONCE, lambda: 0, role, is_needed=False
            )
            reply = robot.answer(key_proof)
            assert reply is not None and reply.status == OK
            [own_key] = [key for key in ring.keys_of_robot(1) if key.key == robot_key]
            sealing_keys |= {robot_key} if robot.has_seals else set()
            assert (own_key.kind, own_key.is_pending, own_key.is_stale) == (role, False, False)
            assert own_key.uses_seals == (robot_key in sealing_keys)
