"""A program's readings of a remote control: its keys, and its stick in thousandths."""

from __future__ import annotations

from tiniscript.link.remote import NOTHING_PRESSED, RemoteState


def remote_readings(held_state: RemoteState) -> tuple[int, ...]:
    return (
        *(held_state.keys >> key & 1 for key in range(6)),
        held_state.x * 1000,
        held_state.y * 1000,
    )


RELEASED_READINGS = remote_readings(NOTHING_PRESSED)
