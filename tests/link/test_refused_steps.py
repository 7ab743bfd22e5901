"""After a step that a robot refuses, an exchange sends no other: half of it would count as all."""

from __future__ import annotations

from collections.abc import Callable
from random import Random
from typing import Any, get_type_hints

import pytest

from tests.support.session_frames import DESCRIPTION
from tests.support.unsent_requests import image
from tiniscript.bytecode.image import Image
from tiniscript.link import requests, wifi
from tiniscript.link.messages import RUN, STATUSES
from tiniscript.link.payloads import REPLIES, HelloReply
from tiniscript.link.requests import OK, DeviceInfo, Exchange, Reply, Request, device_info_of
from tiniscript.link.wifi import BrokerSettings, Network, Tls

VALUES: dict[Any, int | bytes] = {int: 9, bytes: b"abc"}  # values of replies, by their type


def device_info(kit: int) -> DeviceInfo:
    return device_info_of(HelloReply(**{**DESCRIPTION, "kit": kit}))  # type: ignore[arg-type]


def network(rng: Random) -> Network:
    return Network(rng.randbytes(rng.randint(1, 32)), rng.randbytes(63), rng.random() < 0.5)


def broker(rng: Random) -> BrokerSettings:
    tls = Tls(rng.randbytes(rng.randint(1, 900)), 20261121)
    user, password, name = (rng.randbytes(rng.randint(0, 60)) for _ in range(3))
    address = b"\1\2\3\4"
    return BrokerSettings(address, 8883, "a", user, password, name, rng.choice((tls, None)))


def upload(rng: Random) -> Exchange[Any]:
    program: Image = image(";".join(["F(1, 50)"] * rng.choice((1, 60))))
    robot = device_info(program.devices)
    return requests.upload(program, RUN, robot, robot.isa, rng.random() < 0.5, robot.kit)


EXCHANGES: dict[str, Callable[[Random], Exchange[Any]]] = {
    "join": lambda rng: wifi.join(network(rng)),
    "broker": lambda rng: wifi.use_broker(rng.choice((broker(rng), None))),
    "upload": upload,
    "start": lambda rng: requests.start(is_detached=False, is_latched=True),
    "live": lambda rng: requests.live(b"\1", True, 0, device_info(0), halts=False),
    "fetch": lambda rng: requests.fetch(),
}


def run(exchange: Exchange[Any], refused_step: int, status: int) -> tuple[list[Request], int]:
    """Return what is sent to a robot that refuses a step and all after it, and the outcome."""
    sent_requests: list[Request] = []
    reply: Reply[Any] | None = None
    while True:
        try:
            request = exchange.send(reply)  # type: ignore[arg-type]
        except StopIteration as outcome:
            return sent_requests, outcome.value.status
        sent_requests.append(request)
        reply_type: Callable[..., Any] = REPLIES[request.name]
        values = reply_type(*(VALUES[kind] for kind in get_type_hints(reply_type).values()))
        is_refused = len(sent_requests) > refused_step
        reply = Reply(status, 5) if is_refused else Reply(OK, 0, values)


@pytest.mark.parametrize("name", EXCHANGES)
def test_nothing_follows_a_refused_step(name: str) -> None:
    """It may be repeated, where the robot is busy or has not kept it yet."""
    for seed in range(25):
        rng = Random(seed)
        exchange = EXCHANGES[name]
        status = rng.choice([status for status in STATUSES.values() if status != OK])
        all_requests, _ = run(exchange(Random(seed)), 1000, status)
        step_index = rng.randrange(len(all_requests))
        sent_requests, outcome = run(exchange(Random(seed)), step_index, status)
        assert sent_requests[: step_index + 1] == all_requests[: step_index + 1]
        assert outcome != OK
        for request in sent_requests[step_index:]:
            assert request._replace(pause_ms=0) == all_requests[step_index]._replace(pause_ms=0)
