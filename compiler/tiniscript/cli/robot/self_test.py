"""What a computer can check of a robot that should be ready for a lesson.

What the robot says of itself the doctor examines; here are its trim, and what it senses and does.
The findings are data: a verdict, a sentence and the next step, each a key with values. Nothing
moves before a person has lifted the robot; without a person no motor turns. Changes nothing that
the robot keeps.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping
from contextlib import suppress
from statistics import median
from typing import NamedTuple

from tiniscript.base.kit import Device
from tiniscript.cli.commands.trim import words
from tiniscript.cli.errors import CommandError
from tiniscript.cli.robot.connect import Connection
from tiniscript.cli.robot.event_printer import EventPrinter
from tiniscript.cli.robot.program_upload import follow_line
from tiniscript.cli.terminal import asking
from tiniscript.cli.texts import text
from tiniscript.doctor.examination import Expected, Heard, examined
from tiniscript.doctor.findings import PARTS
from tiniscript.doctor.robot import SharedRobot
from tiniscript.library.known_kits import name_of, of_kit
from tiniscript.link.messages import RESETS, SAVED
from tiniscript.link.names import row_name
from tiniscript.link.outcomes import LOST, Event
from tiniscript.link.requests import Reply
from tiniscript.link.trim import told
from tiniscript.robots.profile import Robot

OK, WRONG, OPEN = "ok", "wrong", "open"
READINGS = 3
NOTICED = 50  # a hand changes a reading by more than one part of so many of its range
TURNING = 60  # percent
STANDS = "W(2)"
AGAIN = "4"
ANSWERED = ("plain", "selftest_silent")  # failures that the robot has told: it is still there


class Found(NamedTuple):
    """One line of a self-test. `what`, `key` and `then` name sentences, those of a cause, too."""

    what: str
    verdict: str
    key: str
    then: str = ""
    values: Mapping[str, str] = {}


class NoPerson(Exception):
    """Nobody answers."""


class SelfTest:
    """The checks of a robot that answers. `is_asking`: a person is beside it."""

    def __init__(self, connection: Connection, is_given: bool, is_asking: bool) -> None:
        self.connection = connection
        self.language = connection.language
        self.is_given = is_given  # the person has said which robot it should be
        self.is_asking = is_asking
        self.found: list[Found] = []
        self.heard: Heard | None = None

    def run(self) -> list[Found]:
        """Return what was found; an end of the link is the last of it."""
        try:
            self._check()
        except CommandError as failure:
            said = failure.sentence(self.language)
            self._add("answers", WRONG, "self_plain", "then_doctor", said=said)
        return self.found

    def _check(self) -> None:
        self.connection.meet()
        self._add("answers", OK, "self_is_there")
        robot = self._examine()
        self._trim()
        if robot is None:
            return
        self.connection.profile = robot
        if self.heard is not None and self.heard.status.noise:
            self._discs()
        is_lifted = self._is_lifted()
        for sensor in robot.kit.sensors:
            self._sensor(sensor)
        for what, motors in (("left", f"M({TURNING}, 0)"), ("right", f"M(0, {TURNING})")):
            self._motor(what, f"{motors}; W(1); M(0, 0)", is_lifted)
        if robot.board.buzzer:
            self._buzzer()

    def _add(self, what: str, verdict: str, key: str, then: str = "", **values: str) -> None:
        self.found.append(Found(what, verdict, key, then, values))

    # -- what the robot says about itself

    def _examine(self) -> Robot | None:
        """Let the doctor examine it; return the robot that it is, where this computer knows it."""
        wanted = self.connection.profile
        kit = self.connection.device_info.kit
        expected = Expected(wanted.kit.fingerprint if self.is_given else None, wanted.name, name_of,
                            hear=self._hear)  # fmt: skip
        robot = SharedRobot(self.connection.line, self.connection.wait)
        reply = robot.hello()
        if reply is None:
            raise self.connection.failure(Reply(LOST))
        causes = {each.cause: each for each in examined(robot, reply, expected)}
        known = wanted if kit == wanted.kit.fingerprint else of_kit(kit)
        good = self._good(known.name if known is not None else "")
        for what, about in PARTS.items():
            wrong = [causes[cause] for cause in about if cause in causes]
            for each in wrong:
                verdict = WRONG if each.is_wrong else OPEN
                self._add(what, verdict, f"doctor_{each.cause}", f"next_{each.cause}",
                          **each.values)  # fmt: skip
            if not wrong and what in good:
                self.found.append(good[what])
        return known

    def _hear(self, heard: Heard) -> None:
        self.heard = heard

    def _good(self, name: str) -> dict[str, Found]:
        """Return what is said of each part of a robot of which nothing is wrong."""
        if self.heard is None:
            return {}
        hello, status, _, trips_ms = self.heard
        reset = text(f"reset_{row_name(RESETS, hello.reset)}", self.language)
        sizes = {size: str(getattr(hello, size)) for size in ("room", "largest", "window")}
        found = [
            Found("kit", OK, "self_kit_is", values={"robot": name}),
            Found("firmware", OK, "self_firmware_is",
                  values={"isa": f"{hello.isa_major}.{hello.isa_minor}", **sizes}),
            Found("supply", OK, "self_supply_is", values={"reset": reset}),
            _store(row_name(SAVED, status.saved)),
        ]  # fmt: skip
        if trips_ms:
            times = {"least": min(trips_ms), "ms": median(trips_ms), "most": max(trips_ms)}
            values = {"n": str(len(trips_ms)), **{each: f"{ms:.0f}" for each, ms in times.items()}}
            found.append(Found("line", OK, "self_line_is", values=values))
        return {each.what: each for each in found}

    def _trim(self) -> None:
        trim = told(self.connection.ask(lambda session: session.trim()).values)
        self._add("trim", OK, "self_trim_is", trim=words(trim, self.language))

    def _discs(self) -> None:
        """Let it stand, and longer than wheels roll: an edge is none of a wheel."""
        before = self.connection.ask(lambda session: session.status()).values.noise
        try:
            self._shown_by(STANDS)
        except CommandError as failure:
            if failure.key not in ANSWERED:
                raise
            said = failure.sentence(self.language)
            self._add("discs", WRONG, "self_plain", "then_doctor", said=said)
            return
        after = self.connection.ask(lambda session: session.status()).values.noise
        left, right = (str((now - then) % 256) for now, then in zip(after, before, strict=True))
        if left == right == "0":
            self._add("discs", OK, "self_discs_rest")
        else:
            self._add("discs", WRONG, "self_discs_noise", "then_discs", left=left, right=right)

    # -- what it senses and does

    def _is_lifted(self) -> bool:
        with suppress(NoPerson):
            self._asked("ask_lift")
            return True
        return False

    def _sensor(self, sensor: Device) -> None:
        name = sensor.name
        try:
            before = self._read(sensor)
            values = _range(sensor, before)
            self._asked("ask_free", name=name, values=values)
            before = self._read(sensor)
            values = _range(sensor, before)
            self._asked("ask_hand", name=name)
            after = self._read(sensor)
        except CommandError as failure:
            if failure.key not in ANSWERED:
                raise
            said = failure.sentence(self.language)
            self._add("sensor", WRONG, "self_no_reading", "then_wires", name=name, said=said)
            return
        except NoPerson:
            if not sensor.is_yes_no and {*before} <= {sensor.low, sensor.high}:
                self._add("sensor", OPEN, "self_stuck", "then_hand", name=name, values=values)
            else:
                self._add("sensor", OK, "self_reads", name=name, values=values)
            return
        now = _range(sensor, after)
        least = 0 if sensor.is_yes_no else (sensor.high - sensor.low) // NOTICED
        if abs(sum(after) - sum(before)) > least * READINGS:
            self._add("sensor", OK, "self_changes", name=name, values=values, now=now)
        elif sensor.is_yes_no:  # a hand may be as bright as the floor
            self._add("sensor", OPEN, "self_same", "then_hand", name=name, values=values, now=now)
        else:
            self._add("sensor", WRONG, "self_same", "then_wires", name=name, values=values, now=now)

    def _motor(self, what: str, line: str, is_lifted: bool) -> None:
        if not is_lifted:
            self._add(what, OPEN, "self_unasked", "then_person")
            return
        self._tried(what, line, {
            "1": (OK, "self_turns", ""), "2": (WRONG, "self_other_turn", "then_trim"),
            "3": (WRONG, "self_still", "then_wires"),
        })  # fmt: skip

    def _buzzer(self) -> None:
        if not self.is_asking:
            self._add("buzzer", OPEN, "self_unasked", "then_person")
            return
        self._tried("buzzer", "BEEP(0.5, 440)", {
            "1": (OK, "self_heard", ""), "3": (WRONG, "self_unheard", "then_wires"),
        })  # fmt: skip

    def _tried(self, what: str, line: str, verdicts: dict[str, tuple[str, str, str]]) -> None:
        """Let the robot do a line, and ask the person what it did."""
        try:
            answer = AGAIN
            while answer not in verdicts:
                self._shown_by(line)
                answer = self._asked(f"ask_{what}").strip()
        except NoPerson:
            self._add(what, OPEN, "self_unasked", "then_person")
        except CommandError as failure:
            said = failure.sentence(self.language)
            self._add(what, WRONG, "self_ended", "then_batteries", said=said)
            if failure.key not in ANSWERED:
                raise
        else:
            self._add(what, *verdicts[answer])

    def _read(self, sensor: Device) -> list[int]:
        """Return readings, in thousandths, or 0 and 1. Raises CommandError."""
        values = self._shown_by("; W(0.1); ".join([f"SHOW({sensor.name})"] * READINGS))
        if len(values) != READINGS:
            raise CommandError(3, "selftest_silent")
        return values

    def _shown_by(self, line: str) -> list[int]:
        """Let the robot do a line now; return what it showed. Raises CommandError."""
        values: list[int] = []
        said: list[str] = []

        def hold(event: Event) -> bool:
            if event.name == "SHOW":
                values.append(event.value)
            return event.name in ("SHOW", "DONE")

        printer = EventPrinter(self.language, out=said.append, err=said.append)
        if follow_line(self.connection, line, printer, hold):
            raise CommandError(3, "plain", said=" ".join(said))
        return values

    def _asked(self, key: str, **values: str) -> str:
        """Ask the person. Raises NoPerson where nobody answers."""
        if not self.is_asking:
            raise NoPerson
        answer = asking.answer(text(key, self.language).format(**values))
        if not answer:
            self.is_asking = False
            print(file=sys.stderr)
            raise NoPerson
        return answer


def _store(saved: str) -> Found:
    if saved in ("STORED", "NOTHING"):
        return Found("store", OK, "self_saved" if saved == "STORED" else "self_empty")
    return Found("store", OPEN, "self_unsaved", "then_upload")


def _range(sensor: Device, values: list[int]) -> str:
    low, high = sensor.text(min(values)), sensor.text(max(values))
    unit = f" {sensor.unit}" if sensor.unit else ""
    return f"{low}{unit}" if low == high else f"{low}-{high}{unit}"
