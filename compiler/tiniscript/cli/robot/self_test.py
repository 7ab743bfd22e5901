"""What a computer can check of a robot that should be ready for a lesson.

What the robot says of itself the doctor examines; here are its trim, and what it senses and does.
Nothing moves before a person has lifted the robot; without a person no motor turns. Changes nothing
that the robot keeps, except how its motors are wired, after a yes.
"""

from __future__ import annotations

from contextlib import suppress
from statistics import median

from tiniscript.base.kit import Device
from tiniscript.cli.errors import CommandError
from tiniscript.cli.robot.connect import Connection
from tiniscript.cli.robot.conversation import (
    ANSWER_YES,
    Conversation,
    NoPerson,
    WheelTurn,
    trim_from_answers,
)
from tiniscript.cli.robot.description import trim_in_words
from tiniscript.cli.robot.diagnosing import examination_of
from tiniscript.doctor.examination import Expectations, RobotAnswers
from tiniscript.doctor.findings import Finding, sure
from tiniscript.library.known_kits import robot_of_kit
from tiniscript.link.messages import RESETS, SAVED
from tiniscript.link.names import row_name
from tiniscript.link.trim import Trim, trim_from_reply
from tiniscript.robots.profile import Robot, Wiring

SELF_REPORTED_PARTS = (
    "kit",
    "firmware",
    "line",
    "supply",
    "store",
)  # of which a robot tells itself
SIDES = ("left", "right")
READING_COUNT = 3
SONAR = "hc_sr04"  # a driver: one that hangs is read as 0
NOTICEABLE_PARTS = 50  # a hand changes a reading by more than one part of so many of its range
STANDS = "W(2)"
BUZZER_HEARD, BUZZER_AGAIN = 1, 3  # answers about the buzzer
ANSWERED_FAILURES = (
    "plain",
    "selftest_silent",
)  # failures that the robot has told: it is still there


class SelfTest(Conversation):
    """The checks of a robot that has answered. `is_asking`: a person is beside it."""

    def __init__(self, connection: Connection, expected: Expectations, is_asking: bool) -> None:
        super().__init__(connection, is_asking)
        self.expected = expected
        self.found: list[Finding] = []
        self.heard: RobotAnswers | None = None
        self.trim = Trim()

    def run(self) -> list[Finding]:
        """Return what was found; an end of the link is the last of it."""
        try:
            self._check()
        except CommandError as failure:
            self._add("plain", said=failure.sentence(self.language))
        return self.found

    def _check(self) -> None:
        self._add("is_there")
        robot = self._examine()
        self.trim = trim_from_reply(self.connection.request(lambda session: session.trim()).values)
        self.found.append(self._trim_is())
        if robot is None:
            return
        self.connection.profile = robot
        if self.heard is not None and self.heard.status.noise:
            self._discs()
        is_lifted = self._is_lifted()
        for sensor, wiring in zip(robot.kit.sensors, robot.board.sensors, strict=True):
            self._sensor(sensor, wiring)
        self._motors(is_lifted)
        if robot.board.buzzer is not None:
            self._buzzer()

    def _add(self, cause: str, part: str = "", **values: str) -> None:
        self.found.append(Finding(cause, True, values, part))

    # -- what the robot says about itself

    def _examine(self) -> Robot | None:
        """Let the doctor examine it; return the robot that it is, where this computer knows it."""
        expected = self.connection.profile
        kit = self.connection.device_info.kit
        causes, self.heard = examination_of(self.connection, self.expected)
        expected_robot = expected if kit == expected.kit.fingerprint else robot_of_kit(kit)
        good = self._passed_parts(expected_robot.name if expected_robot is not None else "")
        for part in SELF_REPORTED_PARTS:
            self.found += [cause for cause in causes if cause.part == part] or good.get(part, [])
        return expected_robot

    def _passed_parts(self, name: str) -> dict[str, list[Finding]]:
        """Return what is said of each part of a robot of which nothing is wrong."""
        if self.heard is None:
            return {}
        hello, status, _, trips_ms = self.heard
        sizes = {size: str(getattr(hello, size)) for size in ("room", "largest", "window")}
        findings = [
            sure("kit_is", robot=name),
            sure("firmware_is", isa=f"{hello.isa_major}.{hello.isa_minor}", **sizes),
            sure("supply_is", reset=row_name(RESETS, hello.reset)),
            sure(_saved_cause(row_name(SAVED, status.saved))),
        ]
        if trips_ms:
            times = {"least": min(trips_ms), "ms": median(trips_ms), "most": max(trips_ms)}
            values = {value: f"{ms:.0f}" for value, ms in times.items()}
            findings.append(sure("line_is", n=str(len(trips_ms)), **values))
        return {finding.part: [finding] for finding in findings}

    def _discs(self) -> None:
        """Let it stand, and longer than wheels roll: an edge is none of a wheel."""
        before = self.connection.request(lambda session: session.status()).values.noise
        try:
            self.run_line(STANDS)
        except CommandError as failure:
            if failure.key not in ANSWERED_FAILURES:
                raise
            self._add("plain", "discs", said=failure.sentence(self.language))
            return
        after = self.connection.request(lambda session: session.status()).values.noise
        left, right = (
            str((count_now - count_before) % 256)
            for count_now, count_before in zip(after, before, strict=True)
        )
        if left == right == "0":
            self._add("discs_rest")
        else:
            self._add("discs_noise", left=left, right=right)

    # -- what it senses and does

    def _is_lifted(self) -> bool:
        with suppress(NoPerson):
            self.lift()
            return True
        return False

    def _sensor(self, sensor: Device, wiring: Wiring) -> None:
        name = sensor.name
        try:
            before = self._read(sensor)
            if wiring.driver == SONAR and not any(before):  # nothing is so near
                self._add("echo_hung", name=name)
                return
            values = _range(sensor, before)
            self.answer("ask_free", name=name, values=values)
            before = self._read(sensor)
            values = _range(sensor, before)
            self.answer("ask_hand", name=name)
            after = self._read(sensor)
        except CommandError as failure:
            if failure.key not in ANSWERED_FAILURES:
                raise
            self._add("no_reading", name=name, said=failure.sentence(self.language))
            return
        except NoPerson:
            is_stuck = not sensor.is_yes_no and {*before} <= {sensor.low, sensor.high}
            self._add("stuck" if is_stuck else "reads", name=name, values=values)
            return
        range_text = _range(sensor, after)
        least_change = 0 if sensor.is_yes_no else (sensor.high - sensor.low) // NOTICEABLE_PARTS
        if abs(sum(after) - sum(before)) > least_change * READING_COUNT:
            cause = "changes"
        else:  # a hand may be as bright as the floor
            cause = "as_bright" if sensor.is_yes_no else "same"
        self._add(cause, name=name, values=values, now=range_text)

    def _motors(self, is_lifted: bool) -> None:
        """Turn both. A robot with other wires may learn them, and turns both again."""
        before = self.found
        self.found = [*before]
        left, right = (self._motor(side, is_lifted) for side in SIDES)
        if left is None or right is None or not self._learns(left, right):
            return
        self.found = [
            self._trim_is() if finding.cause == "trim_is" else finding for finding in before
        ]
        for side in SIDES:
            self._motor(side, is_lifted)

    def _motor(self, side: str, is_lifted: bool) -> WheelTurn | None:
        """Return what a person saw of a motor, which is found; None where nobody did."""
        try:
            if not is_lifted:
                raise NoPerson
            turned = self.turn_motor(side)
        except NoPerson:
            self._add("unasked", side)
            return None
        except CommandError as failure:
            self._record_failure(side, failure)
            return None
        if not turned.wheel:
            self._add("still", side)
        else:
            self._add("turns" if turned == WheelTurn(side, True) else "other_turn", side)
        return turned

    def _learns(self, left: WheelTurn, right: WheelTurn) -> bool:
        """Have the robot keep how its motors are wired, if that is new and the person wants it."""
        trim = trim_from_answers(self.trim, left, right)
        if trim is None or trim == self.trim:
            return False
        with suppress(NoPerson):
            if self.choice("ask_learn", 2) == ANSWER_YES:
                self.connection.request(lambda session: session.trim(trim.data()))
                self.trim = trim
                return True
        return False

    def _trim_is(self) -> Finding:
        return sure("trim_is", trim=trim_in_words(self.trim, self.language))

    def _buzzer(self) -> None:
        try:
            answer = self.ask_what_was_seen("BEEP(0.5, 440)", "ask_buzzer", BUZZER_AGAIN)
        except NoPerson:
            self._add("unasked", "buzzer")
        except CommandError as failure:
            self._record_failure("buzzer", failure)
        else:
            self._add("heard" if answer == BUZZER_HEARD else "unheard")

    def _record_failure(self, part: str, failure: CommandError) -> None:
        self._add("ended", part, said=failure.sentence(self.language))
        if failure.key not in ANSWERED_FAILURES:
            raise failure

    def _read(self, sensor: Device) -> list[int]:
        """Return readings, in thousandths, or 0 and 1. Raises CommandError."""
        values = self.run_line("; W(0.1); ".join([f"SHOW({sensor.name})"] * READING_COUNT))
        if len(values) != READING_COUNT:
            raise CommandError(3, "selftest_silent")
        return values


def _saved_cause(saved: str) -> str:
    """Return the cause of what the robot says of its program."""
    return {"STORED": "saved", "NOTHING": "empty"}.get(saved, "unsaved")


def _range(sensor: Device, values: list[int]) -> str:
    low, high = sensor.text(min(values)), sensor.text(max(values))
    unit = f" {sensor.unit}" if sensor.unit else ""
    return f"{low}{unit}" if low == high else f"{low}-{high}{unit}"
