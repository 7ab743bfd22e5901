"""Refuses a program for another robot before any byte of it is sent."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from tiniscript.base.kit import Kit
from tiniscript.bytecode.disassembly import rows
from tiniscript.bytecode.image import REFUSALS, Image
from tiniscript.library.known_kits import lacks, may_run
from tiniscript.link.messages import STATUSES
from tiniscript.link.remote import has_remote
from tiniscript.link.requests import DeviceInfo, Reply
from tiniscript.robots.profile import Robot


def refusal(image: Image, profile: Robot, device_info: DeviceInfo) -> Reply[Any] | None:
    """Return the reason why a robot may not run a program: another kit, or a missing feature; None
    if it may.
    """
    if lacks(image.needs, profile):
        return Reply(REFUSALS["UNKNOWN_NEEDS"][0])
    if lacks_remote(image.code, profile.kit, device_info):
        return Reply(STATUSES["NO_REMOTE"])
    if may_run(image, profile, device_info.kit):
        return None
    return Reply(STATUSES["WRONG_KIT"], device_info.kit)


def lacks_remote(code: bytes, kit: Kit, device_info: DeviceInfo) -> bool:
    """Return whether code for this kit reads a remote control, which the robot does not have."""
    return reads_remote(code, kit) and not has_remote(device_info)


def reads_remote(code: bytes, kit: Kit) -> bool:
    """Return whether code reads sensors after the kit's own: those of a remote control."""
    return any(sensor >= len(kit.sensors) for sensor in _sensors(code))


def _sensors(code: bytes) -> Iterator[int]:
    for row in rows(code):
        if row.op is None:
            continue
        for operand, value in zip(row.op.operands, row.operands, strict=True):
            if operand.kind.name == "sensor":
                yield value
        if row.op.implied is not None and row.op.implied.kind.name == "sensor":
            yield row.op.implied.value
