"""Clients of a shared port wait for a holder that answers, however slowly, and give up a silent
one: on a fake clock.
"""

from __future__ import annotations

import random
import socket
from bisect import insort
from collections.abc import Callable
from contextlib import suppress
from typing import Any, cast, get_type_hints

import pytest

from tiniscript.link.connection import PendingRequest
from tiniscript.link.outcomes import POLL_INTERVAL_S, ConnectionLost, ShownEvent
from tiniscript.link.payloads import EmptyReply, HelloReply
from tiniscript.link.requests import OK
from tiniscript.link.sharing import protocol, shared_connection
from tiniscript.link.sharing.protocol import JsonMessage, MessageReader
from tiniscript.link.sharing.registry import Registration
from tiniscript.link.sharing.requests import ClientRequest
from tiniscript.link.sharing.shared_connection import DEAF_S, SharedConnection

LONG_S = 20 * DEAF_S
ANSWER_MESSAGE = {"id": 1, "status": OK, "detail": 0, "heard": 9, "came": "fe", "is_echoed": False,
                  "boot": 0, "values": {}}  # fmt: skip
SHOW_EVENT = {"event": "SHOW", "ms": 5, "values": protocol.event_fields(ShownEvent(5, 0))}


class Holder:
    """The socket to a holder of a port: each heartbeat is answered so much later.

    After `dies_s`, it is silent. Time passes while somebody waits for it.
    """

    def __init__(self, answer_s: Callable[[], float], dies_s: float = float("inf")) -> None:
        self.now_s, self.dies_s = 100.0, 100.0 + dies_s
        self.beats = 0
        self._answer_s = answer_s
        self.is_gone = False  # the process has ended
        self._limit_s = 0.0
        self._arrivals: list[tuple[float, bytes]] = []
        self._reader = MessageReader(protocol.LINE_BYTES)

    def clock(self) -> float:
        return self.now_s

    def say(self, message: JsonMessage, after_s: float) -> None:
        arrival_s = self.now_s + after_s
        if arrival_s < self.dies_s:
            insort(
                self._arrivals,
                (arrival_s, protocol.encode_message(message)),
                key=lambda item: item[0],
            )

    def settimeout(self, seconds: float) -> None:
        self._limit_s = seconds

    def sendall(self, data: bytes) -> None:
        if self.is_gone:
            raise BrokenPipeError
        for message in self._reader.read_messages(data):
            if message["do"] == "beat":
                self.beats += 1
                self.say({"beat": True}, self._answer_s())

    def recv(self, count: int) -> bytes:
        end_s = self.now_s + self._limit_s
        if not self._arrivals or self._arrivals[0][0] > end_s:
            self.now_s = end_s
            raise TimeoutError
        arrival_s, data = self._arrivals.pop(0)
        self.now_s = max(self.now_s, arrival_s)
        return data

    def close(self) -> None:
        """Do nothing, because there is no other end."""


def open_shared_connection(monkeypatch: pytest.MonkeyPatch, holder: Holder) -> SharedConnection:
    monkeypatch.setattr(shared_connection, "monotonic", holder.clock)
    registration = Registration("P", 1, "token", "answer", "upload", 9600, 1)
    peer = cast(socket.socket, holder)
    return SharedConnection(peer, registration, MessageReader(protocol.LINE_BYTES))


def listen_until_lost(line: SharedConnection, holder: Holder, seconds: float) -> float:
    """Listen for events until the end; return the time."""
    start_s = holder.now_s
    while holder.now_s - start_s < seconds:
        try:
            line.event(POLL_INTERVAL_S)
        except ConnectionLost as caught:
            assert caught.is_server
            break
    return holder.now_s - start_s


@pytest.mark.parametrize("seed", range(40))
def test_a_holder_that_answers_is_waited_for(monkeypatch: pytest.MonkeyPatch, seed: int) -> None:
    """At once, sometimes late, or always nearly too late; other messages count as well."""
    rng = random.Random(seed)
    longest_s = rng.choice((0.0, 1.0, DEAF_S - 3 * POLL_INTERVAL_S))
    holder = Holder(lambda: rng.choice((0.0, longest_s)))
    line = open_shared_connection(monkeypatch, holder)
    if seed % 2:
        for second_s in range(int(LONG_S)):
            holder.say(SHOW_EVENT, second_s + rng.random())
    assert listen_until_lost(line, holder, LONG_S) >= LONG_S and not line.has_ended
    assert holder.beats > LONG_S / (protocol.HEARTBEAT_S + POLL_INTERVAL_S) / 2


@pytest.mark.parametrize("seed", range(20))
def test_a_holder_that_falls_silent_is_given_up(monkeypatch: pytest.MonkeyPatch, seed: int) -> None:
    rng = random.Random(seed)
    dies_s = rng.choice((0.0, rng.uniform(0, LONG_S)))
    holder = Holder(lambda: rng.choice((0.0, 1.0)), dies_s)
    line = open_shared_connection(monkeypatch, holder)
    ended_s = listen_until_lost(line, holder, LONG_S * 2)
    assert line.has_ended
    assert (
        dies_s - 1.0 + DEAF_S - POLL_INTERVAL_S
        < ended_s
        < dies_s + DEAF_S + 1.0 + 3 * POLL_INTERVAL_S
    )
    with pytest.raises(ConnectionLost):
        line.event(0)


@pytest.mark.parametrize("takes_s", [DEAF_S * 3, LONG_S])
def test_a_slow_request_is_answered(monkeypatch: pytest.MonkeyPatch, takes_s: float) -> None:
    holder = Holder(lambda: 0.1)
    line = open_shared_connection(monkeypatch, holder)
    request: PendingRequest[EmptyReply] = line.begin(lambda session: session.name(b"Pia"))
    holder.say(ANSWER_MESSAGE, takes_s)
    assert line.wait(request).status == OK
    assert holder.now_s - 100.0 >= takes_s
    assert (line.heard_count, line.early_bytes) == (9, b"\xfe")


HELLO_VALUES: JsonMessage = {
    name: b"TINI".hex() if kind is bytes else 1 for name, kind in get_type_hints(HelloReply).items()
}


@pytest.mark.parametrize("seed", range(20))
def test_a_client_knows_its_holders_events_and_end(
    monkeypatch: pytest.MonkeyPatch, seed: int
) -> None:
    """Requests are answered in any order, each once; the end comes after the events before it."""
    rng = random.Random(seed)
    holder = Holder(lambda: 0.0)
    line = open_shared_connection(monkeypatch, holder)
    requests: list[tuple[int, PendingRequest[Any], str]] = []
    events: list[int] = []
    progress_values: list[int] = []
    number, name = 0, ""

    def listen(seconds: float) -> None:
        end_s = holder.now_s + seconds
        while holder.now_s < end_s:
            if (timed_event := line.event(POLL_INTERVAL_S)) is not None:
                events.append(timed_event[0])

    for k in range(60):
        action = rng.choice(("ask", "ask", "answer", "answer", "progress", "event"))
        if action == "ask":
            number += 1
            new_name = rng.choice(("", f"Pia{k}"))
            message = (
                ClientRequest("name", EmptyReply, name=new_name.encode().hex())
                if new_name
                else ClientRequest("hello", HelloReply)
            )
            request: PendingRequest[Any] = line.begin(lambda _: message)  # noqa: B023 - at once
            requests.append((number, request, new_name))
        elif action == "event":
            holder.say({**SHOW_EVENT, "ms": k}, 0)
            progress_values.append(k)
        elif requests and action == "progress":
            answered_id, request, _ = rng.choice(requests)
            holder.say({"id": answered_id, "done_bytes": k}, 0)
            listen(POLL_INTERVAL_S)
            assert request.done_bytes == k and request.outcome is None
        elif requests:
            answered_id, request, new_name = requests.pop(rng.randrange(len(requests)))
            state = {"heard": k, "came": f"{k:02x}", "is_echoed": k % 2 == 0, "boot": k // 2}
            status = rng.choice((OK, OK, 72))
            values = {} if new_name or status != OK else HELLO_VALUES
            holder.say(
                {"id": answered_id, "status": status, "detail": k, "values": values, **state}, 0
            )
            listen(POLL_INTERVAL_S)
            assert request.outcome and (request.outcome.status, request.outcome.detail) == (
                status,
                k,
            )
            assert (line.heard_count, line.early_bytes) == (k, bytes([k]))
            assert (line.is_echoed, line.boot) == (k % 2 == 0, k // 2)
            if status == OK and (name or not new_name):
                name = new_name or "TINI"
            assert (line.robot.name if line.robot else "") == name
    listen(1.0)
    assert events == progress_values
    holder.say({**SHOW_EVENT, "ms": 99}, 0)
    is_port_lost = seed % 2 == 0
    holder.say({"over": "gone" if is_port_lost else "ended", "why": "the cable"}, 0)
    with suppress(ConnectionLost):
        listen(POLL_INTERVAL_S)
    holder.is_gone = True
    assert events == [*progress_values, 99]
    for check in (
        lambda: line.event(0),
        lambda: line.wait(line.begin(lambda requests: requests.status())),
    ) * 2:
        with pytest.raises(ConnectionLost) as caught:
            check()
        assert (caught.value.detail, caught.value.is_server) == ("the cable", not is_port_lost)
