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
from tiniscript.doctor.findings import Finding, sure_finding
from tiniscript.link.messages import MAX_BALANCE, MAX_LEAST
from tiniscript.link.requests import ACCEPTING_STATUSES
from tiniscript.link.trim import MAX_PACE, Pace, Trim

MEASURED_POWERS = 40, 80  # percent: it is seen and measured at both
DRIVE_S, TURN_S = 2, 1  # how long to measure
INCH_CM = 2.54
NUMBER_PATTERN = r"([0-9]{1,4}(?:[.,][0-9]{1,3})?)"
INCH_WORDS = ("in", "inch", "inches", "pulg", "pulgada", "pulgadas", '"')
DEGREE_SIGNS = ("°", "º")
MIN_STEP = 5  # percent
FIRST_STEP = 16  # percent of balance; halved each time that the drift changes side
ANSWER_REPEAT = 4
# failures after a stop by another command
STOPPED_KEYS = ("stopped_elsewhere", "stopped_midway", "plain")
MAX_TRIES = 4


def guide(connection: Connection, old_trim: Trim) -> Trim:
    """Ask until the robot drives straight; return the new trim."""
    try:
        return TrimWizard(connection).ask_trim(old_trim)
    except BaseException as error:
        if isinstance(error, KeyboardInterrupt):
            print(file=sys.stderr)
            connection.stop()
        if not isinstance(error, CommandError) or _is_reachable(error):
            _restore_trim(connection, old_trim)
        if isinstance(error, NoPerson):
            raise CommandError(3, "trim_no_answer") from None
        raise


def _is_reachable(error: CommandError) -> bool:
    """Return whether the robot can still be reached."""
    return error.key in STOPPED_KEYS or error.key.startswith("trim_")


def _restore_trim(connection: Connection, old_trim: Trim) -> None:
    """Restore the robot's former trim, with retries: a stop may still be in progress."""
    for _ in range(MAX_TRIES - 1):
        try:
            connection.request(lambda session: session.trim(old_trim.data()), ACCEPTING_STATUSES)
        except CommandError as error:
            if not _is_reachable(error):
                raise
        else:
            return
    connection.request(lambda session: session.trim(old_trim.data()), ACCEPTING_STATUSES)


class TrimWizard(Conversation):
    def ask_trim(self, old_trim: Trim) -> Trim:
        self.ask_to_lift()
        self._set_trim(Trim())
        trim = self._find_wiring()
        self._set_trim(trim)
        trim = trim._replace(least=self._find_least_power())
        self._set_trim(trim)
        self.ask("trim_floor")
        slow_balance = self._balance_wheels(trim, MEASURED_POWERS[0])
        quick_balance = self._balance_wheels(
            trim._replace(balance=slow_balance), MEASURED_POWERS[1]
        )
        trim = trim._replace(balance=round((slow_balance + quick_balance) / 2))
        self._set_trim(trim)
        if old_trim.pace is None:
            say_aside("trim_no_pace_here", self.language)
            return trim
        if self.ask_choice("trim_measure", 2) != ANSWER_YES:
            return trim._replace(pace=old_trim.pace)
        forward_pace = self._measure("F", DRIVE_S, "trim_how_far")
        turn_pace = self._measure("R", TURN_S, "trim_how_round")
        return trim._replace(pace=Pace(*forward_pace, *turn_pace))

    def run_line(self, line: str) -> list[int]:
        try:
            return super().run_line(line)
        except CommandError as error:
            if error.key != "plain":
                raise
            print(error.sentence(self.language), file=sys.stderr)
            raise CommandError(3, "trim_ended") from None

    def _find_wiring(self) -> Trim:
        """Turn each motor; return the trim with which they are those of their wheels."""
        wheel_turns = []
        for side in ("left", "right"):
            wheel_turns.append(self.turn_motor(side))
            if not wheel_turns[-1].wheel:
                raise self._error_for(sure_finding("still")._replace(part_name=side))
        trim = trim_from_answers(Trim(), *wheel_turns)
        if trim is None:
            raise self._error_for(sure_finding("same_wheel"))
        return trim

    def _find_least_power(self) -> int:
        """Return the smallest power that moves both wheels, or 0 if the smallest step does."""
        for power in range(MIN_STEP, MAX_LEAST + 1, MIN_STEP):
            self.run_line(f"M({power}, {power}); W(1); M(0, 0)")
            if self.ask_choice("trim_moves", 2, n=str(power)) == ANSWER_YES:
                return power if power > MIN_STEP else 0
        raise self._error_for(sure_finding("too_weak", n=str(MAX_LEAST)))

    def _measure(self, move: str, seconds: int, question: str) -> list[float]:
        """Return the distance or angle per second at each power."""
        while True:
            paces = [
                self._measure_move(move, power, seconds, question) / seconds
                for power in MEASURED_POWERS
            ]
            if paces[0] < paces[1]:
                return paces
            say_aside("trim_not_faster_again", self.language)

    def _measure_move(self, move: str, power: int, seconds: int, question: str) -> float:
        """Return the distance in cm or the angle in degrees that the person measured."""
        self.ask("trim_mark")
        while True:
            self.run_line(f"{move}({seconds}, {power})")
            answer = self.ask(question, n=str(power))
            while answer:
                measure = parse_measure(answer, move == "R")
                if measure is not None and measure <= MAX_PACE * seconds:
                    return measure
                say_aside(f"{question}_number", self.language)
                answer = self.ask(question, n=str(power))

    def _balance_wheels(self, trim: Trim, power: int) -> int:
        """Balance the wheels until the robot goes straight; return the balance."""
        step, last_side = FIRST_STEP, 0
        self._set_trim(trim)
        while True:
            self.run_line(f"F(2, {power})")
            answer = self.ask_choice("trim_straight", ANSWER_REPEAT)
            if answer == 1:
                return trim.balance
            if answer == ANSWER_REPEAT:
                continue
            # it drifts to its left, so the right wheel is too strong
            side = -1 if answer == 2 else 1
            if last_side and side != last_side:
                step = max(1, step // 2)
            last_side = side
            balance = trim.balance + side * step
            if abs(balance) > MAX_BALANCE:
                raise self._error_for(sure_finding("too_uneven", n=str(MAX_BALANCE)))
            trim = trim._replace(balance=balance)
            self._set_trim(trim)

    def _error_for(self, finding: Finding) -> CommandError:
        sentences = sentences_of(finding, self.language)
        part = label(finding, self.language)
        return CommandError(
            3, "trim_found", part=part, found=sentences.finding, then=sentences.advice
        )

    def _set_trim(self, trim: Trim) -> None:
        self.connection.request(
            lambda session: session.trim(trim.data()), ACCEPTING_STATUSES
        )  # kept at the end


def parse_measure(answer: str, is_turn: bool) -> float | None:
    """Return the centimetres or degrees that a person wrote, with a comma or a point; else None."""
    match = re.fullmatch(NUMBER_PATTERN + r" *(\S*?)\.?", answer.strip().lower())
    if match is None:
        return None
    number, unit = float(match[1].replace(",", ".")), match[2]
    if is_turn:
        return number if unit in ("", *DEGREE_SIGNS) else None
    if unit in INCH_WORDS:
        return number * INCH_CM
    return number if unit in ("", "cm") else None
