"""What a computer can check of a robot that should be ready for a lesson.

The findings are data: a verdict, a sentence and the next step, each a key with values. Nothing
moves before a person has lifted the robot; without a person no motor turns. Changes nothing that
the robot keeps.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping
from contextlib import suppress
from statistics import median
from time import perf_counter
from typing import NamedTuple

from tiniscript.base.kit import Device
from tiniscript.bytecode.opcodes import ISA_MAJOR, ISA_MINOR
from tiniscript.cli.commands.trim import words
from tiniscript.cli.errors import CommandError
from tiniscript.cli.robot.connect import Connection
from tiniscript.cli.robot.event_printer import EventPrinter
from tiniscript.cli.robot.program_upload import follow_line
from tiniscript.cli.terminal import asking
from tiniscript.cli.texts import text
from tiniscript.library.known_kits import of_kit
from tiniscript.link.messages import RESETS, SAVED
from tiniscript.link.names import row_name
from tiniscript.link.outcomes import Event
from tiniscript.link.payloads import StatusReply
from tiniscript.link.robot_state import lost_packets
from tiniscript.link.trim import told
from tiniscript.robots.profile import Robot

OK, WRONG, OPEN = "ok", "wrong", "open"
PINGS = 20
READINGS = 3
NOTICED = 50  # a hand changes a reading by more than one part of so many of its range
TURNING = 60  # percent
STANDS = "W(2)"
AGAIN = "4"
ANSWERED = ("plain", "selftest_silent")  # failures that the robot has told: it is still there


class Found(NamedTuple):
    """One line of a self-test. `what`, `key` and `then` name sentences."""

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
        robot = self._kit()
        self._firmware(robot)
        self._line()
        status = self.connection.ask(lambda session: session.status()).values
        self._supply(status)
        self._store(status)
        self._trim()
        if robot is None:
            return
        self.connection.profile = robot
        if status.noise:
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

    def _kit(self) -> Robot | None:
        """Return the robot that it is, where this computer knows it."""
        kit = self.connection.device_info.kit
        wanted = self.connection.profile
        if kit == wanted.kit.fingerprint:
            self._add("kit", OK, "self_kit_is", robot=wanted.name)
            return wanted
        robot = of_kit(kit)
        if robot is None:
            self._add("kit", WRONG, "self_kit_unknown", "then_profile", kit=f"{kit:04x}")
        elif self.is_given:
            names = {"robot": robot.name, "wanted": wanted.name}
            self._add("kit", WRONG, "self_kit_other", "then_kit", **names)
        else:
            self._add("kit", OK, "self_kit_is", robot=robot.name)
        return robot

    def _firmware(self, robot: Robot | None) -> None:
        major, minor = self.connection.device_info.isa
        said = {"isa": f"{major}.{minor}", "wanted": f"{ISA_MAJOR}.{ISA_MINOR}"}
        said["robot"] = robot.name if robot is not None else "my.toml"
        hello = self.connection.device_info.values
        said |= {name: str(getattr(hello, name)) for name in ("room", "largest", "window")}
        if (major, minor) == (ISA_MAJOR, ISA_MINOR):
            self._add("firmware", OK, "self_firmware_is", **said)
        else:
            self._add("firmware", WRONG, "self_firmware_old", "then_firmware", **said)

    def _line(self) -> None:
        """Ask often; what was damaged meanwhile, the robot has counted."""
        ask = self.connection.ask
        before = lost_packets(ask(lambda session: session.status()).values)
        times = []
        for _ in range(PINGS):
            begin_s = perf_counter()
            ask(lambda session: session.ping())
            times.append((perf_counter() - begin_s) * 1000)
        lost = lost_packets(ask(lambda session: session.status()).values) - before
        said = {"n": str(PINGS), "ms": f"{median(times):.0f}", "lost": str(lost)}
        said |= {"least": f"{min(times):.0f}", "most": f"{max(times):.0f}"}
        if lost > 0:
            self._add("line", WRONG, "self_line_bad", "then_nearer", **said)
        else:
            self._add("line", OK, "self_line_is", **said)

    def _supply(self, status: StatusReply) -> None:
        reset = row_name(RESETS, self.connection.device_info.values.reset)
        if reset == "BROWN_OUT" or row_name(SAVED, status.saved) == "LOW_SUPPLY":
            self._add("supply", WRONG, "self_supply_low", "then_batteries")
        elif reset == "WATCHDOG":
            self._add("supply", WRONG, "self_hung", "then_again")
        else:
            self._add("supply", OK, "self_supply_is", reset=text(f"reset_{reset}", self.language))

    def _store(self, status: StatusReply) -> None:
        saved = row_name(SAVED, status.saved)
        if saved == "OTHER_VERSION":
            self._add("store", WRONG, "self_other_version", "then_upload")
        elif saved in ("STORED", "NOTHING"):
            self._add("store", OK, "self_saved" if saved == "STORED" else "self_empty")
        else:
            self._add("store", OPEN, "self_unsaved", "then_upload")

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


def _range(sensor: Device, values: list[int]) -> str:
    low, high = sensor.text(min(values)), sensor.text(max(values))
    unit = f" {sensor.unit}" if sensor.unit else ""
    return f"{low}{unit}" if low == high else f"{low}-{high}{unit}"
