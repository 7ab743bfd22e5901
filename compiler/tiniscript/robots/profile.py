"""The types of a robot profile, and the exception for one that cannot be used.

Knows no TOML (`reader`), no chips (`boards`) and no sentences (`refusals`).
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar, NamedTuple

from tiniscript.base.kit import Kit
from tiniscript.base.languages import translated_languages

Reason = tuple[str, Mapping[str, str]]


class ProfileRefused(Exception):
    """A profile that cannot be used.

    `reasons` holds every complaint as (code, values): the code is a short, stable name, and the
    values fill the gaps of its sentence in `refusals`. The value `path` is the path of the key,
    such as `kit.sensors[2].range`; tables are counted from 1. `kinds` are those whose sentences
    take precedence over that of a profile: other files have their own.
    """

    kinds: ClassVar[tuple[str, ...]] = ()

    def __init__(self, *reasons: Reason) -> None:
        super().__init__(", ".join(code for code, _ in reasons))
        self.reasons: tuple[Reason, ...] = reasons


def answer_languages() -> list[str]:
    """Return the languages in which a robot answers to text, English first."""
    return translated_languages("robot", "remark/STOPPED")


def language_number(language: str) -> int:
    """Return the firmware's number of a language: the letters of its code; 0 for English."""
    code = int.from_bytes(language[:2].encode(), "big")
    return code if language in answer_languages()[1:] else 0


class Wiring(NamedTuple):
    """The connection of a device: a driver of `drivers`, its pins and its settings.

    Pins are the numbers of the chip's Arduino core (A0 of an Uno is 14); pins that the profile
    omits are missing. All settings are present: yes/no as 0 and 1, `zero` and `full` as
    thousandths, the others as whole numbers.
    """

    driver: str
    pins: Mapping[str, int]
    settings: Mapping[str, int]


class Board(NamedTuple):
    """The board as the firmware needs it. Sensors and actuators are in the kit's order.

    `program_bytes` is the largest size of a program's code. `max_run_seconds` limits how long a
    program runs without a client. A pin that is None is not wired. `language`, is that of its
    answers to text; empty: that of the person who builds its firmware.
    `discs` are those on the wheels, None if it measures no distances.
    """

    chip: str
    program_bytes: int
    baud: int
    max_run_seconds: int
    motors: Wiring
    sensors: tuple[Wiring, ...]
    actuators: tuple[Wiring, ...]
    start_button: int
    buzzer: int | None = None
    status_led: int | None = None
    bluetooth_state: int | None = None
    language: str = ""
    discs: Wiring | None = None


class Place(NamedTuple):
    """The place of a sensor, from the middle between the wheels, and its object.

    `x_cm` goes forward and `y_cm` to the left; `heading` is in degrees, 0 ahead and 90 to the
    left. `sees` is one of SEES. `turns_with` names the actuator that carries it, a servo: its value
    is in degrees, and `heading` is where the sensor looks in the middle of its range.
    """

    x_cm: float
    y_cm: float
    heading: float
    sees: str
    turns_with: str = ""


SEEN_KINDS = ("light", "distance", "line", "white", "touch")  # a line is black


class Body(NamedTuple):
    """The body as a simulator needs it, with `speed_cm_s` and `turn_s` degrees at 100 %.

    They are the kit's `speed` and `turn`, where it says them. `wheel_base_cm` is where the wheels
    are, which turn it less than their places say: they slip.

    A sensor that is not in `places` detects nothing in a simulated world.
    """

    wheel_base_cm: float
    speed_cm_s: float
    turn_s: float
    length_cm: float
    width_cm: float
    places: Mapping[str, Place]


class Robot(NamedTuple):
    """A profile. `labels[language]` names `robot` and every device."""

    name: str
    kit: Kit
    board: Board
    body: Body
    labels: Mapping[str, Mapping[str, str]]

    def with_language(self, language: str) -> Robot:
        """Return the robot with a language: this one, if its profile names none."""
        board = self.board._replace(language=self.board.language or language)
        return self._replace(board=board)
