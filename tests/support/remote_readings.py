"""What a program reads of a remote control: its keys, and its stick in thousandths."""

from __future__ import annotations

from tiniscript.link.remote import NOTHING_PRESSED, RemoteState


def remote_readings(held: RemoteState) -> tuple[int, ...]:
    return (*(held.keys >> key & 1 for key in range(6)), held.x * 1000, held.y * 1000)


RELEASED = remote_readings(NOTHING_PRESSED)
