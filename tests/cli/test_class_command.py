"""`tsc class` as processes: robots with an ESP32 at Mosquitto, and other devices there.

One process keeps its connection to a broker.
"""

from __future__ import annotations

import csv
import json
import signal
from argparse import Namespace
from collections.abc import Iterator
from functools import partial
from itertools import product
from pathlib import Path
from types import SimpleNamespace
from typing import cast

import pytest

from tests.support.claimed_robots import become_another_computer, claim_with_button
from tests.support.command import FOREVER, Command, CommandResult, run_in_process, run_subprocess
from tests.support.esp32_near import (
    DRIVE_ACTIONS,
    DRIVE_PROGRAM,
    NETWORK,
    PASSWORD,
    files_with,
    list_motor_changes,
    put_network_in_reach,
)
from tests.support.esp32_pty_robot import Esp32PtyRobot
from tests.support.mosquitto import Mosquitto
from tests.support.pty_robot import on
from tests.support.rows import each_row
from tests.support.waiting import HANG_LIMIT_S, until
from tiniscript.cli.errors import CommandError
from tiniscript.cli.options import Options
from tiniscript.cli.robot import classroom, robot_broker
from tiniscript.cli.robot.classroom import Classroom, Listener
from tiniscript.cli.robot.connect import Connection
from tiniscript.cli.robot.member import Member
from tiniscript.link.messages import STATUSES
from tiniscript.link.outcomes import ShownEvent
from tiniscript.link.port_connection import now_ms
from tiniscript.link.requests import Reply
from tiniscript.link.transports.broker import ROOT, Access, Broker, RobotPresence

sampled = pytest.mark.sampled(of="commands for a class", keep=1)

SECRET = b"the password of all robots"
SEEDS = (0x12345678, 0x0BADCAFE)


class Class(list[Esp32PtyRobot]):
    """Two robots with owners at a broker, which asks for a password."""

    def __init__(self, folder: Path) -> None:
        self.broker = Mosquitto(folder, "robots", SECRET.decode())
        super().__init__(Esp32PtyRobot("tinibot32", seed) for seed in SEEDS)
        for robot in self:
            put_network_in_reach(robot)
            assert claim_with_button(robot).code == 0
            assert on(robot, "set", "wifi", NETWORK, data=PASSWORD + b"\n").code == 0
            result = on(
                robot, "set", "wifi", *self.place_options, "--user", "robots", data=SECRET + b"\n"
            ).gives(0)
            assert (
                "in the class 3b" in result.out and SECRET.decode() not in result.out + result.err
            )

    @property
    def place_options(self) -> list[str]:
        return ["--broker", f"127.0.0.1:{self.broker.port}", "--class", "3b"]

    @property
    def access_options(self) -> list[str]:
        return [*self.place_options, "--user", "robots"]

    def close(self) -> None:
        for robot in self:
            robot.clear_away()
        self.broker.kill()


@pytest.fixture
def room(tmp_path: Path) -> Iterator[Class]:
    classroom = Class(tmp_path)
    yield classroom
    classroom.close()


@pytest.fixture
def broker(tmp_path: Path) -> Iterator[Mosquitto]:
    """A broker that accepts everybody."""
    mosquitto = Mosquitto(tmp_path)
    yield mosquitto
    mosquitto.kill()


def tsc(room: Class, *words: str) -> CommandResult:
    result = run_subprocess("class", *words, *room.access_options, data=SECRET + b"\n")
    assert SECRET.decode() not in result.out + result.err
    return result


def start_endless_upload(room: Class) -> Command:
    """A command that stays and has all robots drive."""
    command = Command("class", "upload", "-e", FOREVER, *room.access_options, data=SECRET + b"\n")
    wait_until_all_drive(room)
    return command


def wait_until_all_drive(room: Class) -> None:
    for robot in room:
        robot.until(lambda robot=robot: robot.moves, "it drives")  # type: ignore[misc]


def advance_ms(room: Class, milliseconds: int) -> None:
    """Let time pass on each robot."""
    for robot in room:
        end_ms = robot.robot_ms + milliseconds
        robot.until(lambda robot=robot, ms=end_ms: robot.robot_ms > ms, "time has passed")  # type: ignore[misc]


def test_a_class_is_listed_driven_and_stopped(room: Class, tmp_path: Path) -> None:
    tsc(room).gives(0, out=("12345678", "0badcafe"))
    result = tsc(room, "upload", "-e", "SI|F(0.2, 80); SHOW(7)").gives(0)
    assert result.out.count("SHOW 7") == 2, result
    assert all(list_motor_changes(robot)[-2:] == DRIVE_ACTIONS for robot in room)
    assert files_with(tmp_path / "cache", SECRET) == []
    command = start_endless_upload(room)
    result = tsc(room, "stop")
    assert not any(robot.moves for robot in room)
    assert (result.code, result.out.count("has confirmed")) == (0, 2), result
    assert command.wait_for_result().code != 0
    room[1].switch_off()
    until(
        lambda: "0badcafe) is no longer connected to the broker: it is off" in tsc(room).out,
        "its last will",
    )


def test_computers_without_a_key_can_watch_and_stop(
    room: Class, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Clients without the broker's password do not see the class."""
    tsc(room, "upload", "-e", FOREVER, "--detach").gives(0)
    wait_until_all_drive(room)
    become_another_computer(monkeypatch, tmp_path)
    for data in (b"wrong\n", b"\n", b""):
        result = run_subprocess("class", *room.access_options, data=data)
        assert result.code in (2, 3) and result.out == "" and "assword" in result.err, data
    run_subprocess("class", *room.place_options).gives(3, "refuses this computer")
    assert "no deja entrar" in run_subprocess("class", *room.place_options, "--lang", "es").err
    tsc(room, "list").gives(0)
    result = tsc(room, "upload", "-e", DRIVE_PROGRAM).gives(3)
    assert result.out.count("has an owner") == 2
    assert all(robot.moves for robot in room)
    tsc(room, "stop").gives(0)
    assert not any(robot.moves for robot in room)


def test_a_suspended_driver_keeps_no_robot_driving(room: Class) -> None:
    """A robot keeps its client for 3 s; another client waits for that, and then gets a message."""
    command = start_endless_upload(room)
    command.signal(signal.SIGSTOP)
    start_times_ms = [robot.robot_ms for robot in room]
    for robot, start_ms in zip(room, start_times_ms, strict=True):
        assert robot.standstill_after_ms(start_ms) < 2000, "the dead-man timer is a second"
    command.process.kill()
    command = start_endless_upload(room)
    command.process.kill()
    command.process.wait()
    tsc(room, "upload", "-e", DRIVE_PROGRAM).gives(0)


@sampled
def test_watching_changes_nothing(room: Class) -> None:
    """This holds even if the command was suspended for longer than a driver may be silent."""
    text = "SI|LOOP(FOREVER); F(0.3, 80); SHOW(5); END_LOOP"
    tsc(room, "upload", "-e", text, "--detach").gives(0)
    command = Command("class", "show", *room.access_options, data=SECRET + b"\n")
    command.until("SHOW 5")
    command.signal(signal.SIGSTOP)
    advance_ms(room, 1200)
    command.signal(signal.SIGCONT)
    advance_ms(room, 2500)
    for robot in room:
        assert robot.moves, robot.actions
    command.process.kill()


def test_only_clients_that_drive_robots_have_to_keep_them_alive() -> None:
    room = SimpleNamespace(
        address=("h", 1), class_name="c", options=SimpleNamespace(verb="class"),
        broker=SimpleNamespace(attend=print),
    )  # fmt: skip
    robots = [RobotPresence("00000001", "A", True), RobotPresence("00000002", "B", False)]
    for verb, attends in (("class", False), ("stop", False), ("upload", True)):
        options = Classroom.options_for(cast(Classroom, room), robots, verb)
        assert options.verb == verb  # an upload stops its robots if its output is closed
        assert hasattr(options, "attend") == attends
        assert options.ports == ["mqtt://h:1/c/00000001"]


def test_messages_about_a_fleet_suggest_no_option_that_class_lacks() -> None:
    """Options that a class lacks have the fleet's default."""
    class_options = Options("class", "en").read(["upload"])
    room = SimpleNamespace(
        address=("h", 1),
        class_name="c",
        options=class_options,
        broker=SimpleNamespace(attend=print),
    )
    upload_options = Options("upload", "en").read([])
    assert class_options is not None and upload_options is not None
    for verb in ("class", "stop", "upload"):
        options = vars(Classroom.options_for(cast(Classroom, room), [], verb))
        missing_options = {
            name: value
            for name, value in vars(upload_options).items()
            if name not in vars(class_options)
        }
        assert len(missing_options) > 5
        assert {name: options.get(name, "none") for name in missing_options} == missing_options


@sampled
def test_values_are_collected(room: Class, tmp_path: Path) -> None:
    text = "SI|LOOP(FOREVER); SHOW(5); W(0.3); END_LOOP"
    tsc(room, "upload", "-e", text, "--detach").gives(0)
    (tmp_path / "rows.csv").write_bytes(b"robot,id,ms,event,value\nan older one\n")
    for listens_s in ("3", "15", "60"):  # a busy computer hears the second robot later
        words = ("show", "--max-time", listens_s, "--json", "--csv", str(tmp_path / "rows.csv"))
        result = tsc(room, *words).gives(0)
        values = [json.loads(line) for line in result.out.splitlines() if '"SHOW"' in line]
        if len({value["port"] for value in values}) == 2:
            break
    assert len({value["port"] for value in values}) == 2, result
    with (tmp_path / "rows.csv").open(encoding="utf-8", newline="") as file:
        header, *rows = csv.reader(file)
    assert header == ["robot", "id", "ms", "event", "value", "name"]
    shown_values = {(row[0], row[1], row[4]) for row in rows if row[3] == "SHOW"}
    assert shown_values == {("tinibot", f"{seed:08x}", "5") for seed in SEEDS}
    assert len([row for row in rows if row[3] == "SHOW"]) == len(values)


def test_the_times_of_all_robots_count_from_one_start() -> None:
    printed_lines: list[str] = []
    listener = Listener(True, None)
    start_ms = now_ms()
    shown_event = ShownEvent(5000, False)

    def listen(robot: int, after_ms: int) -> None:
        def watch(_: float | None) -> Iterator[tuple[int, ShownEvent]]:
            yield start_ms + after_ms, shown_event
            yield start_ms + after_ms + 100, shown_event
            raise KeyboardInterrupt

        connection = SimpleNamespace(
            port="x", name="tini", language="en", device_info=SimpleNamespace(id=robot), watch=watch
        )
        member = SimpleNamespace(meet_robot=lambda _: None, queue_line=printed_lines.append)
        listener.listen(cast(Connection, connection), cast(Member, member))

    listen(1, 2000)
    listen(2, 7000)
    times = [json.loads(line)["ms"] for line in printed_lines]
    early_ms = times[0] - 2000
    assert 0 <= early_ms < 1000
    assert [time_s - early_ms for time_s in times] == [2000, 2100, 7000, 7100]


@pytest.mark.parametrize("code", [0, 1, 2, 3])
@pytest.mark.parametrize("verb", ["list", "show", "show for a second", "upload", "stop"])
def test_the_exit_code_tells_the_outcome_for_the_robots(
    monkeypatch: pytest.MonkeyPatch, verb: str, code: int
) -> None:
    """Ctrl-C is the usual end of `class show`, and of no other command. 1 is a program with a
    mistake, which no robot gets."""
    options = SimpleNamespace(json=True, csv=None, max_time="1" if "second" in verb else None,
                          robot=None)  # fmt: skip
    room = cast(
        Classroom,
        SimpleNamespace(
            options=options,
            language="en",
            class_name="c",
            present_robots=list,
            options_for=lambda *_: options,
            broker=SimpleNamespace(stop=lambda _: True),
        ),
    )
    monkeypatch.setattr(classroom, "run_together", lambda *_: code)
    monkeypatch.setattr("tiniscript.cli.inputs.robot", lambda *_: None)
    monkeypatch.setattr("tiniscript.cli.inputs.program", lambda *_: SimpleNamespace(name="P"))
    monkeypatch.setattr("tiniscript.cli.inputs.robot_for", lambda *_: None)
    program = None if code == 1 else "a program"
    monkeypatch.setattr("tiniscript.cli.images.ready_program", lambda *_, **__: program)
    monkeypatch.setattr(classroom, "upload_to_many", lambda *_: code if program else 0)
    actions = {"list": classroom.list_robots, "upload": classroom.upload, "stop": classroom.stop}
    is_usual = verb.startswith("show") and code == 2
    assert actions.get(verb, classroom.show)(room) == (0 if is_usual else code)


@pytest.mark.parametrize("is_present", [True, False])
@pytest.mark.parametrize("losses", [*product((True, False, None), repeat=classroom.STOP_MESSAGES)])
def test_a_stop_succeeds_whichever_of_its_messages_is_lost(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str],
    losses: tuple[bool | None, ...], is_present: bool,
) -> None:  # fmt: skip
    """All of them are tried, and then each robot is asked whether it has stopped; if none can be
    asked, the output reports whether a message was sent."""
    losses_left, calls = [*losses], []

    def stop(group: str) -> bool:
        has_gone = losses_left.pop(0)
        if has_gone is None:
            raise ConnectionResetError
        return has_gone

    def present() -> list[object]:
        if not is_present:
            raise CommandError(3, "class_empty", group="c", host="h")
        return []

    room = SimpleNamespace(
        broker=SimpleNamespace(stop=stop),
        class_name="c",
        present_robots=present,
        language="en",
        options_for=lambda *arguments: arguments,
    )

    def ask(*arguments: object) -> int:
        calls.append(arguments)
        return 7

    monkeypatch.setattr(classroom, "run_together", ask)
    monkeypatch.setattr("tiniscript.cli.inputs.robot", lambda *_: None)
    if is_present:
        assert classroom.stop(cast(Classroom, room)) == 7 and len(calls) == 1
    else:
        with pytest.raises(CommandError):
            classroom.stop(cast(Classroom, room))
    assert losses_left == []
    has_gone = "the stop for all robots" in capsys.readouterr().err
    assert has_gone == (not is_present and any(losses))


def test_a_missing_broker_and_an_empty_class_are_reported(broker: Mosquitto) -> None:
    """A stranger's retained messages never reach a terminal unescaped."""
    run_in_process("class", "--broker", "127.0.0.1:1").gives(3, "no MQTT broker responds")
    broker_option = ("--broker", f"127.0.0.1:{broker.port}")
    for words in ([], ["stop"], ["upload", "-e", DRIVE_PROGRAM], ["show"]):
        run_in_process("class", *words, *broker_option).gives(3, "no robot of the class class")
    assert run_in_process("class", "--tls", *broker_option).code == 3
    stranger = broker.connect_client()
    for robot, data in (("00000001", b"+\x1b[2Jtsc: ok\n"), ("00000002", b"-\x9b2J\r")):
        stranger._client.publish(f"{ROOT}/class/{robot}", data, retain=True)
    stranger._client.publish("last", b"", qos=1).wait_for_publish(HANG_LIMIT_S)
    result = run_subprocess("class", *broker_option).gives(3)
    assert not set(result.out + result.err) & set("\x1b\x9b\r")
    assert "is no longer connected to the broker: it is" in result.out


@each_row("words", [
    [], ["--user", "x"], ["--broker", ""], ["--broker", "x:0"], ["--broker", "x:65536"],
    ["--broker", "http://x"], ["--broker", "x", "--class", "a/b"],
    ["--broker", "x", "--class", "#"], ["--broker", "x", "--class", ""],
    ["--broker", "x", "--trust", "f"], ["list", "prog.ts", "--broker", "x"],
    ["--broker", "x", "--tls", "--trust", "/none"], ["--broker", "x", "--user", ""],
    ["drive", "--broker", "x"], ["list", "--broker", "x", "--csv", "f"],
])  # fmt: skip
def test_nonsensical_arguments_are_refused_before_anything_is_contacted(words: list[str]) -> None:
    for language in ("en", "es"):
        result = run_in_process("class", *words, "--lang", language)
        assert result.code == 2 and result.err.startswith("tsc: ") and not result.out


@each_row("words", [
    ["--broker", "x", "--no-broker"], ["NET", "--broker", "x"], ["--forget", "--no-broker"],
    ["--user", "x"], ["--class", "x"], ["--broker", "no.such.host.invalid"],
])  # fmt: skip
def test_a_robots_broker_is_set_with_valid_arguments_only(words: list[str]) -> None:
    result = run_in_process("set", "wifi", *words, "--port", "/none", data=PASSWORD)
    assert result.code == 2 and result.err.startswith("tsc: ")


def test_a_robot_without_broker_support_is_reported_as_old() -> None:
    """Its firmware refuses the step: the sentence about a bad value would not help."""
    connection = SimpleNamespace(
        name="Tini",
        begin_request=lambda make_request: None,
        error_for_reply=AssertionError,
        port="/dev/ttyUSB0",
        wait=lambda request: Reply(STATUSES["BAD_VALUE"]),
    )
    connection.request = partial(Connection.request, cast(Connection, connection))
    connection.request_or_raise = partial(Connection.request_or_raise, cast(Connection, connection))
    with pytest.raises(CommandError) as exception_info:
        robot_broker.use_broker(cast(Connection, connection), None, Namespace())
    assert "older than this tsc" in exception_info.value.sentence("en")


def retain_message(client: Broker, topic: str, payload: bytes) -> None:
    """Make a broker retain a message."""
    client._client.publish(topic, payload, qos=1, retain=True).wait_for_publish(HANG_LIMIT_S)
    client.close()


def test_a_large_retained_message_is_named_and_a_stop_is_reported_as_sent(
    broker: Mosquitto,
) -> None:
    place_options = ["--broker", f"127.0.0.1:{broker.port}", "--class", "3b"]
    retain_message(broker.connect_client(), f"{ROOT}/3b/big", bytes(5000))
    named_texts = ("bytes under tiniscript/3b/big", "no robot of the class 3b")
    result = run_subprocess("class", "list", *place_options).gives(3, *named_texts)
    assert "no answer of a broker" not in result.err
    run_subprocess("class", "stop", *place_options).gives(
        3, "the stop for all robots", *named_texts
    )
    retain_message(broker.connect_client(), f"{ROOT}/3b/0badcafe", b"-ANA")
    run_subprocess("class", "stop", *place_options, "--lang", "es").gives(
        3, "llegó al broker", "3b/big"
    )


@sampled
def test_robots_are_listed_and_stopped_beside_a_large_message(room: Class) -> None:
    access = Access("robots", SECRET.decode())
    topic = f"{ROOT}/3b/{SEEDS[0] ^ 1:08x}"
    retain_message(Broker("127.0.0.1", room.broker.port, access), topic, bytes(5000))
    tsc(room).gives(0, topic, out=("12345678", "0badcafe"))
    command = start_endless_upload(room)
    result = tsc(room, "stop").gives(0, topic)
    assert not any(robot.moves for robot in room) and result.out.count("has confirmed") == 2
    assert command.wait_for_result().code != 0
