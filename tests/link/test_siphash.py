"""SipHash-2-4, in Python and in the robot: against the vectors of its authors."""

from __future__ import annotations

import random

from tests.machines.link import cpp_link
from tiniscript.link.seal import siphash

KEY = bytes(range(16))
# Of the messages 00, 00 01, 00 01 02 ...: from the empty one, which of each length of a last block.
VECTORS = [
    "310e0edd47db6f72",
    "fd67dc93c539f874",
    "5a4fa9d909806c0d",
    "2d7efbd796666785",
    "b7877127e09427cf",
    "8da699cd64557618",
    "cee3fe586e46c9cb",
    "37d1018bf50002ab",
    "6224939a79f5f593",
    "b0e4a90bdf82009e",
    "f3b9dd94c5bb5d7a",
    "a7ad6b22462fb3f4",
    "fbe50e86bc8f1e75",
    "903d84c02756ea14",
    "eef27a8e90ca23f7",
    "e545be4961ca29a1",
    "db9bc2577fcc2a3f",
]


def test_the_vectors_of_the_authors() -> None:
    assert [siphash(KEY, bytes(range(n))).hex() for n in range(len(VECTORS))] == VECTORS


def test_the_robot_has_the_same_of_any_key_and_message() -> None:
    chance = random.Random(1)
    for _ in range(500):
        key, message = chance.randbytes(16), chance.randbytes(chance.randrange(200))
        assert cpp_link().siphash(key, message) == siphash(key, message)
