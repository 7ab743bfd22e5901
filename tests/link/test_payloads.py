"""Replies and events have the fields of the table, and come through a shared port as they are."""

from __future__ import annotations

from typing import get_args

import pytest

from tests.support.link_events import EVENTS as SOME_EVENTS
from tiniscript.link.messages import FIRST_EVENT, MESSAGES, Field, Malformed, Message
from tiniscript.link.outcomes import (
    EVENTS,
    EchoEvent,
    Event,
    JoinedEvent,
    LeftEvent,
    MissedEvent,
    PlaceEvent,
    RestartedEvent,
    TextEvent,
)
from tiniscript.link.payloads import REPLIES, ReceiptReply, ShowEvent, StatusReply
from tiniscript.link.sharing import protocol
from tiniscript.link.sharing.protocol import event_fields, event_of, make_payload

REPLY_MESSAGES = [message for message in MESSAGES if message.number < FIRST_EVENT]
EVENT_MESSAGES = [message for message in MESSAGES if message.number >= FIRST_EVENT]


def value(field: Field) -> int | bytes:
    return b"\1" * field.least_bytes if field.kind == "rest" else 1


@pytest.mark.parametrize("message", REPLY_MESSAGES, ids=lambda value: str(value.name))
def test_a_reply_has_the_fields_of_the_table_in_their_order(message: Message) -> None:
    values = {field.name: value(field) for field in message.reply}
    reply = make_payload(REPLIES[message.name], values)
    assert list(reply._asdict().items()) == list(values.items())


def test_an_event_has_the_fields_of_the_table_and_its_name() -> None:
    """SHOW's place becomes the program and where it is, which a session knows."""
    for message in EVENT_MESSAGES:
        if message.name == "SHOW":
            assert ShowEvent._fields == (*(field.name for field in message.reply), "name")
            continue
        event = event_of(message.name, {field.name: value(field) for field in message.reply})
        assert isinstance(event, EVENTS[message.name]) and event.name == message.name
        assert list(event_fields(event)) == [field.name for field in message.reply]


OTHER_EVENTS: tuple[Event, ...] = (
    TextEvent(b"hello"), MissedEvent(3), EchoEvent(), JoinedEvent(b"live"), LeftEvent(b"live"),
    PlaceEvent(255, 2**32 - 1, -1), RestartedEvent(),
)  # fmt: skip


def test_every_event_comes_through_a_shared_port() -> None:
    """Its fields are written as JSON and read again."""
    events = (*SOME_EVENTS, *OTHER_EVENTS)
    assert {type(event) for event in events} == set(get_args(Event)) == {*EVENTS.values()}
    reader = protocol.MessageReader(protocol.LINE_BYTES)
    for event in events:
        values = protocol.to_json_values(event_fields(event))
        message = {"event": event.name, "ms": 5, "values": values}
        [read_message] = reader.read_messages(protocol.encode_message(message))
        assert protocol.read_event(read_message) == (5, event)


@pytest.mark.parametrize(
    "values",
    [
        {"program": 1, "run": 2, "slot": 0},
        {"program": 1, "run": 2, "slot": 0, "saved": 1, "more": 1},
        {"program": 1, "run": 2, "slot": 0, "saved": b"\1"},
        {"program": True, "run": 2, "slot": 0, "saved": 1},
    ],
)
def test_other_fields_are_refused(values: dict[str, int | bytes]) -> None:
    with pytest.raises(Malformed):
        make_payload(ReceiptReply, values)
    message: protocol.JsonMessage = {
        "status": 0,
        "detail": 0,
        "values": protocol.to_json_values(values),
    }
    with pytest.raises(protocol.BadMessage):
        protocol.read_reply(message, ReceiptReply)


@pytest.mark.parametrize("name", ["", "HELLO", "ENDED", "SHOW", "shown"])
def test_an_unknown_event_is_refused(name: str) -> None:
    with pytest.raises(protocol.BadMessage):
        protocol.read_event({"event": name, "ms": 1, "values": {"value": 1}})


def test_a_refusal_has_no_values() -> None:
    reply = protocol.read_reply({"status": 72, "detail": 7, "values": {}}, StatusReply)
    assert (reply.status, reply.detail) == (72, 7)
    with pytest.raises(AssertionError):
        _ = reply.values
