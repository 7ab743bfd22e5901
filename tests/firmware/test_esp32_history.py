"""Whatever its clients have done, an ESP32 without clients is like one just switched on.

Owners, strangers and people connect over any of its transports, two at once, ask and type and leave
in the middle of it. Then all have left, and a twin with the same memory is switched on: from here
on, every client gets the same from both.

`python -m tests.firmware.test_esp32_history 200` tries more.
"""

from __future__ import annotations

import random
import re
from collections.abc import Callable
from functools import lru_cache
from typing import Any, NamedTuple

import pytest

from tests.machines.esp32 import Esp32Robot, Kept
from tests.support.bytes_around import PIECES
from tests.support.campaign import each_seed, make_options
from tests.support.compared_answers import answer_without_counts, first_difference, without_counts
from tests.support.esp32_radio import Client, End, RawClient, radios, talk
from tests.support.esp32_wifi import join_network, remote, remote_with_wrong_key, school_in_reach
from tests.support.images import image_of
from tests.support.owners import Keys
from tests.support.robot_on_esp32 import TRANSPORTS, Make
from tiniscript.link.authority import RobotKey
from tiniscript.link.connection import PendingRequest
from tiniscript.link.messages import AUTHORITY_MS, LISTEN_MS, STOP_BYTES
from tiniscript.link.session import Session

SHORT_PROGRAM = "SI|F(0.1, 80);SHOW(2);B(0.1, 30)"
LONG_PROGRAM = "SI|" + "F(0.1, 80); B(0.1, 60); SHOW(1); " * 20
REQUEST_MAKERS: dict[str, Callable[[Session], PendingRequest[Any]]] = {
    "hello": lambda session: session.hello(),
    "ping": lambda session: session.ping(),
    "clear": lambda session: session.clear(),
    "trim?": lambda session: session.trim(),
    "identify": lambda session: session.identify(),
    "a live line": lambda session: session.live(image_of(SHORT_PROGRAM).code),
    "a program": lambda session: session.upload(image_of(SHORT_PROGRAM), saves=False),
    "a long program": lambda session: session.upload(image_of(LONG_PROGRAM), saves=False),
    "a detached one": lambda session: session.upload(
        image_of(LONG_PROGRAM), saves=False, is_detached=True
    ),
    "a network": lambda session: session.wifi(),
    "a broker": lambda session: session.broker(),
    "a claim": lambda session: session.claim(0),
    "text": lambda session: session.allow_text(False),
}
LINES = (b"SI|F(0.1, 80);SHOW(3)\n", b"F(0.1, 30)\n", b"FOO(1)\n", b"HELP\n", b"SI|LOOP(2)\n",
         b"SI|F(1", b"S\n", b"PING|CHECK_CONNECTION\n", b"SB|B(0.2, 40)\n")  # fmt: skip
# The state of the program in memory, which is not saved.
MEMORY_FIELDS = ("program", "length", "slot", "saved")
TRANSPORT_MAKERS: list[Make | None] = [None, *TRANSPORTS]  # None: the cable
NETWORK = 3  # a transport with several slots
LONGEST_WAIT_MS = max(LISTEN_MS, AUTHORITY_MS) + 1200


@lru_cache(maxsize=1)
def memory_with_network() -> tuple[Kept, RobotKey]:
    """Return the memory of a robot with an owner and a network, and the owner's key."""
    keys = Keys()
    robot, _ = join_network(keys)
    robot.wait(2000)
    return robot.read_kept(), keys.stored_keys[0]


class Guest(NamedTuple):
    end: End | None  # None: the cable
    client: Client
    kind: str
    place: int


class Scene:
    """A robot, and all connected clients."""

    def __init__(self, kept_memory: Kept) -> None:
        self.robot = Esp32Robot(kept_memory=kept_memory)
        school_in_reach(self.robot)
        self.robot.wait(500)
        self.guests: list[Guest] = []
        self.places = [0]  # slots used so far
        self.nonce = 10

    def add_client(self, role: str) -> Client:
        self.nonce += 1
        keys = Keys()
        keys.stored_keys = [memory_with_network()[1]]
        if role == "owner":
            return remote(self.robot, keys, self.nonce)
        if role == "thief":
            return remote_with_wrong_key(self.robot, keys, self.nonce)
        return remote(self.robot, None, self.nonce) if role == "stranger" else RawClient()

    def connect_guest(self, place: int, role: str) -> Guest | None:
        """Connect a guest over a radio or the cable, unless the slot is taken."""
        if place != NETWORK and any(guest.place == place for guest in self.guests):
            return None
        make = TRANSPORT_MAKERS[place]
        guest = Guest(make and make(self.robot), self.add_client(role), role, place)
        self.guests.append(guest)
        self.places.append(place)
        self.talk(3)
        return guest

    def talk(self, milliseconds: int, flags: int = 0) -> None:
        talk(self.robot, [(end, session) for end, session, *_ in self.guests], milliseconds, flags)

    def leave(self, guest: Guest) -> None:
        self.guests.remove(guest)
        if guest.end is not None:
            guest.end.leave()
        self.talk(3)


HONEST_GUESTS = ("owner", "owner", "stranger", "person")
GUESTS = (*HONEST_GUESTS, "thief")


def do_random_step(scene: Scene, rng: random.Random, is_soon: bool) -> None:
    """Somebody comes, goes, asks or types.

    If the twin arrives soon, no step asks for anything that continues without a client, nor uses
    the cable, where nobody notices that a client has left.
    """
    kind = rng.randrange(8)
    if kind == 0 or not scene.guests:
        scene.connect_guest(rng.randrange(is_soon, 4), rng.choice(GUESTS))
        return
    guest = rng.choice(scene.guests)
    if kind == 1:
        scene.leave(guest)
    elif kind == 2:
        scene.talk(rng.choice((30, 300, 1200)))
    elif kind == 3 and rng.random() < 0.3:
        scene.talk(1, rng.choice((1, 2)))
        scene.talk(60)
    elif isinstance(guest.client, RawClient):
        guest.client.to_send = rng.choice(
            (rng.choice(LINES), rng.choice(PIECES), bytes(STOP_BYTES))
        )
        scene.talk(rng.choice((2, 30, 300)))
    elif isinstance(guest.client, Session):
        excluded = {"identify"} if is_soon else set()
        excluded |= {"a claim"} if guest.kind == "stranger" else set()
        REQUEST_MAKERS[rng.choice([ask for ask in REQUEST_MAKERS if ask not in excluded])](
            guest.client
        )
        scene.talk(rng.choice((1, 5, 30, 300)))


def observe(scene: Scene, first: int, rng: random.Random) -> list[object]:
    """Connect one or two guests; return everything that can be observed."""
    robot = scene.robot
    states: list[object] = [radios(robot).sockets]
    robot.did.clear()
    scene.nonce = 100
    guests: list[Guest] = []
    for place in {first: 0, rng.randrange(4): 0}:
        guest = scene.connect_guest(place, rng.choice(HONEST_GUESTS))
        assert guest
        guests.append(guest)
    for _ in range(rng.choice((2, 4))):
        began_ms, session = robot.now_ms, rng.choice(guests).client
        name, request = "", None
        if isinstance(session, Session):
            name = rng.choice([question for question in REQUEST_MAKERS if question != "a claim"])
            request = REQUEST_MAKERS[name](session)
        elif isinstance(session, RawClient):
            session.to_send = rng.choice(LINES)
        scene.talk(rng.choice((100, 400, 1500)))
        states.append((name, answer_without_counts(request, *MEMORY_FIELDS)))
        for _, client, *_ in guests:
            if isinstance(client, Session):
                states.append([without_counts(event) for event in client.events()])
        rows = (line.split(" ", 1) for line in robot.did)
        states.append([(int(ms) - began_ms, action) for ms, action in rows])
        robot.did.clear()
    scene.talk(1200)  # a text answer waits after a frame that did not report the stop
    texts = [client.received for _, client, *_ in guests if isinstance(client, RawClient)]
    return [*states, [sorted(re.findall(rb"// [^\r\n]*\r\n", data)) for data in texts]]


def check(seed: int) -> str:
    rng = random.Random(seed)
    scene = Scene(memory_with_network()[0])
    wait_ms = rng.choice((3, 30, 300, LONGEST_WAIT_MS))
    for _ in range(rng.choice((2, 4, 8, 16))):
        do_random_step(scene, rng, wait_ms < LONGEST_WAIT_MS)
    actions = scene.robot.did[:]
    scene.talk(1, 2)
    while scene.guests:
        scene.leave(scene.guests[0])
    scenes = [scene, Scene(scene.robot.read_kept())]
    drawn_alike, place = rng.random(), rng.choice(scene.places)
    states_of_both = []
    for one_scene in scenes:
        one_scene.robot.wait(5, bytes(STOP_BYTES))
        one_scene.robot.wait(wait_ms)
        states_of_both.append(observe(one_scene, place, random.Random(drawn_alike)))
    assert states_of_both[0] == states_of_both[1], (
        f"{actions}\n{wait_ms}\n{first_difference(*states_of_both)}"
    )
    return "at once" if wait_ms < LONGEST_WAIT_MS else "later"


@pytest.mark.sampled("part")
@pytest.mark.parametrize("part", range(20))
def test_a_robot_behaves_like_its_twin_with_another_history(part: int) -> None:
    for seed in range(part * 5, part * 5 + 5):
        check(seed)


if __name__ == "__main__":
    each_seed(check, make_options(200, 10_000))
