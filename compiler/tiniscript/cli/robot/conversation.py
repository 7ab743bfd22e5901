"""The conversation with a person at the robot, which acts while the person reports what they saw.

The self-test and the trim ask their questions here: each is asked, and said, in one way.
"""

from __future__ import annotations

import sys
from typing import NamedTuple

from tiniscript.cli.errors import CommandError
from tiniscript.cli.robot.connect import Connection
from tiniscript.cli.robot.event_printer import EventPrinter
from tiniscript.cli.robot.program_upload import follow_line
from tiniscript.cli.terminal import asking
from tiniscript.cli.texts import say_aside, text
from tiniscript.link.outcomes import Event
from tiniscript.link.trim import Trim

TURNING_POWER = 60  # percent, while the person looks at a motor
ANSWER_YES = 1
ANSWER_NOTHING, ANSWER_AGAIN = 5, 6  # answers of `turned`
MOTOR_LINES = {"left": f"M({TURNING_POWER}, 0)", "right": f"M(0, {TURNING_POWER})"}


class NoPerson(Exception):
    """Raised if no person answers."""


class WheelTurn(NamedTuple):
    """A person's answer about a motor: the wheel that turned, if any, and its direction."""

    wheel: str
    is_forward: bool


WHEEL_ANSWERS = (
    WheelTurn("left", True),
    WheelTurn("left", False),
    WheelTurn("right", True),
    WheelTurn("right", False),
)
NO_WHEEL_TURN = WheelTurn("", False)


class Conversation:
    """`is_asking`: a person is there. A person who does not answer once is not asked again."""

    def __init__(self, connection: Connection, is_asking: bool = True) -> None:
        self.connection = connection
        self.language = connection.language
        self.is_asking = is_asking

    def ask(self, key: str, **values: str) -> str:
        """Ask, and return the line that is typed. Raises NoPerson."""
        if not self.is_asking:
            raise NoPerson
        line = asking.ask(text(key, self.language).format(**values))
        if not line:
            self.is_asking = False
            print(file=sys.stderr)
            raise NoPerson
        return line.strip()

    def ask_choice(self, key: str, choice_count: int, **values: str) -> int:
        """Ask until the answer is a number from 1 to `choice_count`. Raises NoPerson."""
        while True:
            answer = self.ask(key, **values)
            if answer.isascii() and answer.isdigit() and 1 <= int(answer[:9]) <= choice_count:
                return int(answer)
            say_aside("ask_number", self.language, high=choice_count)

    def run_line(self, line: str) -> list[int]:
        """Execute a line on the robot now; return the values shown. Raises CommandError."""
        values: list[int] = []
        messages: list[str] = []

        def hold(event: Event) -> bool:
            if event.name == "SHOW":
                values.append(event.value)
            return event.name in ("SHOW", "DONE")

        printer = EventPrinter(
            self.language, print_line=messages.append, print_error=messages.append
        )
        if follow_line(self.connection, line, printer, hold):
            raise CommandError(3, "plain", said=" ".join(messages))
        return values

    def ask_what_was_seen(self, line: str, key: str, repeat_choice: int, **values: str) -> int:
        """Execute a line on the robot, and ask what was seen; `repeat_choice` executes it again."""
        choice = repeat_choice
        while choice == repeat_choice:
            if not self.is_asking:
                raise NoPerson
            self.run_line(line)
            choice = self.ask_choice(key, repeat_choice, **values)
        return choice

    def ask_to_lift(self) -> None:
        self.ask("ask_lift")

    def turn_motor(self, side: str) -> WheelTurn:
        """Turn the motor of a side; return what the person saw. Raises NoPerson, CommandError."""
        key = "ask_turned" if side == "left" else "ask_turned_other"
        answer = self.ask_what_was_seen(f"{MOTOR_LINES[side]}; W(1); M(0, 0)", key, ANSWER_AGAIN)
        return NO_WHEEL_TURN if answer == ANSWER_NOTHING else WHEEL_ANSWERS[answer - 1]


def trim_from_answers(old_trim: Trim, left: WheelTurn, right: WheelTurn) -> Trim | None:
    """Return the trim with which each wheel turns forward for its side.

    With `old_trim`, the motor of the left side turned wheel `one`, that of the right side wheel
    `other`. A value is None if both motors turned the same wheel, or one turned none.
    """
    if {left.wheel, right.wheel} != {"left", "right"}:
        return None
    was_reversed = (old_trim.is_left_reversed, old_trim.is_right_reversed)
    is_reversed_by_wheel = {
        turn.wheel: was_side_reversed != (not turn.is_forward)
        for turn, was_side_reversed in zip((left, right), was_reversed, strict=True)
    }
    return old_trim._replace(
        is_exchanged=old_trim.is_exchanged != (left.wheel == "right"),
        is_left_reversed=is_reversed_by_wheel["left"],
        is_right_reversed=is_reversed_by_wheel["right"],
    )
