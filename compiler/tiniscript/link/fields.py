"""Converts replies and events to mappings of their fields and back, so they can be sent as text.

Knows no message: the types define the fields.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping
from functools import cache
from typing import Any, Protocol, TypeVar, cast, get_type_hints

from tiniscript.link.messages import Malformed
from tiniscript.link.outcomes import ALL_EVENTS, EndedEvent, Event
from tiniscript.link.payloads import StatusReply


class Payload(Protocol):
    """A NamedTuple of numbers and bytes."""

    def _asdict(self) -> dict[str, Any]: ...


T = TypeVar("T")


def of_payload(payload: Payload) -> dict[str, int | bytes]:
    return payload._asdict()


def of_event(event: Event) -> dict[str, int | bytes]:
    """Return the fields of an event, without its name."""
    if isinstance(event, EndedEvent):
        return event.status._asdict()
    fields = event._asdict()
    del fields["name"]
    return fields


def filled(kind: type[T], values: Mapping[str, int | bytes]) -> T:
    """Return a payload with these values. Raises Malformed if it has other fields."""
    if {name: type(value) for name, value in values.items()} != _types(cast(Hashable, kind)):
        raise Malformed
    make: Callable[..., T] = kind
    return make(**values)


def event_of(name: str, values: Mapping[str, int | bytes]) -> Event:
    """Return an event. Raises Malformed if no event has this name and these fields."""
    if name == "ENDED":
        return EndedEvent(filled(StatusReply, values))
    if name not in ALL_EVENTS:
        raise Malformed
    return filled(ALL_EVENTS[name], values)


@cache
def _types(kind: Hashable) -> dict[str, object]:
    """Return the type of each field, without an event's name."""
    return {name: each for name, each in get_type_hints(kind).items() if each in (int, bytes)}
