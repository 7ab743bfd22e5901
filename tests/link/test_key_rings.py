"""The keys of a person, in a file or in a page: whatever is done with them, and in which order."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from random import Random

import pytest

from tiniscript.link.authority import MOST_PENDING_KEYS, KeyRing, RobotKey
from tiniscript.link.keys import KeyFile, encode_keys
from tiniscript.link.messages import KEY_BYTES, KEY_OWNER, KEY_TEACHER
from tiniscript.studio.page_line import PageKeys

SLOTS = [(robot, which) for robot in (1, 2) for which in (KEY_OWNER, KEY_TEACHER)]
CHANGES = 40


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
    """The robot may have taken its key, and keeps no second copy. What confirms another key, says
    that the robot has not; only the newest claims of a robot and a person are kept."""
    chance = Random(seed)
    ring: KeyRing = KeyFile(tmp_path / "keys.json") if kind is KeyFile else PageKeys(b"")
    claims: list[RobotKey] = []
    lists = [
        [RobotKey(*slot, chance.randbytes(KEY_BYTES)) for slot in chance.sample(SLOTS, k)]
        for k in (1, 2, len(SLOTS))
    ]
    for _ in range(CHANGES):
        slot, known_keys = chance.choice(SLOTS), ring.keys_of_robot(None)
        key = chance.choice([*known_keys, *chance.choice(lists)])
        match chance.choice(["claim", "import", "refuse", "confirm", "drop", "forget", "load"]):
            case "claim":
                claim = ring.create_pending_key(*slot, "TINI")
                assert claim is not None
                older_claims = [other for other in claims if other.slot == slot]
                claims = [c for c in claims if c not in older_claims[:-MOST_PENDING_KEYS]] + [claim]
            case "import":
                add(ring, chance.choice(lists))
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
