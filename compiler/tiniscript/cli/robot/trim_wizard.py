"""The conversation's part about trim, with which `tsc set trim` begins: until it drives straight.

If it ends early, the robot keeps its former trim.
"""

from __future__ import annotations

import re
import sys

from tiniscript.cli.errors import CommandError
from tiniscript.cli.robot.connect import Connection
from tiniscript.cli.robot.conversation import ANSWER_YES, Conversation, NoPerson, trim_from_answers
from tiniscript.cli.texts import say_aside
from tiniscript.cli.texts.causes import label, sentences_of
from tiniscript.doctor.findings import Finding, sure
from tiniscript.link.messages import MOST_BALANCE, MOST_LEAST
from tiniscript.link.requests import ACCEPTING_STATUSES
from tiniscript.link.trim import MOST_PACE, Pace, Trim

MEASURED_POWERS = 40, 80  # percent: it is seen and measured at both
DRIVE_S, TURN_S = 2, 1  # how long it is measured
INCH_CM = 2.54
NUMBER = r"([0-9]{1,4}(?:[.,][0-9]{1,3})?)"
INCH_WORDS = ("in", "inch", "inches", "pulg", "pulgada", "pulgadas", '"')
DEGREE_SIGNS = ("°", "º")
LEAST_STEP = 5  # percent
FIRST_STEP = 16  # percent of balance; halved each time that the drift changes side
AGAIN = 4
# failures after a stop by another command
STOPPED_KEYS = ("stopped_elsewhere", "stopped_midway", "plain")
MOST_TRIES = 4


def guide(connection: Connection, before: Trim) -> Trim:
    """Ask until the robot drives straight; return the new trim."""
    try:
        return TrimWizard(connection).trim(before)
    except BaseException as why:
        if isinstance(why, KeyboardInterrupt):
            print(file=sys.stderr)
            connection.stop()
        if not isinstance(why, CommandError) or _is_there(why):
            _give_back(connection, before)
        if isinstance(why, NoPerson):
            raise CommandError(3, "trim_no_answer") from None
        raise


def _is_there(failure: CommandError) -> bool:
    """Whether the robot can still be reached."""
    return failure.key in STOPPED_KEYS or failure.key.startswith("trim_")


def _give_back(connection: Connection, before: Trim) -> None:
    """Restore the robot's former trim, with retries: a stop may still be in progress."""
    for _ in range(MOST_TRIES - 1):
        try:
            connection.request(lambda session: session.trim(before.data()), ACCEPTING_STATUSES)
        except CommandError as failure:
            if not _is_there(failure):
                raise
        else:
            return
    connection.request(lambda session: session.trim(before.data()), ACCEPTING_STATUSES)


class TrimWizard(Conversation):
    def trim(self, before: Trim) -> Trim:
        self.lift()
        self._set(Trim())
        trim = self._find_wiring()
        self._set(trim)
        trim = trim._replace(least=self._least())
        self._set(trim)
        self.answer("trim_floor")
        slow = self._balance_wheels(trim, MEASURED_POWERS[0])
        quick = self._balance_wheels(trim._replace(balance=slow), MEASURED_POWERS[1])
        trim = trim._replace(balance=round((slow + quick) / 2))
        self._set(trim)
        if before.pace is None:
            say_aside("trim_no_pace_here", self.language)
            return trim
        if self.choice("trim_measure", 2) != ANSWER_YES:
            return trim._replace(pace=before.pace)
        forward_pace = self._measure("F", DRIVE_S, "trim_how_far")
        turning = self._measure("R", TURN_S, "trim_how_round")
        return trim._replace(pace=Pace(*forward_pace, *turning))

    def run_line(self, line: str) -> list[int]:
        try:
            return super().run_line(line)
        except CommandError as failure:
            if failure.key != "plain":
                raise
            print(failure.sentence(self.language), file=sys.stderr)
            raise CommandError(3, "trim_ended") from None

    def _find_wiring(self) -> Trim:
        """Turn each motor; return the trim with which they are those of their wheels."""
        wheel_turns = []
        for side in ("left", "right"):
            wheel_turns.append(self.turn_motor(side))
            if not wheel_turns[-1].wheel:
                raise self._failure(sure("still")._replace(part_name=side))
        trim = trim_from_answers(Trim(), *wheel_turns)
        if trim is None:
            raise self._failure(sure("same_wheel"))
        return trim

    def _least(self) -> int:
        """Return the smallest power that moves both wheels, or 0 if the smallest step does."""
        for power in range(LEAST_STEP, MOST_LEAST + 1, LEAST_STEP):
            self.run_line(f"M({power}, {power}); W(1); M(0, 0)")
            if self.choice("trim_moves", 2, n=str(power)) == ANSWER_YES:
                return power if power > LEAST_STEP else 0
        raise self._failure(sure("too_weak", n=str(MOST_LEAST)))

    def _measure(self, move: str, seconds: int, question: str) -> list[float]:
        """Return how much it went, or turned, in a second at each power."""
        while True:
            result = [
                self._measure_move(move, power, seconds, question) / seconds
                for power in MEASURED_POWERS
            ]
            if result[0] < result[1]:
                return result
            say_aside("trim_not_faster_again", self.language)

    def _measure_move(self, move: str, power: int, seconds: int, question: str) -> float:
        """Return how far it went in centimetres, or turned in degrees, as the person measured."""
        self.answer("trim_mark")
        while True:
            self.run_line(f"{move}({seconds}, {power})")
            answer = self.answer(question, n=str(power))
            while answer:
                size = parse_measure(answer, move == "R")
                if size is not None and size <= MOST_PACE * seconds:
                    return size
                say_aside(f"{question}_number", self.language)
                answer = self.answer(question, n=str(power))

    def _balance_wheels(self, trim: Trim, power: int) -> int:
        """Balance the wheels until the robot goes straight; return the balance."""
        step, last = FIRST_STEP, 0
        self._set(trim)
        while True:
            self.run_line(f"F(2, {power})")
            answer = self.choice("trim_straight", AGAIN)
            if answer == 1:
                return trim.balance
            if answer == AGAIN:
                continue
            # to its left: the right wheel is too strong
            side = -1 if answer == 2 else 1
            if last and side != last:
                step = max(1, step // 2)
            last = side
            balance = trim.balance + side * step
            if abs(balance) > MOST_BALANCE:
                raise self._failure(sure("too_uneven", n=str(MOST_BALANCE)))
            trim = trim._replace(balance=balance)
            self._set(trim)

    def _failure(self, finding: Finding) -> CommandError:
        result = sentences_of(finding, self.language)
        part = label(finding, self.language)
        return CommandError(3, "trim_found", part=part, found=result.finding, then=result.advice)

    def _set(self, trim: Trim) -> None:
        self.connection.request(
            lambda session: session.trim(trim.data()), ACCEPTING_STATUSES
        )  # kept at the end


def parse_measure(answer: str, is_turn: bool) -> float | None:
    """Return the centimetres or degrees that a person wrote, with a comma or a point; else None."""
    match = re.fullmatch(NUMBER + r" *(\S*?)\.?", answer.strip().lower())
    if match is None:
        return None
    number, unit = float(match[1].replace(",", ".")), match[2]
    if is_turn:
        return number if unit in ("", *DEGREE_SIGNS) else None
    if unit in INCH_WORDS:
        return number * INCH_CM
    return number if unit in ("", "cm") else None
