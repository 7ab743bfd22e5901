"""A person's first minutes: the button, the second terminal, other robots, slips."""

from __future__ import annotations

import json
import re
import sys
from pathlib import Path
from random import Random

import pytest

from tests.support.casefile import ROOT
from tests.support.command import OBSTACLE, Command, Tsc, run_in_process
from tests.support.link_events import event
from tests.support.rows import each_row
from tests.support.virtual_command import Robot, robot
from tests.support.virtual_robot import Talk, robot_in
from tiniscript import compile_text, robots
from tiniscript.cli.commands.live import HELP_ME, LEAVE, ValueCatcher, requested_command
from tiniscript.cli.robot.bookkeeping import BOOKKEEPING_MARK, Bookkeeping
from tiniscript.cli.robot.connect import Connection
from tiniscript.cli.robot.event_printer import EventPrinter
from tiniscript.cli.robot.live_state import LiveState
from tiniscript.library.other_robots import hints_among
from tiniscript.link import known_ports, ports
from tiniscript.link.outcomes import POLL_INTERVAL_S, Event, MissedEvent, RestartedEvent, ShownEvent
from tiniscript.link.payloads import DoneEvent
from tiniscript.robots import given
from tiniscript.virtual import directory
from tiniscript.virtual.directory import RunningRobot
from tiniscript.virtual.simulator import Simulator
from tiniscript.virtual.transports import Transports

FOREVER = "SI|LOOP(FOREVER);L(1, 30);END_LOOP"
# A program of the robot liner that does not name it.
LINE = ("-e", (ROOT / "examples" / "line.ts").read_text().replace("// robot: liner\n", ""))
PROGRAM = Path("examples/obstacle_until.ts")


# -- a program that a button starts ---------------------------------------------------------------


def test_without_a_terminal_the_button_is_pushed_at_once(tmp_path: Path) -> None:
    picture = tmp_path / "way.png"
    result = run_in_process("upload", "--virtual", "-e", "SB|F(1, 80);SHOW(1.5)", "--plot", picture)
    receipt, *rest = result.out.splitlines()
    assert result.code == 0
    assert receipt.endswith("SB: its button is pressed right away, since there is no keyboard here")
    assert sorted(rest[:3]) == [
        "Done.",
        "SHOW 1.5",
        "Saved. The button starts it.",
    ]  # the program is saved meanwhile
    assert rest[3].startswith("The virtual robot drove 36 cm in 1.0 s and touched nothing.")
    assert picture.read_bytes().startswith(b"\x89PNG")
    run_in_process("upload", "--virtual", "-e", "SB|X = 0;SHOW(1 / X)", "--lang", "es").gives(
        1, "DIVIDE_BY_ZERO", out="su botón se pulsa de inmediato"
    )


MAX_LOOKS = 300  # most events to look at while a command may need time to save


@pytest.fixture
def ends_in_time(monkeypatch: pytest.MonkeyPatch) -> None:
    """A command that looks at events long after its time is over fails: it would never end."""
    wait_for_event, look_count = Connection.event, 0

    def count_and_wait(
        connection: Connection, timeout_s: float = POLL_INTERVAL_S
    ) -> tuple[int, Event] | None:
        nonlocal look_count
        look_count += connection.is_time_over
        assert look_count < MAX_LOOKS, "its time is over, and it goes on"
        return wait_for_event(connection, timeout_s)

    monkeypatch.setattr(Connection, "event", count_and_wait)


@pytest.mark.usefixtures("ends_in_time")
def test_a_program_with_a_button_ends_at_its_time_limit() -> None:
    """Ends at the time of `--for`, to the millisecond. A mere upload presses no button."""
    text = FOREVER.replace("SI", "SB")
    result = run_in_process(
        "upload", "--virtual", "-e", text, "--for", "3", "--hurry", "max", "--json"
    )
    assert result.code == 0
    rows = [json.loads(line) for line in result.out.splitlines()]
    assert [row["event"] for row in rows] == ["RECEIPT", "TIME_OVER", "SAVED"]
    assert rows[0]["is_pushed"] is True
    assert "drove 0 cm in 3.0 s" in result.err
    result = run_in_process("upload", "--virtual", "--no-run", "-e", "SB|F(1, 80)")
    assert (result.code, result.err) == (0, "")
    assert "SB: waiting for the button" in result.out
    run_in_process("upload", "--virtual", "--detach", "-e", "SI|F(1, 80)").gives(
        2, "Leave --detach out"
    )
    lines = b"F(0.1, 50)\nSHOW(1)\nLOOP(FOREVER);F(1, 50);END_LOOP\nSHOW(2)\n"
    result = run_in_process(
        "live", "-", "--virtual", "--for", "5", "--hurry", "50", data=lines
    ).gives(0)
    assert result.out.splitlines()[:2] == ["SHOW 1", "The time set with --for is over."]
    assert "SHOW 2" not in result.out


@pytest.mark.usefixtures("ends_in_time")
@pytest.mark.parametrize("hurry", ["1", "50", "max"])
def test_the_duration_of_for_is_program_time(hurry: str) -> None:
    result = run_in_process(
        "upload", "--virtual", "-e", OBSTACLE, "--for", "2.5", "--hurry", hurry
    ).gives(0)
    # 2.5 s at 80 % of 45 cm a second, to the millisecond
    assert result.out.splitlines()[1:] == [
        "The time set with --for is over.", "Saved. The button starts it.",
        "The virtual robot drove 90 cm in 2.5 s and touched nothing.",
    ]  # fmt: skip


@pytest.mark.parametrize("hurry", [1.0, 20.0, 0.0])
def test_time_ends_to_the_millisecond(hurry: float) -> None:
    """The robot then stands still, whatever its firmware does, and sends nothing more."""
    transports = Transports()
    simulator = Simulator(robot_in(), transports, hurry)
    simulator.duration_ms = 1500
    robot = simulator.robot
    Talk(robot).upload("SI|LOOP(FOREVER);F(0.3, 80);SHOW(1);END_LOOP", is_detached=True)
    assert robot.started_ms is not None
    while not robot.is_at_rest:
        simulator.turn(0.01)
    assert simulator.over_ms == robot.started_ms + 1500 == robot.ended_ms
    place, events = robot.pose, robot.take_events()
    assert events[-1].text == "STOP"
    assert events[-1].time_ms == robot.ended_ms
    for _ in range(30):
        simulator.turn(0.01)
    assert robot.pose == place
    assert robot.take_events() == []
    transports.close()


# -- the other terminal ---------------------------------------------------------------------------


class Upload(Robot):
    """A `tsc upload --virtual` that drives."""

    def __init__(self, *arguments: str) -> None:
        self.command = Command("upload", "--virtual", "-e", FOREVER, *arguments)
        receipt = self.line()
        self.port = re.search(r"\((socket://.*?)\)", receipt)[1]  # type: ignore[index]


@pytest.mark.parametrize("options", [[], ["--virtual"]])
def test_stop_finds_the_one_robot_that_is_in_use(options: list[str]) -> None:
    upload = Upload()
    # a command that brings a robot along does not take that of another one
    virtual_result = run_in_process("upload", "--virtual", "-e", "SI|SHOW(1)")
    assert "SHOW 1" in virtual_result.out and upload.port not in virtual_result.out
    assert run_in_process("doctor", "--virtual").code == 0
    result = run_in_process("stop", *options)
    assert (result.code, result.out) == (
        0, f"Stopped: the robot on {upload.port} has confirmed the stop.\n",
    )  # fmt: skip
    upload.command.wait_for_result().gives(3, out="The robot was stopped from a computer.")
    result = run_in_process("stop", *options)
    assert result.code == 3  # the robot no longer exists
    assert directory.running_robots() == []


def test_stop_stops_all_robots_in_use() -> None:
    """Rather one too many than one too few; the last used one, too, where it is there."""
    with robot() as running_robot:
        first, second = Upload("--seed", "1"), Upload("--seed", "2")
        run_in_process("upload", "--port", running_robot.port, "-e", FOREVER, "--detach")
        result = run_in_process("stop").gives(0)
        assert result.err == "Done: 3 of 3.\n"
        assert {running_robot.port, first.port, second.port} <= set(
            re.findall(r"socket:\S*\d", result.out)
        )
        assert [upload.command.wait_for_result().code for upload in (first, second)] == [3, 3]
        assert running_robot.until("STOP")


def test_stop_includes_the_last_used_port(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    from tiniscript.cli.robot import in_reach

    usb = tmp_path / "usb"
    known_ports.remember(str(usb), "TINI")
    running_robots = [RunningRobot("socket://127.0.0.1:5", "tinibot", "light", "", "", "upload")]
    monkeypatch.setattr(directory, "running_robots", lambda: running_robots)
    assert in_reach.ports_to_stop() == ["socket://127.0.0.1:5"]  # the cable is out
    usb.touch()
    assert in_reach.ports_to_stop() == ["socket://127.0.0.1:5", str(usb)]
    assert in_reach.ports_to_stop(is_virtual=True) == ["socket://127.0.0.1:5"]


def test_a_virtual_robot_that_has_ended_is_not_a_port(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ports, "list_ports", list)
    with robot("--name", "KAT") as running_robot:
        assert run_in_process("doctor", "--ports", "--ask").code == 0
        assert run_in_process("doctor", "--identify", "--all").code == 0
        local = running_robot.port.replace("127.0.0.1", "localhost")
        assert run_in_process("doctor", "--identify", "--port", local).code == 0
        assert running_robot.port in run_in_process("doctor", "--ports").out
        result = run_in_process(
            "live", "-", "--port", running_robot.port, data=b"X = 5;SHOW(X)\nS\n"
        )
        assert (result.code, result.out) == (0, "X 5\n")
        lines = running_robot.until("DONE") + running_robot.until("DONE")
        assert sum("SHOW" in line for line in lines) == 1, "what live keeps is not printed"
    assert "socket" not in run_in_process("doctor", "--ports").out
    known_ports.remember(running_robot.port, "KAT")  # remembered by a tsc that found it
    assert "socket" not in run_in_process("doctor", "--ports").out
    run_in_process("start").gives(3, "is gone")


# -- a run without a robot ------------------------------------------------------------------------


@each_row(
    "words, message",
    [
        (["-e", "SI|SHOW(DISTANCE);SHOW(DISTANCE)"],
         "DISTANCE always read 0. To supply readings:  --sensor DISTANCE=50,9\n"),
        (["-e", "SI|SHOW(DISTANCE)", "--machine", "cpp"],
         "DISTANCE always read 0. To supply readings:  --sensor DISTANCE=50,9\n"),
        (["-e", "SI|SHOW(DISTANCE)", "--show", "--lang", "es"],
         "DISTANCE midió 0: --sensor DISTANCE=50,9\n"),
        (["-e", "SI|SHOW(DISTANCE)", "--sensor", "DISTANCE=0"], ""),
        (["-e", "SI|SHOW(DISTANCE + LIGHT_R)", "--sensor", "DISTANCE=5"],
         "LIGHT_R always read 0. To supply readings:  --sensor LIGHT_R=127,23\n"),
        (["-e", "SI|IF(FALSE);SHOW(DISTANCE);ENDIF"], ""),
        (["-e", "// robot: liner\nSI|SHOW(BUTTON);SHOW(BATTERY)"],
         "BUTTON always read FALSE. To supply readings:  --sensor BUTTON=FALSE,TRUE\n"
         "BATTERY always read 0. To supply readings:  --sensor BATTERY=1,0.2\n"),
    ],
)  # fmt: skip
def test_a_sensor_without_readings_is_reported_once(
    words: list[str], message: str, tsc: Tsc
) -> None:
    assert tsc("run", *words).gives(0).err == message
    for option in re.findall(r"(--sensor) (\S+)", message):  # every option in the message works
        assert (
            tsc("run", *words, *option).gives(0).err.count("--sensor")
            == message.count("--sensor") - 1
        )


def test_a_division_by_zero_is_reported_with_its_cause(tsc: Tsc) -> None:
    result = tsc("run", "-e", "SI|SHOW(1 / DISTANCE)").gives(1)
    assert result.err.startswith(
        "DISTANCE always read 0. To supply readings:  --sensor DISTANCE=50,9\nfault DIVIDE_BY_ZERO"
    )


@each_row("language, try_it", [("en", "Try"), ("es", "Prueba"), ("pt", "Tente")])
def test_an_option_of_another_verb_suggests_that_verb(language: str, try_it: str, tsc: Tsc) -> None:
    for verb, option, other_verb in (
        ("run", "--virtual", "upload"), ("run", "--hurry", "upload"), ("run", "--detach", "upload"),
        ("upload", "--max-steps", "run"), ("upload", "--show", "run"),
    ):  # fmt: skip
        result = tsc(verb, "prog.ts", option, "--lang", language).gives(2)
        assert f"{try_it}:  tsc {other_verb} prog.ts {option}" in result.err
    result = tsc("run", "prog.ts", "--virtul", "--lang", language).gives(2)
    assert "tsc run --help" in result.err


# -- a program for another robot ------------------------------------------------------------------


def test_robots_that_have_a_word_are_named(tsc: Tsc) -> None:
    result = tsc("check", *LINE)
    assert result.code == 1
    # The message names the program's first word.
    message = "tinibot has no BUTTON; the robot liner has it.\nTry:  "
    robot_lists = (
        "If your robot is not a liner, remove the parts that need BUTTON. If it is, write above"
    )
    assert f"{message}{robot_lists} the program: // robot: liner " in result.err
    assert "LINE_L = 0" not in result.err
    for verb in (["run"], ["compile", "-o", "-"], ["upload", "--virtual"], ["upload"]):
        assert "the robot liner has it" in tsc(*verb, *LINE).err, verb
    result = tsc("check", *LINE, "--lang", "es")
    assert "tinibot no tiene BUTTON; lo tiene el robot liner." in result.err
    assert "Si lo es, escribe encima del programa: // robot: liner " in result.err
    result = tsc("check", "-e", "LED(BUTTON)", "--json")
    (load,) = [load for load in json.loads(result.out) if load["column"] == 1]
    assert load["code"] == "TS119"
    assert load["message"] == "tinibot has no LED; the robots grabber and liner have it."
    assert load["fix"].endswith("If it is, write above the program: // robot: grabber")
    # If one robot has all the words, the others are not named.
    assert "// robot: liner " in tsc("check", "-e", "LED(LINE_L)").err
    assert "// robot: grabber " in tsc("check", "-e", "LED(DISTANCE > 5)").err
    # A word for it in another language.
    assert "tinibot has no GRIPPER; the robot grabber" in tsc("check", "-e", "PINZA(90)").err
    assert "// robot: liner " in tsc("check", "-e", "SHOW(BATERIA)").err
    # a name that no kit has
    assert "give it a value first: LINE_X = 5" in tsc("check", "-e", "F(LINE_X, 80)").err
    assert "give it a value first: LINE_X = 5" in tsc("check", "-e", "SHOW(LINE_X)").err
    assert tsc("live", "LED(TRUE)", "--virtual").err.count("TS119") == 1


def test_up_to_three_robots_are_named() -> None:
    kit = robots.load("liner").kit
    tinibot_kit = robots.load("tinibot").kit
    compilation = compile_text("LED(TRUE)", tinibot_kit)
    other_kits = {f"R{k}": kit for k in range(5)}
    (named_diagnostic,) = hints_among(
        other_kits, compilation.diagnostics, "LED(TRUE)", "tinibot", tinibot_kit
    )
    assert named_diagnostic.values == {
        "found": "LED", "own": "tinibot", "first": "R0", "second": "R1", "third": "R2",
    }  # fmt: skip


def test_the_kit_comes_from_the_robot_that_answers() -> None:
    with robot("--robot", "liner", "--world", "line") as running_robot:
        kit_note = "liner is connected; tsc compiles for it.\n"
        result = run_in_process("check", *LINE, "--virtual")
        assert (result.code, result.err) == (0, kit_note)
        result = run_in_process("upload", *LINE, "--port", running_robot.port, "--no-run")
        assert (result.code, result.err) == (0, kit_note)
        result = run_in_process("live", "SHOW(LINE_L)", "--lang", "es").gives(0)
        assert result.err == "El robot conectado: liner. tsc compila para él.\n"
        # a program of the default robot would be for another kit than the robot has
        run_in_process("upload", "-e", "SHOW(DISTANCE)").gives(1, "liner has no DISTANCE")
        # Programs that suit any robot print nothing, and slips do not suggest a robot.
        assert run_in_process("upload", "-e", "SI|S").err == ""
        assert "TS103" in run_in_process("upload", "-e", "SHOW(LIN)").err
        # A robot named by the user is used.
        run_in_process("upload", *LINE, "--robot", "grabber").gives(1, "grabber has no LINE_L")


def test_a_profile_from_an_earlier_command_is_remembered(tmp_path: Path) -> None:
    shipped_path = ROOT / "compiler" / "tiniscript" / "robots" / "tinibot.toml"
    profile = tmp_path / "own.toml"
    profile.write_text(shipped_path.read_text(encoding="utf-8").replace("LIGHT_R", "SIREN"))
    with robot("--robot", profile):
        text = "SI|SHOW(SIREN)"
        assert "TS103" in run_in_process("upload", "-e", text).err  # the word is unknown so far
        assert run_in_process("doctor", "--robot", profile).code == 0
        result = run_in_process("upload", "-e", text)
        assert (result.code, result.err) == (0, "own is connected; tsc compiles for it.\n")
    [(path, remembered_profile)] = given.profiles()
    assert path == str(profile)
    profile.write_text("")  # the profile has changed
    assert given.recall(remembered_profile.kit.fingerprint) is None
    given._path().write_text('[[1], 2, "x"]')
    assert given.profiles() == []


# -- the prompt -----------------------------------------------------------------------------------


def test_tsc_commands_typed_at_the_prompt_are_recognized() -> None:
    known_state = LiveState(robots.load("tinibot").kit)
    for line in ("exit", "QUIT", " Salir ", "exit;", "exit()", "quit ( ) ;"):
        assert requested_command(line, known_state) == LEAVE, line
    for line in ("help", "ayuda", "?", "HELP;"):
        assert requested_command(line, known_state) == HELP_ME, line
    for line in ("", "S", "EXIT = 5", "SHOW(EXIT)", "exit 5", "QUIT; S"):
        assert requested_command(line, known_state) == "", line
    known_state.text_by_def["EXIT"] = "DEF EXIT; S; END_DEF"
    assert requested_command("exit", known_state) == ""  # the name is the user's own variable


def test_a_variable_may_have_the_value_of_the_mark(capsys: pytest.CaptureFixture[str]) -> None:
    """The mark is the smallest number: `Y = -2147483.647 - 0.001`."""
    known_state = LiveState(robots.load("tinibot").kit)
    for use_count in (0, 1, 2):  # random numbers used before, by the program itself
        catch = ValueCatcher(("X", "Y"), known_state, EventPrinter("en"), prints_done=False)
        for value in (*[BOOKKEEPING_MARK] * use_count, BOOKKEEPING_MARK, BOOKKEEPING_MARK, 7):
            assert catch.hold_event(ShownEvent(value, 0))
        assert catch.hold_event(DoneEvent(1))
        assert {name: value.value for name, value in known_state.value_by_name.items()} == {
            "X": BOOKKEEPING_MARK,
            "Y": 7,
        }
        assert capsys.readouterr().out == "SHOW -2147483.648\n" * use_count
        known_state.value_by_name.clear()


def test_the_mark_of_live_reaches_nobody(capsys: pytest.CaptureFixture[str]) -> None:
    def show(value: int) -> ShownEvent:
        return ShownEvent(value, 0)

    known_state = LiveState(robots.load("tinibot").kit)
    for end in ("STOPPED", "DONE"):
        catch = ValueCatcher(("X", "Y"), known_state, EventPrinter("en"), prints_done=False)
        assert not catch.hold_event(show(7))
        events: list[Event] = [show(BOOKKEEPING_MARK), show(5000), MissedEvent(1)]
        assert [catch.hold_event(event) for event in events] == [True, True, False]
        catch.hold_event(event(end))
        assert capsys.readouterr().out == ""
    # Values shown by the program are printed.
    catch = ValueCatcher(("X",), known_state, EventPrinter("en"), prints_done=False)
    for shown_event in (show(BOOKKEEPING_MARK), show(BOOKKEEPING_MARK), show(5000), DoneEvent(1)):
        catch.hold_event(shown_event)
    assert capsys.readouterr().out == "SHOW -2147483.648\n"
    assert known_state.value_by_name["X"].value == 5000
    # nor the picture or the lines of a virtual robot
    bookkeeping = Bookkeeping()
    hidden = [
        bookkeeping.filter_trace_event(event_name, values)
        for event_name, values in (
            ("START", ()), ("SHOW", (1,)), ("SHOW", (BOOKKEEPING_MARK,)), ("SHOW", (5000,)),
            ("MOTORS", (0, 0)), ("DONE", ()), ("START", ()), ("SHOW", (5000,)),
        )
    ]  # fmt: skip
    assert hidden == [False, False, True, True, False, False, False, False]


@pytest.mark.parametrize("seed", range(5))
def test_values_are_hidden_from_the_mark_to_the_end_of_their_run_alone(seed: int) -> None:
    """This holds for any number of runs, however each begins and ends: nobody may hear its end."""
    rng, bookkeeping, traced, is_hidden = Random(seed), Bookkeeping(), Bookkeeping(), False
    boundaries = {"STARTED": "START", "DONE": "DONE", "FAULT": "FAULT", "STOPPED": "STOP",
                  "RESTARTED": "OFF"}  # fmt: skip
    for _ in range(200):
        if rng.random() < 0.2:
            name = rng.choice([*boundaries])
            is_hidden = False
            boundary = RestartedEvent() if name == "RESTARTED" else event(name)
            assert not bookkeeping.filter_event(boundary)
            assert not traced.filter_trace_event(boundaries[name], ())
            continue
        value, is_yes_no = rng.choice((BOOKKEEPING_MARK, 5, 1)), rng.random() < 0.3
        is_hidden = is_hidden or (value == BOOKKEEPING_MARK and not is_yes_no)
        assert bookkeeping.filter_event(ShownEvent(value, is_yes_no)) == is_hidden
        if not is_yes_no:
            assert traced.filter_trace_event("SHOW", (value,)) == is_hidden
        assert not bookkeeping.filter_event(MissedEvent(1))


# -- slips with names -----------------------------------------------------------------------------


def test_help_is_also_a_verb(tsc: Tsc) -> None:
    assert tsc("help", "upload").out == tsc("upload", "--help").out
    assert tsc("--lang", "es", "ayuda", "run").out == tsc("run", "--help", "--lang", "es").out
    assert tsc("--lang", "pt", "ajuda", "run").out == tsc("run", "--help", "--lang", "pt").out
    assert "¿Quisiste decir lesson?" in tsc("leccion", "--lang", "es").err
    assert "Você quis dizer firmware?" in tsc("gravar", "--lang", "pt").err
    assert "tsc upload" in tsc("help", "como enviar", "--lang", "pt").out
    assert tsc("help", "--lang", "es").out == tsc("--help", "--lang", "es").out
    assert tsc("help").out == tsc("--help").out
    tsc("help", "uplod").gives(2, "Did you mean upload?")


def test_a_program_without_a_verb_suggests_one(tsc: Tsc, tmp_path: Path) -> None:
    tsc("prog.ts").gives(2, "tsc upload prog.ts --virtual   or:  tsc run prog.ts")
    assert "¿qué hago con prog.ts?" in tsc("prog.ts", "--lang", "es").err
    named_path = tmp_path / "my robot"
    named_path.write_text("S")
    assert f'tsc run "{named_path}"' in tsc(named_path).err
    tsc("SI|F(2, 80)").gives(2, 'tsc live "SI|F(2, 80)"')
    assert "there is no command nix" in tsc("nix").err
    assert tsc("x" * 5000).code == 2


@each_row("real_call, expected", [
    ("prog.ts.txt", "prog.ts"), ("prog.ts", "prog"), ("prog.ts.txt", "prog"), ("prog.tini", "prog"),
    ("prog.tini.txt", "prog.tini"),
])  # fmt: skip
def test_a_file_is_found_by_the_name_that_a_folder_shows(
    tsc: Tsc, tmp_path: Path, real_call: str, expected: str
) -> None:
    folder = tmp_path / f"{real_call} as {expected}"
    folder.mkdir()
    path = folder / real_call
    path.write_text("SI|F(1, 80)")
    result = tsc("check", folder / expected).gives(0)
    assert result.out == f"{path}: no mistakes.\n"
    assert f"tsc uses {path} instead" in result.err
    assert tsc("compile", folder / expected).code == 0
    assert (folder / "prog.bin").exists()
    assert "su nombre completo" in tsc("run", folder / expected, "--lang", "es").err
    (folder / expected).write_text("SI|S")
    assert tsc("check", folder / expected).err == ""


@pytest.mark.parametrize("options", [(), ("--port", "P"), ("--build",), ("--robot", "liner")])
@pytest.mark.parametrize("chip", ["nano", "MEGA"])
def test_a_chip_instead_of_a_robot_suggests_its_option(
    tsc: Tsc, chip: str, options: tuple[str, ...]
) -> None:
    for words in (("--board", chip, *options), (*options, f"--board={chip}")):
        tsc("firmware", *words).gives(2, f"Try:  tsc firmware --chip {chip.lower()}\n")


def test_board_names_the_folder_of_the_build(
    tsc: Tsc, working_folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    home = working_folder / "vm_arduino" / "src" / "boards" / "kits"
    home.mkdir(parents=True)
    (working_folder / "vm_arduino" / "platformio.ini").touch()
    result = tsc("firmware", "--board", "liner", "-o", "own.h")
    home_of_it = "vm_arduino/src/boards/kits/own.h"
    build_hint = "Then:  pio run -d vm_arduino -e"
    assert f"tsc firmware --board liner -o {home_of_it}   {build_hint}" in result.out
    assert "Ponlo ahí:" in tsc("firmware", "--board", "liner", "-o", "own.h", "--lang", "es").out
    result = tsc("firmware", "--board", "liner", "-o", "vm_arduino/src/boards/kits/own.h")
    assert result.out.endswith("To build the firmware:  pio run -d vm_arduino -e nano\n")
    monkeypatch.chdir(home)
    sources_folder = str(Path("../../.."))
    assert tsc("firmware", "--board", "liner", "-o", "own.h").out.endswith(
        f"To build the firmware:  pio run -d {sources_folder} -e nano\n"
    )


def test_the_first_program_has_no_warning(tsc: Tsc) -> None:
    """The first command of README, and the program at its start."""
    assert tsc("check", ROOT / PROGRAM).gives(0, out="no mistakes").err == ""
    for path in sorted(ROOT.glob("README*.md")):
        program = path.read_text(encoding="utf-8")
        first_program = program.partition("```tiniscript\n")[2].partition("```")[0]
        assert tsc("check", "-e", first_program).gives(0, out="no mistakes").err == "", path
        assert f"`{PROGRAM.as_posix()}`" in program, path


def test_programs_with_warnings_report_them(tsc: Tsc) -> None:
    for path in sorted((ROOT / "examples").glob("*.ts")):
        err = tsc("check", path).gives(0, out="no mistakes").err
        assert err.count("Warning") == ("tsc warns" in path.read_text(encoding="utf-8")), path


if sys.platform == "win32":  # Windows cannot send Ctrl-C to one process
    pytestmark = pytest.mark.skip(reason="Windows sends no signal to one process")
