"""Data of the page before Python runs in it: robots with their words, worlds, and names.

`tools.builds.studio` writes it as JSON. Knows no program.
"""

from __future__ import annotations

from typing import Any

from tiniscript import robots
from tiniscript.base.fixed_point import ONE
from tiniscript.base.kit import REMOTE, REMOTE_SIGNS, Device
from tiniscript.base.languages import languages, text
from tiniscript.base.limits import PARAMETERS
from tiniscript.base.words import WORDS
from tiniscript.lessons import catalogue
from tiniscript.library import opening
from tiniscript.link.messages import MAX_BREAKPOINTS, NAME_BYTES, STOP_BYTES
from tiniscript.link.remote import REPEAT_MS
from tiniscript.robots.kinematics import Pose
from tiniscript.robots.profile import Robot
from tiniscript.studio import class_keeping
from tiniscript.studio.world_form import form_of, limits
from tiniscript.virtual import worlds
from tiniscript.virtual.driving import Hull
from tiniscript.virtual.score import MAX_STARS, Score


def description() -> dict[str, Any]:
    """Return everything as data for JSON."""
    return {
        "words": [
            {
                "text": word.text,
                "role": word.role.name,
                "example": word.example,
                "arguments": [
                    _range(argument.low, argument.high, argument.sample)
                    for argument in word.arguments
                ],
            }
            for word in WORDS.values()
            if word.role.is_offered
        ],
        "most_parameters": PARAMETERS,
        "remote": _remote(),
        "robots": [_robot(robots.load(name)) for name in robots.names()],
        "link": {
            "stop_bytes": STOP_BYTES,
            "cable_answer_ms": opening.CABLE_ANSWER_TIMEOUT_MS,
            "radio_answer_ms": opening.ANSWER_TIMEOUT_MS,
            "long_quiet_ms": round(opening.LONG_QUIET_S * 1000),
            "confirm_ms": round(opening.CONFIRM_TIMEOUT_S * 1000),
            "name_bytes": NAME_BYTES,
            "most_breakpoints": MAX_BREAKPOINTS,
            "keys_every_ms": REPEAT_MS,
        },
        "class": {
            "form": class_keeping.FORM_VERSION,
            "file_bytes": class_keeping.FILE_BYTES,
            "most_works": class_keeping.MAX_WORKS,
            "text_characters": class_keeping.TEXT_CHARACTERS,
            "most_lessons": class_keeping.MAX_LESSONS,
        },
        "worlds": [form_of(worlds.load(name)) for name in worlds.names()],
        "world_limits": limits(),
        "stars": _stars(),
    }


def _stars() -> dict[str, dict[str, int]]:
    """Return the most stars of each lesson, and of each world that has a task."""
    lessons = map(catalogue.load, catalogue.folders())
    task_worlds = [name for name in worlds.names() if Score(worlds.load(name)).state()]
    return {
        "lessons": {lesson.name: lesson.world_count for lesson in lessons},
        "worlds": dict.fromkeys(task_worlds, MAX_STARS),
    }


def _robot(profile: Robot) -> dict[str, Any]:
    kit = profile.kit
    return {
        "name": profile.name,
        "labels": {language: profile.labels[language]["robot"] for language in languages()},
        "baud": profile.board.baud,
        "speed_cm_s": profile.body.speed_cm_s,
        "wheel_base_cm": profile.body.wheel_base_cm,
        "quiet_ms": round(opening.QUIET_S_BY_BOARD.get(profile.board.chip, 0) * 1000),
        "outline": [[point.x, point.y] for point in Hull(profile.body).outline(Pose(0, 0, 0))],
        "places": {name: place._asdict() for name, place in profile.body.places.items()},
        "devices": [
            _device(
                device,
                role,
                {language: profile.labels[language][device.name] for language in languages()},
            )
            for role, devices in (("sensor", kit.sensors), ("actuator", kit.actuators))
            for device in devices
        ],
    }


def _device(device: Device, role: str, labels: dict[str, str]) -> dict[str, Any]:
    return {
        "text": device.name,
        "role": role,
        "example": _example(device.name, role, device.is_yes_no),
        "unit": device.unit,
        "is_yes_no": device.is_yes_no,
        "arguments": [_range(device.low, device.high, "0")],
        "labels": labels,
    }


def _remote() -> list[dict[str, Any]]:
    """Return the keys of a remote control, which all robots here share."""
    devices = []
    for device in REMOTE:
        key = "remote_key" if device.is_yes_no else "remote_pad"
        labels = {
            language: f"{text('studio', key, language)} {REMOTE_SIGNS[device.name]}"
            for language in languages()
        }
        devices.append(_device(device, "sensor", labels))
    return devices


def _range(low: int, high: int, sample: str) -> dict[str, Any]:
    """Return the range of plain numbers for a value, converted from thousandths to text."""
    return {"low": low / ONE, "high": high / ONE, "sample": sample}


def _example(name: str, role: str, is_yes_no: bool) -> str:
    if role == "sensor":
        return name
    return f"{name}(TRUE)" if is_yes_no else f"{name}(0)"
