"""Refuses a program for another robot before any byte of it is sent."""

from __future__ import annotations

from typing import Any

from tiniscript.bytecode.image import REFUSALS, Image
from tiniscript.library.known_kits import lacks, may_run
from tiniscript.link.messages import STATUSES
from tiniscript.link.requests import DeviceInfo, Reply
from tiniscript.robots.profile import Robot


def refusal(image: Image, profile: Robot, robot: DeviceInfo) -> Reply[Any] | None:
    """Return why a robot may not run a program: another kit, or what it lacks. None: it may."""
    if lacks(image.needs, profile):
        return Reply(REFUSALS["UNKNOWN_NEEDS"][0])
    if may_run(image, profile, robot.kit):
        return None
    return Reply(STATUSES["WRONG_KIT"], robot.kit)
