"""A client that sends whole frames of any kind, length and order, text and zeros between them.

Each of its requests is answered; stale requests have no effect; a program that the robot reports is
the one that was sent. Afterwards a stop stops it, and the next line is done.
`python -m tests.firmware.test_hostile_client 1000` is a campaign.
"""

from __future__ import annotations

import pytest

from tests.support.campaign import each_seed, make_options
from tests.support.hostile_client import Client

SEEDS = 12  # seeds of the tests; a campaign runs more
TURN_COUNT = 120


def play(seed: int) -> None:
    client = Client(seed)
    client.send_hello()
    for _ in range(TURN_COUNT):
        client.take_turn()
    client.check_obeys()


@pytest.mark.parametrize("seed", range(SEEDS))
def test_a_hostile_client_is_answered_and_the_robot_keeps_working(seed: int) -> None:
    play(seed)


if __name__ == "__main__":
    each_seed(play, make_options(1000, 1000))
