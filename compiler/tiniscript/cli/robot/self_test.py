"""The checks that a computer can make of a robot before a lesson.

The doctor examines what the robot reports about itself; this module asks for its trim and checks
what it senses and does. No motor turns before a person has confirmed that the robot is lifted;
without a person, none turns at all. It changes no stored data of the robot, except the wiring of
its motors, after a yes.
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
from tiniscript.doctor.findings import Finding, sure_finding
from tiniscript.library.known_kits import robot_of_kit
from tiniscript.link.messages import RESETS, SAVED_STATES
from tiniscript.link.names import row_name
from tiniscript.link.trim import Trim, trim_from_reply
from tiniscript.robots.profile import Robot, Wiring

SELF_REPORTED_PARTS = (
    "kit",
    "firmware",
    "line",
    "supply",
    "store",
)  # sensors that report their own faults
SIDES = ("left", "right")
READING_COUNT = 3
SONAR = "hc_sr04"  # a driver: one that hangs is read as 0
NOTICEABLE_PARTS = 50  # the fraction of its range by which a hand must change a reading
WAIT_LINE = "W(2)"
BUZZER_HEARD, BUZZER_AGAIN = 1, 3  # answers about the buzzer
ANSWERED_FAILURES = (
    "plain",
    "selftest_silent",
)  # failures that the robot reported, so it is still there


class SelfTest(Conversation):
    """The checks of a robot that has answered. `is_asking`: a person is at the robot."""

    def __init__(self, connection: Connection, expectations: Expectations, is_asking: bool) -> None:
        super().__init__(connection, is_asking)
        self.expectations = expectations
        self.findings: list[Finding] = []
        self.robot_answers: RobotAnswers | None = None
        self.trim = Trim()

    def run(self) -> list[Finding]:
        """Return the findings; a lost link is the last one."""
        try:
            self._run_checks()
        except CommandError as error:
            self._add_finding("plain", said=error.sentence(self.language))
        return self.findings

    def _run_checks(self) -> None:
        self._add_finding("is_there")
        robot = self._examine_robot()
        self.trim = trim_from_reply(self.connection.request(lambda session: session.trim()).values)
        self.findings.append(self._trim_finding())
        if robot is None:
            return
        self.connection.profile = robot
        if self.robot_answers is not None and self.robot_answers.status.noise:
            self._check_discs()
        is_lifted = self._ask_whether_lifted()
        for sensor, wiring in zip(robot.kit.sensors, robot.board.sensors, strict=True):
            self._check_sensor(sensor, wiring)
        self._check_motors(is_lifted)
        if robot.board.buzzer is not None:
            self._check_buzzer()

    def _add_finding(self, cause: str, part: str = "", **values: str) -> None:
        self.findings.append(Finding(cause, True, values, part))

    # -- the robot's description of itself

    def _examine_robot(self) -> Robot | None:
        """Examine the robot; return its profile, if this computer knows it."""
        expected_robot = self.connection.profile
        kit = self.connection.device_info.kit
        causes, self.robot_answers = examination_of(self.connection, self.expectations)
        known_robot = expected_robot if kit == expected_robot.kit.fingerprint else robot_of_kit(kit)
        passed_by_part = self._passed_parts(known_robot.name if known_robot is not None else "")
        for part in SELF_REPORTED_PARTS:
            self.findings += [
                cause for cause in causes if cause.part == part
            ] or passed_by_part.get(part, [])
        return known_robot

    def _passed_parts(self, robot_name: str) -> dict[str, list[Finding]]:
        """Return the findings of each part without faults."""
        if self.robot_answers is None:
            return {}
        hello, status, _, trips_ms = self.robot_answers
        sizes = {size: str(getattr(hello, size)) for size in ("room", "largest", "window")}
        findings = [
            sure_finding("kit_is", robot=robot_name),
            sure_finding("firmware_is", isa=f"{hello.isa_major}.{hello.isa_minor}", **sizes),
            sure_finding("supply_is", reset=row_name(RESETS, hello.reset)),
            sure_finding(_saved_cause(row_name(SAVED_STATES, status.saved))),
        ]
        if trips_ms:
            times = {"least": min(trips_ms), "ms": median(trips_ms), "most": max(trips_ms)}
            values = {value: f"{ms:.0f}" for value, ms in times.items()}
            findings.append(sure_finding("line_is", n=str(len(trips_ms)), **values))
        return {finding.part: [finding] for finding in findings}

    def _check_discs(self) -> None:
        """Check that no disc counts edges after the wheels have come to rest."""
        edges_before = self.connection.request(lambda session: session.status()).values.noise
        try:
            self.run_line(WAIT_LINE)
        except CommandError as error:
            if error.key not in ANSWERED_FAILURES:
                raise
            self._add_finding("plain", "discs", said=error.sentence(self.language))
            return
        edges_after = self.connection.request(lambda session: session.status()).values.noise
        left, right = (
            str((count_now - count_before) % 256)
            for count_now, count_before in zip(edges_after, edges_before, strict=True)
        )
        if left == right == "0":
            self._add_finding("discs_rest")
        else:
            self._add_finding("discs_noise", left=left, right=right)

    # -- its sensors and actions

    def _ask_whether_lifted(self) -> bool:
        with suppress(NoPerson):
            self.ask_to_lift()
            return True
        return False

    def _check_sensor(self, sensor: Device, wiring: Wiring) -> None:
        name = sensor.name
        try:
            readings_before = self._read(sensor)
            if wiring.driver == SONAR and not any(readings_before):  # an obstacle cannot be so near
                self._add_finding("echo_hung", name=name)
                return
            values = _range(sensor, readings_before)
            self.ask("ask_free", name=name, values=values)
            readings_before = self._read(sensor)
            values = _range(sensor, readings_before)
            self.ask("ask_hand", name=name)
            readings_after = self._read(sensor)
        except CommandError as error:
            if error.key not in ANSWERED_FAILURES:
                raise
            self._add_finding("no_reading", name=name, said=error.sentence(self.language))
            return
        except NoPerson:
            is_stuck = not sensor.is_yes_no and {*readings_before} <= {sensor.low, sensor.high}
            self._add_finding("stuck" if is_stuck else "reads", name=name, values=values)
            return
        range_text = _range(sensor, readings_after)
        least_change = 0 if sensor.is_yes_no else (sensor.high - sensor.low) // NOTICEABLE_PARTS
        if abs(sum(readings_after) - sum(readings_before)) > least_change * READING_COUNT:
            cause = "changes"
        else:  # a hand may be as bright as the floor
            cause = "as_bright" if sensor.is_yes_no else "same"
        self._add_finding(cause, name=name, values=values, now=range_text)

    def _check_motors(self, is_lifted: bool) -> None:
        """Turn both. A robot with other wires may learn them, and turns both again."""
        findings_before = self.findings
        self.findings = [*findings_before]
        left, right = (self._check_motor(side, is_lifted) for side in SIDES)
        if left is None or right is None or not self._offer_wiring(left, right):
            return
        self.findings = [
            self._trim_finding() if finding.cause == "trim_is" else finding
            for finding in findings_before
        ]
        for side in SIDES:
            self._check_motor(side, is_lifted)

    def _check_motor(self, side: str, is_lifted: bool) -> WheelTurn | None:
        """Return a person's answer about a motor, and record it; None if no person saw it."""
        try:
            if not is_lifted:
                raise NoPerson
            turn = self.turn_motor(side)
        except NoPerson:
            self._add_finding("unasked", side)
            return None
        except CommandError as error:
            self._record_failure(side, error)
            return None
        if not turn.wheel:
            self._add_finding("still", side)
        else:
            self._add_finding("turns" if turn == WheelTurn(side, True) else "other_turn", side)
        return turn

    def _offer_wiring(self, left: WheelTurn, right: WheelTurn) -> bool:
        """Offer to store the wiring of the motors, if it is new."""
        trim = trim_from_answers(self.trim, left, right)
        if trim is None or trim == self.trim:
            return False
        with suppress(NoPerson):
            if self.ask_choice("ask_learn", 2) == ANSWER_YES:
                self.connection.request(lambda session: session.trim(trim.data()))
                self.trim = trim
                return True
        return False

    def _trim_finding(self) -> Finding:
        return sure_finding("trim_is", trim=trim_in_words(self.trim, self.language))

    def _check_buzzer(self) -> None:
        try:
            answer = self.ask_what_was_seen("BEEP(0.5, 440)", "ask_buzzer", BUZZER_AGAIN)
        except NoPerson:
            self._add_finding("unasked", "buzzer")
        except CommandError as error:
            self._record_failure("buzzer", error)
        else:
            self._add_finding("heard" if answer == BUZZER_HEARD else "unheard")

    def _record_failure(self, part: str, error: CommandError) -> None:
        self._add_finding("ended", part, said=error.sentence(self.language))
        if error.key not in ANSWERED_FAILURES:
            raise error

    def _read(self, sensor: Device) -> list[int]:
        """Return readings, in thousandths, or 0 and 1. Raises CommandError."""
        values = self.run_line("; W(0.1); ".join([f"SHOW({sensor.name})"] * READING_COUNT))
        if len(values) != READING_COUNT:
            raise CommandError(3, "selftest_silent")
        return values


def _saved_cause(saved_state: str) -> str:
    """Return the cause behind the robot's report on its program."""
    return {"STORED": "saved", "NOTHING": "empty"}.get(saved_state, "unsaved")


def _range(sensor: Device, values: list[int]) -> str:
    low, high = sensor.text(min(values)), sensor.text(max(values))
    unit = f" {sensor.unit}" if sensor.unit else ""
    return f"{low}{unit}" if low == high else f"{low}-{high}{unit}"
