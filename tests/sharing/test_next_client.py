"""A later client of a shared port has the same actions and messages as the first one.

A command asks random things of a simulated robot and leaves, breaks off, falls silent or breaks the
protocol at any moment; then comes the next one. All visible effects, its answers, its events and
the robot's actions, are those without an earlier client. Port, robot and server take their turns on
the clock of the test.

`python -m tests.sharing.test_next_client 500` tries more.
"""

from __future__ import annotations

import random
import re
import socket
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from threading import Thread
from typing import Any, cast

import pytest

from tests.support.campaign import each_seed, make_options
from tests.support.images import TINIBOT, image_of
from tests.support.robot_on_host import computer, switched_on
from tiniscript.base.version import __version__
from tiniscript.link.connection import PendingRequest, Requester
from tiniscript.link.outcomes import (
    Event,
    JoinedEvent,
    LeftEvent,
    PlaceEvent,
    ShownEvent,
    TextEvent,
    TimedEvent,
)
from tiniscript.link.payloads import StoppedEvent
from tiniscript.link.port_connection import PortConnection
from tiniscript.link.sharing import protocol, registry
from tiniscript.link.sharing import server as server_of
from tiniscript.link.sharing.server import Server

STEP_MS = 20
MARK, MARK_ACTION = "BEEP(0.001, 31);", "BEEP 31 1"
# Messages about the robot, its runs and the clock, not about the client.
ROBOT_FIELD = re.compile(r'"(run|ms|boot|nonce|epoch|heard|noise|reset|fault\w*|state|program'
                         r'|length|slot|saved|answer|cause)": ?("[^"]*"|\d+)')  # fmt: skip
Json = dict[str, Any]


class SteppedLine:
    """The port of a simulated robot, without a thread."""

    address, holder_verb, end_reason = "", "", None
    heard_count, early_bytes, is_echoed, boot = 0, b"", False, 0

    def __init__(self) -> None:
        self.robot_itself, self.session = switched_on(), computer()
        self.posted_events: list[tuple[str, str]] = []  # the events of this process alone
        self.session.tells_starts = True

    @property
    def robot(self) -> object:
        return self.session.robot

    def listen(self, on_events: Callable[[list[TimedEvent]], None]) -> None:
        self._on_events = on_events

    def post_event(self, event: Event) -> None:
        """Post an event of this process alone: a command has come or left."""
        assert isinstance(event, (JoinedEvent, LeftEvent))
        self.posted_events.append((event.name, event.verb.decode()))

    def begin(
        self, make_request: Callable[[Requester], PendingRequest[Any]]
    ) -> PendingRequest[Any]:
        return make_request(self.session)

    def runs(self, run: int) -> bool:
        return self.session.is_running and self.session.run == run

    def stop(self) -> None:
        self.session.stop(self.robot_itself.now_ms)

    def end_run(self, run: int) -> None:
        self.session.end_run(run, self.robot_itself.now_ms)

    def withdraw(self, request: PendingRequest[Any]) -> None:
        self.session.withdraw(request)

    def fail(self, bug: Exception) -> None:
        raise bug

    def step(self) -> None:
        self.robot_itself.talk(self.session, STEP_MS)
        self._on_events([(self.robot_itself.now_ms, event) for event in self.session.events()])


class Client:
    """A command that sends what the test asks for."""

    def __init__(self, server: Server, verb: str) -> None:
        port = server.registration.number
        self.socket = socket.create_connection((protocol.HOST, port))
        self.socket.setblocking(False)
        self.reader = protocol.MessageReader(protocol.LINE_BYTES)
        self.messages: list[Json] = []
        self.beats, self.has_detached = True, False
        self._number = 0
        self.say({"tsc": __version__, "token": server.registration.token, "verb": verb})

    def say(self, message: Json) -> None:
        with suppress(OSError):
            self.socket.send(protocol.encode_message(message))

    def ask(self, action: str, **fields: object) -> None:
        self._number += 1
        self.say({"do": action, "id": self._number, "limit_ms": 6000, **fields})

    def look(self) -> None:
        with suppress(OSError, BlockingIOError):
            self.messages += cast(list[Json], self.reader.read_messages(self.socket.recv(1 << 20)))

    def count_answers(self) -> int:
        return sum("status" in message for message in self.messages)


class Desk:
    """A robot, the server of its port, and the commands at it, in simulated time."""

    def __init__(self) -> None:
        self.line = SteppedLine()
        line = cast(PortConnection, self.line)
        self.server = Server(line, "/dev/ttyUSB0", 9600, "link")
        self.clients: list[Client] = []

    def join(self, verb: str) -> Client:
        self.clients.append(Client(self.server, verb))
        return self.clients[-1]

    def step(self) -> None:
        for client in self.clients:
            if client.beats and self.line.robot_itself.now_ms % 200 < STEP_MS:
                client.say({"do": "beat"})
        for _ in range(3):  # requests that arrived, and their answers
            self.server._attend()
        self.line.step()
        self.server._attend()
        for client in self.clients:
            client.look()

    def step_for(self, milliseconds: int) -> None:
        for _ in range(milliseconds // STEP_MS):
            self.step()


@contextmanager
def desk(monkeypatch: pytest.MonkeyPatch) -> Iterator[Desk]:
    with monkeypatch.context() as patch:
        patch.setattr(Thread, "start", lambda self: None)
        patch.setattr(server_of, "PAUSE_S", 0)
        patch.setattr(server_of, "REST_S", 0)
        made_desk = Desk()
        robot = made_desk.line.robot_itself
        patch.setattr(server_of, "monotonic", lambda: robot.now_ms / 1000)
        try:
            yield made_desk
        finally:
            for client in made_desk.clients:
                client.socket.close()
            for name in made_desk.server._registrations:
                registry.remove(name)
            made_desk.server._close_all()


def upload(text: str, is_detached: bool = False) -> Json:
    image = image_of(text)
    image_fields = image._asdict() | {"isa": bytes(image.isa)}
    answer = {
        k: value.hex() if isinstance(value, bytes) else value for k, value in image_fields.items()
    }
    return {**answer, "runs": True, "saves": False, "is_detached": is_detached, "kit": 0}


def draw_program(rng: random.Random) -> str:
    moves = ";".join(rng.choice(("F(0.3, 60)", "W(0.2)", "SHOW(TIME > 3)", "M(20, 30)", "S",
                                 "B(2, 40) UNTIL(TIME > 0.5)"))
                     for _ in range(rng.randint(1, 5)))  # fmt: skip
    return f"SI|{MARK}{moves};{rng.choice(('', 'F(60, 50)', 'F(60, 50)', 'X = 0;SHOW(1 / X)'))}"


REQUEST_NAMES = ("upload", "upload", "live", "status", "trim", "identify")
STORED_PROGRAM_REQUESTS = ("start", "undo")  # these report the previous client to the next one


def send_request(rng: random.Random, client: Client, verb: str) -> None:
    text = draw_program(rng)
    if verb == "upload":
        is_detached = rng.random() < 0.2
        client.has_detached |= is_detached
        client.ask("upload", **upload(text, is_detached))
    elif verb == "live":
        seconds = rng.choice((0.4, 60))
        code = image_of(f"SI|{MARK}F({seconds}, 30)").code
        client.ask("live", code=code.hex(), kit=TINIBOT.fingerprint)
    else:
        fields_by_verb: dict[str, Json] = {"start": {"is_detached": False}, "trim": {"trim": ""}}
        client.ask(verb, **fields_by_verb.get(verb, {}))


def stop_and_leave(client: Client) -> None:
    client.say({"do": "stop"})
    client.socket.close()


def stop_heartbeats(rng: random.Random, client: Client) -> None:
    client.beats = False


END_ACTIONS: dict[str, Callable[[random.Random, Client], object]] = {
    "leaves": lambda rng, client: client.socket.close(),
    "is silent": stop_heartbeats,
    "breaks the protocol": lambda rng, client: client.socket.send(b'{"do":"nothing"}\n'),
    "breaks off": lambda rng, client: client.socket.send(b'{"do":"sta'),
    "stops and leaves": lambda rng, client: stop_and_leave(client),
}


def play_first_client(rng: random.Random, desk: Desk) -> str:
    client = desk.join(rng.choice(("upload", "run", "monitor", "python")))
    desk.step_for(rng.choice((20, 200)))
    for _ in range(rng.randint(1, 3)):
        send_request(rng, client, rng.choice((*REQUEST_NAMES, *STORED_PROGRAM_REQUESTS)))
        desk.step_for(rng.choice((0, 20, 40, 100, 400, 1500)))
    if rng.random() < 0.6:  # during its run, or while it is under way
        for _ in range(rng.choice((1, 1, 3))):
            send_request(rng, client, rng.choice(("upload", "live")))
        desk.step_for(rng.choice((0, 20, 40, 60, 400)))
    end_name = rng.choice([*END_ACTIONS])
    END_ACTIONS[end_name](rng, client)
    if end_name == "breaks off":
        desk.step_for(rng.choice((20, 300)))
        client.socket.close()
    robot = desk.line.robot_itself
    robot.codes()
    if rng.random() < 0.5:
        desk.step_for(rng.choice((60, 400, 900)))
        return end_name
    if end_name != "is silent":
        desk.step_for(400)
        assert client.has_detached or not desk.line.session.is_running, f"{end_name}: not at once"
        assert len(robot.codes()) <= 1, f"{end_name}: more begins than what was under way"
    desk.step_for(2500)
    if desk.line.session.is_running:
        assert client.has_detached, f"{end_name}: the run of a client that has gone goes on"
        other_client = desk.join("stop")
        other_client.say({"do": "stop"})
        desk.step_for(400)
        other_client.socket.close()
        desk.step_for(400)
    return end_name


def play_second_client(rng: random.Random, desk: Desk) -> tuple[list[str], list[str]]:
    """Return the second client's messages from its first run on, and the robot's actions."""
    robot = desk.line.robot_itself
    client = desk.join("run")
    desk.step_for(60)
    robot.did.clear()
    client.messages.clear()
    send_request(rng, client, "upload")
    desk.step_for(rng.choice((400, 1500, 3000)))
    for _ in range(2):
        send_request(rng, client, rng.choice(REQUEST_NAMES))
        desk.step_for(rng.choice((400, 1500)))
    client.say({"do": "stop"})
    desk.step_for(400)
    heard = [message for message in client.messages if "beat" not in message]
    begin_index = next((k for k, message in enumerate(heard) if "status" in message), 0)
    messages = [
        ROBOT_FIELD.sub(r'"\1"', protocol.encode_message(message).decode())
        for message in heard[begin_index:]
    ]
    # The mark of its program.
    actions = [line.split(" ", 1)[1] for line in robot.did if not line.endswith(" 200")]
    return messages, actions[actions.index(MARK_ACTION) :] if MARK_ACTION in actions else actions


def check(seed: int, monkeypatch: pytest.MonkeyPatch) -> str:
    with desk(monkeypatch) as at:
        end_name = play_first_client(random.Random(seed), at)
        heard_lines, actions = play_second_client(random.Random(-seed), at)
    with desk(monkeypatch) as at:
        expected_lines, action_lines = play_second_client(random.Random(-seed), at)
    explanation = (
        f"seed {seed} {end_name}\n{heard_lines}\n{actions}\nnot\n{expected_lines}\n{action_lines}"
    )
    assert actions == action_lines and heard_lines == expected_lines, explanation
    return end_name if len(action_lines) > 1 else "little"


@pytest.mark.sampled("part")
@pytest.mark.parametrize("part", range(20))
def test_the_next_client_is_treated_like_the_first(
    part: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    counts = Counter(check(seed, monkeypatch) for seed in range(part * 12, (part + 1) * 12))
    assert counts["little"] < 6, counts


@pytest.mark.parametrize("seed", range(6))
def test_a_run_ends_with_the_client_that_started_it(
    seed: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It does so by leaving or by its silence, and others do not. A stop ends it, and another run
    takes its place; a detached one ends with nobody. Each who comes and goes is told once."""
    rng = random.Random(seed)
    with desk(monkeypatch) as made_desk:
        owner: Client | str = ""
        verbs: dict[Client, str] = {}
        posted: list[tuple[str, str]] = []
        for _ in range(40):
            client = rng.choice([*verbs]) if verbs else None
            end_kind = rng.choice(
                (*["comes"] * 4, *["starts"] * 3, "asks", "stops", "leaves", "is silent")
            )
            if client is None or end_kind == "comes":
                verb = rng.choice(("upload", "live", "monitor", protocol.LOOKING_VERB))
                client = made_desk.join(verb)
                verbs[client] = verb
                posted += [("JOINED", verb)] * (verb != protocol.LOOKING_VERB)
            elif end_kind == "starts":
                is_detached = rng.random() < 0.2
                client.ask("upload", **upload("SI|F(60, 50)", is_detached))
                owner = "itself" if is_detached else client
            elif end_kind == "asks":
                client.ask("status")
            elif end_kind == "stops":
                client.say({"do": "stop"})
                owner = ""
            else:
                verb = verbs.pop(client)
                END_ACTIONS[end_kind](rng, client)
                posted += [("LEFT", verb)] * (
                    end_kind == "leaves" and verb != protocol.LOOKING_VERB
                )
                owner = "" if owner is client else owner
            made_desk.step_for(1600 if end_kind == "is silent" else 300)
            assert made_desk.line.session.is_running == (owner != ""), end_kind
            assert made_desk.line.posted_events == posted, end_kind


DROPPED_EVENTS: dict[str, Event] = {
    "SHOW": ShownEvent(5, 0, 1, 7, 3),
    "PLACE": PlaceEvent(1, 7, 3),
    "TEXT": TextEvent(b"a line of text"),
}


@pytest.mark.parametrize("name", [*DROPPED_EVENTS, "others"])
def test_a_client_that_reads_nothing_has_a_bounded_queue_or_is_dropped(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    event = DROPPED_EVENTS.get(name, StoppedEvent(1))
    max_bytes = 1000 + (
        server_of.FULL_BYTES if name in DROPPED_EVENTS else server_of.TOO_FULL_BYTES
    )
    with desk(monkeypatch) as made_desk:
        client = made_desk.join("monitor")
        made_desk.step_for(60)
        client.say({"do": "places"})
        made_desk.step_for(60)
        [served] = made_desk.server._clients
        served.peer.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, 4096)
        client.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        for _ in range(40):
            made_desk.server._on_events([(0, event)] * 1000)
            made_desk.server._attend()
            assert len(served.output) <= max_bytes
        assert (served in made_desk.server._clients) == (name in DROPPED_EVENTS)


if __name__ == "__main__":
    with pytest.MonkeyPatch.context() as patch:
        each_seed(lambda seed: check(seed, patch), make_options(500, 5_000))
