"""`tsc doctor --selftest`: robots that are ready, and robots that are not."""

from __future__ import annotations

import io
import json
import os
import signal
import sys
from collections.abc import Callable, Sequence
from contextlib import ExitStack, redirect_stderr, redirect_stdout
from itertools import product
from pathlib import Path
from types import SimpleNamespace
from typing import NamedTuple, cast
from unittest import mock

import pytest

from tests.machines.host_firmware import EMPTY_EEPROM, HostFirmware
from tests.support.command import Command, run_in_process
from tests.support.flicker import Flicker
from tests.support.pty_end import PtyEnd
from tests.support.pty_robot import PtyRobot, on
from tests.support.simulated_ends import Firmware
from tests.support.simulated_port import simulate
from tests.support.virtual_robot import robot_in
from tiniscript import robots
from tiniscript.cli import main
from tiniscript.cli.errors import CommandError
from tiniscript.cli.robot.connect import Connection
from tiniscript.cli.robot.conversation import ANSWER_AGAIN, Conversation, NoPerson
from tiniscript.cli.robot.self_test import SelfTest
from tiniscript.doctor import report
from tiniscript.library.simulated import SimulatedRobot
from tiniscript.link.messages import RESETS
from tiniscript.link.ports import open_port

GOOD_LIGHT, GOOD_DISTANCE = 500_000, 42_000  # thousandths
GOOD_READINGS = (GOOD_LIGHT, GOOD_LIGHT, GOOD_DISTANCE)


def find_with_selftest(
    pty_robot: PtyRobot, *words: str
) -> tuple[int, dict[str, dict[str, object]]]:
    """Return the exit code, and each finding by its subject."""
    result = on(pty_robot, "doctor", "--selftest", "--yes", "--json", *words)
    rows = json.loads(result.out)["found"]
    return result.code, {
        f"{row['what']} {row['values'].get('name', '')}".strip(): row for row in rows
    }


def test_a_good_robot_passes_without_a_person(pty_robot: PtyRobot) -> None:
    pty_robot.ask(lambda robot: robot.set_readings(*GOOD_READINGS))
    code, parts = find_with_selftest(pty_robot)
    assert code == 0
    verdicts = {name: value["verdict"] for name, value in parts.items()}
    sensors = {f"sensor {sensor.name}" for sensor in pty_robot.kit.sensors}
    questions = {"left", "right", "buzzer"}
    sizes = parts["firmware"]["values"]
    assert isinstance(sizes, dict)
    assert {name: sizes[name] for name in ("largest", "window")} == {"largest": "63", "window": "1"}
    assert int(sizes["room"]) >= 389
    assert parts["supply"]["values"] == {"reset": "POWER"}
    assert "power on" in str(parts["supply"]["said"])
    times = parts["line"]["values"]
    assert isinstance(times, dict)
    assert float(times["least"]) <= float(times["ms"]) <= float(times["most"])
    assert {name for name, value in verdicts.items() if value == "ok"} == {
        "answers", "kit", "firmware", "line", "supply", "store", "trim", *sensors
    }  # fmt: skip
    assert {name for name, value in verdicts.items() if value == "open"} == questions
    assert {finding["cause"] for finding in parts.values()} == {
        "is_there", "kit_is", "firmware_is", "line_is", "supply_is", "empty", "trim_is", "reads",
        "unasked",
    }  # fmt: skip
    assert not any("MOTORS" in line for line in pty_robot.actions), "nobody has lifted it"


@pytest.mark.parametrize("name", [*robots.names()])
def test_every_board_has_its_sensors_tested(name: str) -> None:
    """This works without `--robot`, too: the robot reports its kit."""
    kit = robots.load(name).kit
    with PtyRobot(kit) as robot:
        middle = [sensor.is_yes_no or (sensor.low + sensor.high) // 2 for sensor in kit.sensors]
        robot.ask(lambda host: host.set_readings(*map(int, middle)))
        code, parts = find_with_selftest(robot)
        # an ESP32's robot has the words of the paper's
        kits = {name: robots.load(name).kit for name in robots.names()}
        equal_kits = [
            {"robot": value} for value, robot_kit in kits.items() if robot_kit[:2] == kit[:2]
        ]
        assert parts["kit"]["values"] in equal_kits and {"robot": name} in equal_kits
        assert len([part for part in parts if part.startswith("sensor")]) == len(kit.sensors)
        assert code == 0


def test_a_kit_other_than_the_named_one_is_reported() -> None:
    with PtyRobot(robots.load("liner").kit) as robot:
        code, parts = find_with_selftest(robot, "--robot", "tinibot")
    assert code == 3
    assert parts["kit"]["verdict"] == "wrong"
    assert "--robot liner" in str(parts["kit"]["next"])


@pytest.mark.parametrize(("reset", "finding"), [("BROWN_OUT", "brown_out"), ("WATCHDOG", "hung")])
def test_a_restart_during_the_self_test_is_reported(
    pty_robot: PtyRobot, reset: str, finding: str
) -> None:
    with pty_robot._lock:
        pty_robot._take_power()
        number = [name for name, _ in RESETS].index(reset)
        pty_robot._robot = HostFirmware(pty_robot.kit, EMPTY_EEPROM, number)
    code, parts = find_with_selftest(pty_robot)
    assert code == 3
    assert (parts["supply"]["verdict"], parts["supply"]["cause"]) == ("wrong", finding)


def test_the_self_test_agrees_with_the_doctor(pty_robot: PtyRobot) -> None:
    """The causes are in one table, so supply, line and kit have no texts of their own here."""
    pty_robot.ask(lambda robot: robot.set_supply(True))
    on(pty_robot, "upload", "-e", "SB|F(1, 50)")
    pty_robot.damages = 97
    findings = json.loads(on(pty_robot, "doctor", "--robot", "liner", "--json").out)["findings"]
    _, parts = find_with_selftest(pty_robot, "--robot", "liner")
    assert parts["store"]["cause"] == "unsaved"
    finding_by_cause = {finding["cause"]: finding for finding in parts.values()}
    assert {finding["cause"] for finding in findings} >= {"low_supply", "wrong_kit", "lossy"}
    for finding in findings:
        if finding["is_wrong"]:
            own_finding = finding_by_cause[finding["cause"]]
            assert (own_finding["verdict"], own_finding["next"]) == ("wrong", finding["next"])
            assert own_finding["said"] == finding["said"]


def test_the_self_test_finds_faults(pty_robot: PtyRobot) -> None:
    """A sensor at the end of its range, a bad line, and in the middle of it the robot is silent."""
    lowest_reading = pty_robot.kit.sensors[0].low
    pty_robot.ask(lambda robot: robot.set_readings(lowest_reading, GOOD_LIGHT, GOOD_DISTANCE))
    _, parts = find_with_selftest(pty_robot)
    first_sensor, second_sensor = (f"sensor {sensor.name}" for sensor in pty_robot.kit.sensors[:2])
    assert parts[first_sensor]["cause"] == "stuck"
    assert parts[second_sensor]["verdict"] == "ok"
    pty_robot.ask(lambda robot: robot.set_readings(GOOD_LIGHT, GOOD_LIGHT, 0))
    code, parts = find_with_selftest(pty_robot)
    assert (code, parts["sensor DISTANCE"]["cause"]) == (3, "echo_hung")
    assert parts["sensor DISTANCE"]["verdict"] == "wrong"
    pty_robot.ask(lambda robot: robot.set_readings(lowest_reading, GOOD_LIGHT, GOOD_DISTANCE))
    pty_robot.damages = 100
    code, parts = find_with_selftest(pty_robot)
    assert code == 3
    assert parts["line"]["cause"] == "lossy"
    pty_robot.damages, pty_robot.off_after = 0, 150
    code, parts = find_with_selftest(pty_robot)
    assert code == 3
    assert parts["kit"]["verdict"] == "ok", "what was found before is said"
    assert (parts["answers"]["verdict"], parts["answers"]["cause"]) == ("wrong", "plain")


@pytest.mark.sampled("kind")
@pytest.mark.parametrize("kind", ["missing", "other speed", "locked", "silent radio"])
def test_without_a_robot_the_doctors_findings_are_reported_at_once(kind: str) -> None:
    """It prints the causes, the evidence and the next step, so that no other command is needed."""
    with ExitStack() as stack:
        port = "/dev/not-there"
        if kind == "silent radio":
            port = "socket://127.0.0.1:9"
        elif kind != "missing":
            end = stack.enter_context(PtyEnd(Firmware(57_600 if kind == "other speed" else 9600)))
            port = end.port
        if kind == "locked":
            stack.callback(open_port(port, 9600).close)
        findings = json.loads(run_in_process("doctor", "--port", port, "--json").out)["findings"]
        result = run_in_process("doctor", "--selftest", "--port", port, "--json").gives(3)
        text = run_in_process("doctor", "--selftest", "--port", port, "--lang", "en").gives(3).out
    reported = json.loads(result.out)["found"]
    wrong_findings = [finding for finding in findings if finding["is_wrong"]]
    assert wrong_findings and [finding["cause"] for finding in reported] == [
        finding["cause"] for finding in wrong_findings
    ]
    for reported_finding, doctor_finding in zip(reported, wrong_findings, strict=True):
        assert [reported_finding[key] for key in ("said", "seen", "next")] == [
            doctor_finding[key] for key in ("said", "seen", "next")
        ]
        assert reported_finding["next"] != "tsc doctor"
        assert all(
            sentence in text
            for sentence in (doctor_finding["said"], doctor_finding["seen"], doctor_finding["next"])
        )


def test_only_the_port_of_the_self_test_is_opened(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The board of another group may be on the only other port, which the user has not chosen."""
    monkeypatch.setattr("tiniscript.doctor.diagnosis.PSEUDO_TERMINALS", ())
    monkeypatch.setattr("tiniscript.doctor.linux._using_programs", lambda system, port: [])
    with PtyEnd(Firmware()) as end:
        monkeypatch.setattr("tiniscript.doctor.diagnosis._only_port", lambda *_: end.port)
        result = run_in_process("doctor", "--selftest", "--json").gives(3)
        assert end.received == b""
    assert json.loads(result.out)["found"][0]["cause"] == "not_opened"


# -- with a person


def run_self_test(
    pty_robot: PtyRobot, answers: Callable[[str], str], *words: str
) -> tuple[int, str, str]:
    """Run it with a person: `answers` gets each question and returns what is typed."""
    out, err = io.StringIO(), io.StringIO()

    class Keys:
        read = 0  # characters of `err`

        def isatty(self) -> bool:
            return False

        def readline(self) -> str:
            question = err.getvalue()[self.read :]
            assert question.endswith(("Enter. ", "its old trim. ", "again: ", "2 no: "))
            self.read += len(question)
            return f"{answers(question)}\n"

    with (
        simulate(pty_robot), redirect_stdout(out), redirect_stderr(err),
        mock.patch.object(sys, "stdin", Keys()),
    ):  # fmt: skip
        code = main(["doctor", "--selftest", "--port", pty_robot.port, "--lang", "en", *words])
    return code, out.getvalue(), err.getvalue()


class Wires(NamedTuple):
    """The wiring of a robot's motors; a motor that is `dead` does not turn."""

    is_exchanged: bool = False
    is_left_reversed: bool = False  # the wheel
    is_right_reversed: bool = False
    is_dead: bool = False

    def answer_after(self, actions: Sequence[str]) -> str:
        """Return the answer of a person who has seen the last motor turn."""
        outputs = [line.split()[-2:] for line in actions if "MOTORS" in line]
        left, right = next(
            [*map(int, output)] for output in reversed(outputs) if {*output} != {"0"}
        )
        if self.is_dead:
            return "5"
        if self.is_exchanged:
            left, right = right, left
        wheel, power = ("right", right) if right else ("left", left)
        is_reversed = self.is_right_reversed if right else self.is_left_reversed
        is_forward = (power > 0) != is_reversed
        return str({"left": 1, "right": 3}[wheel] + (not is_forward))


RIGHT_WIRES = Wires()


def person(
    pty_robot: PtyRobot, wires: Wires = RIGHT_WIRES, is_noticed: bool = True, learns: str = "2"
) -> Callable[[str], str]:
    """Return a person with a hand, who watches the motors."""

    def answer(question: str) -> str:
        if "Now put a hand" in question and is_noticed:
            pty_robot.ask(lambda robot: robot.set_readings(100_000, 100_000, 5_000))
        elif "its surroundings clear" in question:
            pty_robot.ask(lambda robot: robot.set_readings(*GOOD_READINGS))
        elif "motor turned" in question:
            return wires.answer_after(pty_robot.actions)
        return learns if "can remember" in question else "1"

    return answer


def causes(json_output: str) -> set[str]:
    return {finding["cause"] for finding in json.loads(json_output)["found"]}


def test_a_good_robot_passes_with_a_person(pty_robot: PtyRobot) -> None:
    pty_robot.ask(lambda robot: robot.set_readings(*GOOD_READINGS))
    assert on(pty_robot, "upload", "-e", "SB|F(1, 50)").code == 0
    code, out, _ = run_self_test(pty_robot, person(pty_robot), "--json")
    assert code == 0, out
    assert causes(out) == {
        "is_there", "kit_is", "firmware_is", "line_is", "supply_is", "saved", "trim_is", "changes",
        "turns", "heard",
    }  # fmt: skip
    motor_lines = [line for line in pty_robot.actions if "MOTORS" in line]
    assert motor_lines == ["MOTORS 60 0", "MOTORS 0 0", "MOTORS 0 60", "MOTORS 0 0"]


@pytest.mark.parametrize("motor", [1, 2])
def test_ctrl_c_stops_the_robot_whichever_motor_turns(pty_robot: PtyRobot, motor: int) -> None:
    pty_robot.ask(lambda robot: robot.set_readings(*GOOD_READINGS))
    sensors = 2 * len(pty_robot.kit.sensors)
    answers = b"\n" * (1 + sensors) + b"1\n" * (motor - 1)
    command = Command("doctor", "--selftest", "--port", pty_robot.port, data=answers)
    start_action = ["MOTORS 60 0", "MOTORS 0 60"][motor - 1]
    pty_robot.until(lambda: start_action in pty_robot.actions, "a motor turns")
    command.signal(signal.SIGINT)
    assert command.wait_for_result().code == 2
    assert not pty_robot.moves


def test_faults_seen_by_a_person_are_reported(pty_robot: PtyRobot) -> None:
    """The person reports motors that turn wrong or not at all, and sensors that notice nothing."""
    pty_robot.ask(lambda robot: robot.set_readings(*GOOD_READINGS))
    for wires, expected in (
        (Wires(is_exchanged=True), "tsc set trim"), (Wires(is_dead=True), "check its wires"),
    ):  # fmt: skip
        code, out, err = run_self_test(pty_robot, person(pty_robot, wires))
        assert code == 3
        assert out.count("WRONG") == 2
        assert f"Try:  {expected}" in out
        assert ("can remember" in err) == wires.is_exchanged
    assert on(pty_robot, "set", "trim", "--show").out.count("as they are wired") == 1
    code, out, _ = run_self_test(pty_robot, person(pty_robot, is_noticed=False))
    assert code == 3
    assert out.count("does not react") == len(pty_robot.kit.sensors)


def test_each_fault_seen_by_a_person_has_a_cause(pty_robot: PtyRobot) -> None:
    deaf = person(pty_robot, Wires(is_dead=True), is_noticed=False)

    def answer(question: str) -> str:
        return "2" if "buzzer" in question else deaf(question)

    _, out, _ = run_self_test(pty_robot, answer, "--json")
    assert causes(out) > {"same", "still", "unheard"}
    _, out, _ = run_self_test(pty_robot, person(pty_robot, Wires(is_left_reversed=True)), "--json")
    assert causes(out) > {"turns", "other_turn"}
    with PtyRobot(robots.load("liner").kit) as robot:
        _, out, _ = run_self_test(
            robot, lambda question: "5" if "motor" in question else "1", "--json"
        )
    assert "as_bright" in causes(out)


def test_each_line_ended_by_the_robot_has_a_cause(
    pty_robot: PtyRobot, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The robot still answers, so the other parts are checked too."""

    def fail(test: SelfTest, line: str) -> list[int]:
        raise CommandError(3, "plain", said="stopped")

    monkeypatch.setattr(SelfTest, "run_line", fail)
    _, out, _ = run_self_test(pty_robot, person(pty_robot), "--json")
    causes = [(finding["what"], finding["cause"]) for finding in json.loads(out)["found"]]
    sensors = [("sensor", "no_reading")] * len(pty_robot.kit.sensors)
    assert causes[-3 - len(sensors) :] == [
        *sensors, ("left", "ended"), ("right", "ended"), ("buzzer", "ended"),
    ]  # fmt: skip


WIRES = [Wires(*flags) for flags in product((False, True), repeat=3)]


@pytest.mark.parametrize("wires", WIRES)
def test_a_robot_learns_how_its_motors_are_wired(pty_robot: PtyRobot, wires: Wires) -> None:
    """Earlier values do not matter; the rest of its trim stays."""
    pty_robot.ask(lambda robot: robot.set_readings(*GOOD_READINGS))
    for options_before in ((), ("--exchange", "yes", "--reverse-left", "yes", "--balance", "7")):
        assert on(pty_robot, "set", "trim", *options_before, "--least", "3").code == 0
        code, out, _ = run_self_test(pty_robot, person(pty_robot, wires, learns="1"))
        assert (code, out.count("turns forward"), "WRONG" in out) == (0, 2, False), out
        kept_state = json.loads(on(pty_robot, "set", "trim", "--show", "--json").out)
        assert tuple(kept_state[name] for name in Wires._fields[:3]) == wires[:3]
        assert (kept_state["least"], kept_state["balance"]) == (3, 7 if options_before else 0)
        assert ("motors swapped" in out) == wires.is_exchanged, "what it keeps now is said"


def test_repeating_a_step_turns_the_motor_again(pty_robot: PtyRobot) -> None:
    """Without a requested number, no motor moves. If the person leaves, no motor turns either."""
    pty_robot.ask(lambda robot: robot.set_readings(*GOOD_READINGS))
    assert on(pty_robot, "doctor", "--selftest").code == 0
    assert not any("MOTORS" in line for line in pty_robot.actions)
    answers = iter(["6", "7", "6", "1", "3", "1"])

    def answer(question: str) -> str:
        return next(answers) if question.endswith("again: ") else ""

    code, _, err = run_self_test(pty_robot, answer)
    assert code == 3, "no sensor has noticed anything"
    assert "a number from 1 to 6" in err
    assert sum("MOTORS 60 0" in line for line in pty_robot.actions) == 3


# -- discs

HURRIED_PACE = 50.0


@pytest.mark.parametrize("number", [None, 0, 1])
def test_a_disc_that_flickers_at_rest_is_reported(number: int | None) -> None:
    robot = robot_in(name="tinibot2", eeprom_us=0)
    if number is not None:
        Flicker(robot, number, 20)
    simulated_robot = SimulatedRobot(robot, HURRIED_PACE)
    try:
        result = run_in_process(
            "doctor",
            "--selftest",
            "--port",
            simulated_robot.port,
            "--robot",
            "tinibot2",
            "--yes",
            "--json",
        )
        output = run_in_process("doctor", "--port", simulated_robot.port, "--lang", "en").out
    finally:
        simulated_robot.close()
    (disc,) = [finding for finding in json.loads(result.out)["found"] if finding["what"] == "discs"]
    if number is None:
        assert (result.code, disc["cause"]) == (0, "discs_rest") and "disc" not in output
        return
    edges = [int(disc["values"][side]) for side in ("left", "right")]
    assert (result.code, disc["cause"], disc["verdict"]) == (3, "discs_noise", "wrong")
    assert edges[number] >= 18 and edges[1 - number] == 0
    assert "a sensor" in output


# -- the report


def test_a_report_has_no_names(pty_robot: PtyRobot, tmp_path: Path) -> None:
    assert on(pty_robot, "set", "name", "LUISITO").code == 0
    file = tmp_path / "report.txt"
    for _ in range(2):  # a report of ours is replaced
        result = on(pty_robot, "doctor", "--selftest", "--yes", "--report", file)
    assert "LUISITO" in result.out
    report_text = file.read_text(encoding="utf-8")
    assert report_text.startswith(report.SELFTEST_MARK + "\n")
    for private in ("LUISITO", str(tmp_path), os.uname().nodename):
        assert private not in report_text
    assert "sensor" in report_text
    robot_file = tmp_path / "mine.txt"
    robot_file.write_text("mine")
    assert on(pty_robot, "doctor", "--selftest", "--yes", "--report", robot_file).code == 2
    assert robot_file.read_text() == "mine"


def test_a_missing_robot_has_a_report(tmp_path: Path) -> None:
    file = tmp_path / "report.txt"
    run_in_process("doctor", "--selftest", "--port", "/dev/serial-of-Ana", "--report", file).gives(
        3
    )
    report = file.read_text(encoding="utf-8")
    assert "Ana" not in report
    assert "tsc doctor" in report


@pytest.mark.parametrize("answers", range(4))
def test_after_an_unanswered_question_nothing_more_is_asked(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], answers: int
) -> None:
    """Nothing moves after an unanswered question."""
    actions: list[str] = []
    typed_lines = iter(["1\n"] * answers)
    monkeypatch.setattr(Conversation, "run_line", lambda _, line: actions.append(line))
    monkeypatch.setattr("tiniscript.cli.terminal.asking.ask", lambda _: next(typed_lines, ""))
    ways: list[Callable[[Conversation], object]] = [
        lambda talk: talk.ask_to_lift(),
        lambda talk: talk.ask("ask_free", name="X", values=""),
        lambda talk: talk.ask_choice("ask_learn", 2),
        lambda talk: talk.turn_motor("left"),
        lambda talk: talk.ask_what_was_seen("BEEP(1, 440)", "ask_buzzer", ANSWER_AGAIN),
    ]
    for final_step in ways:
        typed_lines = iter(["1\n"] * answers)
        talk = Conversation(cast(Connection, SimpleNamespace(language="en")))
        for _ in range(answers):
            ways[1](talk)
        with pytest.raises(NoPerson):
            final_step(talk)
        typed_lines = iter(["1\n"] * 10)  # more answers than questions
        actions.clear()
        capsys.readouterr()
        for step in ways:
            with pytest.raises(NoPerson):
                step(talk)
        assert actions == [] and capsys.readouterr().err == ""
