"""Requests of a client reach the session unchanged; invalid ones are refused."""

from __future__ import annotations

import json
from typing import Any, NamedTuple
from unittest.mock import Mock

import pytest

from tiniscript.bytecode.image import Image
from tiniscript.link.connection import PendingRequest, Requester
from tiniscript.link.handshake import exchange_by_name
from tiniscript.link.messages import BY_NAME, Field, Message
from tiniscript.link.payloads import REPLIES, EmptyReply
from tiniscript.link.requests import Request
from tiniscript.link.sharing.protocol import BadMessage, message_of
from tiniscript.link.sharing.requests import ClientRequest, ClientRequests, request_maker
from tiniscript.link.wifi import BrokerSettings, Network, Tls

HOME_NETWORK = Network(b"Home", b"a password", False)
BROKER = BrokerSettings(bytes((10, 0, 0, 7)), 1883, "class", b"robot", b"secret")
NAMED_BROKER = BROKER._replace(name=b"broker.class", tls=Tls(bytes(range(256)) * 8, 20261121))
IMAGE = Image("SI", 3, b"\x44\xf0\x50", 0xFFFFFFFF, (2, 0), b"\1")


class MethodCall(NamedTuple):
    """A method of a client, with its arguments."""

    method: str
    arguments: tuple[Any, ...] = ()

    def message(self) -> dict[str, Any]:
        request: ClientRequest[Any] = getattr(ClientRequests(), self.method)(*self.arguments)
        return message_of(json.dumps(request.message).encode())


REQUESTS = (
    *(MethodCall(name) for name in ("hello", "ping", "status", "clear", "fetch", "undo", "identify",
                               "hold_back", "wifi", "forget_wifi", "broker")),
    MethodCall("claim", (0,)), MethodCall("claim", (1,)), MethodCall("disown", (1,)),
    MethodCall("allow_text", (True,)), MethodCall("name", (b"A",)),
    MethodCall("name", (b"A" * 16,)),
    MethodCall("trim", (b"",)), MethodCall("trim", (b"\1\2\3",)), MethodCall("start", (True,)),
    MethodCall("live", (b"\x44", 7, False)), MethodCall("live", (b"\x44", 7, True)),
    MethodCall("join", (HOME_NETWORK,)),
    MethodCall("press", (0x3F, -100, 100, 0)), MethodCall("press", (0, 0, 0, 0)),
    MethodCall("join", (Network(b"N" * 32, b"p" * 63, True),)),
    MethodCall("join", (Network(b"N", b"p" * 8, False),)),
    MethodCall("use_broker", (BROKER,)), MethodCall("use_broker", (None,)),
    MethodCall("use_broker", (NAMED_BROKER,)),
    MethodCall("use_broker", (BROKER._replace(name=b"x"),)),
    MethodCall("upload", (IMAGE, False, True, True, 7)),
    MethodCall("upload", (IMAGE._replace(isa=(2, 1), needs=255), True, True, False, 7)),
)  # fmt: skip


@pytest.mark.parametrize("request_case", REQUESTS, ids=str)
def test_a_request_reaches_the_session_like_the_client(request_case: MethodCall) -> None:
    session = Mock()
    request = request_maker(request_case.message(), 700)(session)
    ((name, passed_arguments, keyword_arguments),) = session.method_calls
    assert (name, passed_arguments, keyword_arguments) == (
        request_case.method,
        request_case.arguments,
        {},
    )
    assert request.limit_ms == 700


def of(method: str, *arguments: object, **changed_fields: object) -> dict[str, Any]:
    return {**MethodCall(method, arguments).message(), **changed_fields}


BAD_MESSAGES: tuple[dict[str, Any], ...] = (
    {"do": "poll"}, {"do": None}, {}, of("claim", 2), of("claim", -1), of("disown", 2),
    of("allow_text", 1), of("name", b""), of("name", b"A" * 17), of("name", b"A", name="g"),
    of("trim", b"\1"), of("trim", b"\1\2\3\4"), of("start", 1), of("live", b"\x44", kit="7"),
    of("live", b"\x44", kit=-1), of("live", b"\x44", kit=1 << 16), of("live", b"", 7, code=7),
    of("live", b"\x44", halts=1),
    of("join", Network(b"", b"a password", False)),
    of("join", Network(b"N" * 33, b"a password", False)),
    of("join", Network(b"N", b"p" * 7, False)), of("join", Network(b"N", b"p" * 64, False)),
    of("join", Network(b"N\0", b"a password", False)),
    of("join", Network(b"N", b"a pass\0word", False)),
    of("join", HOME_NETWORK, is_access_point=None),
    of("press", 0x40), of("press", -1), of("press", 1, 101), of("press", 0, 0, -101),
    of("press", 1, x="1"), of("press", 1, y=None),
    of("use_broker", BROKER, port=0), of("use_broker", BROKER, port=1 << 16),
    of("use_broker", BROKER, address=""), of("use_broker", BROKER, password="61" * 64),
    *(of("use_broker", NAMED_BROKER, **{key: value}) for key, value in (
        ("trust", ""), ("trust", "00" * 2049), ("trust", 1), ("date", 0), ("date", -1),
        ("date", True), ("date", 1 << 32), ("name", ""), ("name", "00"), ("name", "78" * 97),
        ("port", 0), ("address", "7f"), ("group", "a/b"),
    )),
    of("upload", IMAGE, start="XX"), of("upload", IMAGE, start="PING"),
    of("upload", IMAGE, isa="02"), of("upload", IMAGE, later_fields="1"),
    of("upload", IMAGE, devices=-1), of("upload", IMAGE, devices=1 << 16),
    of("upload", IMAGE, checksum=1 << 32), of("upload", IMAGE, code="00" * 0x8000),
    of("upload", IMAGE, later_fields="00" * 241), of("upload", IMAGE, runs=1),
    of("upload", IMAGE, kit=1 << 16), of("upload", IMAGE, kit=-1),
    of("upload", IMAGE, needs=1 << 8), of("upload", IMAGE, needs=-1),
)  # fmt: skip


@pytest.mark.parametrize("message", BAD_MESSAGES, ids=lambda message: str(message)[:60])
def test_invalid_requests_to_a_session_are_refused(message: dict[str, Any]) -> None:
    with pytest.raises(BadMessage):
        request_maker(message, 700)


def test_a_client_of_version_2_0_sends_no_needs() -> None:
    message = of("upload", IMAGE)
    del message["needs"]
    session = Mock()
    request_maker(message, 700)(session)
    assert session.upload.call_args.args[0] == IMAGE


def test_a_client_cannot_claim_to_be_another_that_presses_keys() -> None:
    session = Mock()
    request_maker(of("press", 1, 0, 0, 9), 700, 2)(session)
    assert session.press.call_args.args == (1, 0, 0, 2)


# -- a request that is no more than a message ------------------------------------------------------

NOD_MESSAGE = Message(
    99, "NOD", True,
    (Field("times", "u8", 1, 1), Field("turn", "i8", 1, 1), Field("which", "u32", 4, 4),
     Field("said", "rest", 1, 3)), (), "The robot nods.",
)  # fmt: skip


def nod(
    self: Requester, times: int, turn: int, place: int, data: bytes
) -> PendingRequest[EmptyReply]:
    return self._ask("nod", EmptyReply, times=times, turn=turn, which=place, said=data)


@pytest.fixture
def _knows_nod(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(BY_NAME, "NOD", NOD_MESSAGE)
    monkeypatch.setitem(REPLIES, "NOD", EmptyReply)
    monkeypatch.setattr(Requester, "nod", nod, raising=False)


@pytest.mark.usefixtures("_knows_nod")
@pytest.mark.parametrize("values", [(0, -128, 0, b"a"), (255, 127, (1 << 32) - 1, b"abc")])
def test_a_message_of_the_table_and_its_method_are_a_request(values: tuple[Any, ...]) -> None:
    """This works from this process and from a client of a shared port; no other file has to know
    it."""
    session = Mock()
    request_maker(MethodCall("nod", values).message(), 700)(session)
    ((name, passed_arguments, _),) = session.method_calls
    assert (name, passed_arguments) == ("nod", values)
    nod_fields = dict(zip((field.name for field in NOD_MESSAGE.request), values, strict=True))
    assert next(exchange_by_name("nod")(Mock(), **nod_fields)) == Request("NOD", nod_fields)


@pytest.mark.usefixtures("_knows_nod")
@pytest.mark.parametrize(
    "wrong_fields",
    [{"times": -1}, {"times": 256}, {"times": True}, {"turn": -129}, {"turn": 128}, {"turn": "1"},
     {"which": 1 << 32}, {"which": 0.5}, {"said": ""}, {"said": "61626364"}, {"said": None},
     {"do": "NOD"}, {"do": "stop"}, {"do": "data"}, {"do": "_ask"}],
)  # fmt: skip
def test_a_field_of_such_a_message_keeps_to_its_range(wrong_fields: dict[str, Any]) -> None:
    with pytest.raises(BadMessage):
        request_maker(of("nod", 1, 2, 3, b"a") | wrong_fields, 700)
