"""`tsc robot` and `--virtual`: real processes, real sockets, the whole firmware."""

from __future__ import annotations

import ctypes
import json
import re
import signal
import socket
import sys
from io import BytesIO
from pathlib import Path
from typing import Any

import pytest

from tests.support.command import OBSTACLE, Command, Tsc, run_in_process
from tests.support.virtual_command import FOREVER, Robot, robot, visitor
from tiniscript.cli.terminal.signals import handle_signals
from tiniscript.library import install_advice
from tiniscript.link import ports
from tiniscript.virtual import directory

# -- a robot with a port --------------------------------------------------------------------------


def test_another_terminal_finds_the_virtual_robot_and_its_actions_are_printed(
    tmp_path: Path,
) -> None:
    picture = tmp_path / "way.png"
    with robot("--name", "KAT", "--world", "light", "--plot", picture) as running_robot:
        assert running_robot.port.startswith("socket://127.0.0.1:")
        port_rows = json.loads(run_in_process("doctor", "--ports", "--json").out)
        [row] = [row for row in port_rows if row["port"] == running_robot.port]
        assert row["is_virtual"]
        assert row["description"] == 'KAT: virtual robot tinibot, world "lamps in the dark"'
        in_spanish = 'KAT: robot virtual tinibot, mundo "lámparas en la oscuridad"'
        assert (
            f"{running_robot.port}   {in_spanish}"
            in run_in_process("doctor", "--ports", "--lang", "es").out
        )
        result = run_in_process(
            "upload", "--virtual", "-e", "SI|F(0.2, 50);SHOW(1.5);BEEP(0.1, 440)"
        )
        assert (result.code, result.err) == (0, "")
        receipt, *rest = result.out.splitlines()
        assert receipt.startswith(f"-e -> KAT ({running_robot.port})")
        assert rest == ["SHOW 1.5", "Done.", "Saved. The button starts it."]
        # a value is shown when there is room for it on the line
        lines = [
            re.sub(r"^\d+ (SHOW|BEEP|DONE)", r"\1", line) for line in running_robot.until("DONE")
        ]
        assert lines == ["0 START", "0 MOTORS 50 50", "200 MOTORS 0 0", "SHOW 1.5", "BEEP 440 100",
                         "DONE"]  # fmt: skip
        # Silent virtual robots are found too, but are not remembered.
        assert run_in_process("start").out.startswith("KAT: started")
        assert (
            json.loads(run_in_process("doctor", "--virtual", "--json").out)["robot"]["name"]
            == "KAT"
        )
        for _ in range(3):
            assert run_in_process("stop", "--virtual").code == 0
        running_robot.end().gives(0, "The virtual robot drove 9 cm")
    assert picture.read_bytes().startswith(b"\x89PNG")
    assert directory.running_robots() == []
    run_in_process("start").gives(3, "which port?")


@pytest.mark.parametrize("hurry", ["1", "50"])
def test_a_computer_that_vanishes_stops_the_robot(hurry: str) -> None:
    with robot("--hurry", hurry) as running_robot:
        upload = Command("upload", "--port", running_robot.port, "-e", FOREVER)
        running_robot.until("0 MOTORS -30 30")
        upload.kill()
        line = "MOTORS"
        while "MOTORS" in line:
            line = running_robot.line()
        assert line.endswith(" FAULT LINK_LOST")


def test_ctrl_c_works_at_any_moment(monkeypatch: pytest.MonkeyPatch) -> None:
    """The firmware calls Python from C, where an exception is dropped."""
    dropped: list[object] = []
    monkeypatch.setattr(sys, "unraisablehook", dropped.append)

    interrupt = ctypes.CFUNCTYPE(None)(lambda: signal.raise_signal(signal.SIGINT))

    with handle_signals() as ended_end_request:
        interrupt()
    # A stopped simulator prints no Python traceback.
    assert not dropped and ended_end_request.is_set
    sys.unraisablehook(None)  # type: ignore[arg-type]
    assert len(dropped) == 1  # other hooks still run


def test_a_second_computer_is_refused_because_the_port_is_in_use() -> None:
    """Unfinished text of one client is not part of the next client's."""
    with robot() as running_robot:
        with visitor(running_robot.port) as first:
            first.sendall(b"SHOW(1)\n")
            assert first.recv(1000)  # the client is answered
            result = run_in_process("doctor", "--identify", "--port", running_robot.port)
            assert result.code == 3
            assert f"another program is using the port {running_robot.port}" in result.err
            with visitor(running_robot.port) as third_client:
                assert third_client.recv(1000).startswith(b"Port already in use")
                assert third_client.recv(1000) == b""
            first.sendall(b"\x05half a frame")
        run_in_process("upload", "--port", running_robot.port, "-e", "SI|F(0.1, 50)").gives(0, "")


def test_the_memory_of_a_virtual_robot_may_be_a_file(tmp_path: Path) -> None:
    """The button starts it at the same millisecond, so with the same seed all is the same."""
    memory = tmp_path / "kept.bin"
    text = OBSTACLE.replace("SI|", "SB|")
    with robot("--memory", memory) as running_robot:
        assert run_in_process("upload", "--virtual", "-e", text).code == 0
        assert run_in_process("set", "name", "INTI", "--virtual").code == 0
        running_robot.end(signal.SIGTERM)
    assert len(memory.read_bytes()) == 1024
    options = ("--button-at", "1", "--for", "20", "--hurry", "max", "--noise", "5", "--lang", "es")
    first, second, other_result = (
        run_in_process("robot", "--memory", memory, *options, "--seed", seed) for seed in "112"
    )
    assert first.code == 0
    assert first.out.count("READ DISTANCE") > 10
    assert (
        first.out.splitlines()[1:]
        == second.out.splitlines()[1:]
        != other_result.out.splitlines()[1:]
    )
    found_cm = re.search(r"El robot virtual recorrió (\d+) cm en 20.0 s", first.err)
    assert found_cm and int(found_cm[1]) > 50, "what it drives when its time is over counts"
    with robot("--memory", memory):
        assert (
            json.loads(run_in_process("doctor", "--virtual", "--json").out)["robot"]["name"]
            == "INTI"
        )


@pytest.mark.parametrize(
    ("name", "size"), [("tinibot", 1024), ("tinibot2", 1024), ("tinibot32", 16_640)]
)
def test_each_robot_reads_its_own_memory_file(name: str, size: int, tmp_path: Path) -> None:
    """A robot refuses the memory of another kind."""
    memory = tmp_path / "kept.bin"
    options = ("--robot", name, "--memory", memory, "--for", "3", "--hurry", "max")
    run_in_process("robot", *options, "--name", "INTI").gives(0)
    assert len(memory.read_bytes()) == size
    run_in_process("robot", *options).gives(0)
    assert b"INTI" in memory.read_bytes()
    for wrong_size in (size + 1, size - 1, 0):
        memory.write_bytes(bytes(wrong_size))
        run_in_process("robot", *options).gives(2, f"which has {size} bytes")
        assert len(memory.read_bytes()) == wrong_size


def test_a_pseudo_terminal_is_also_a_port() -> None:
    with robot("--pty") as running_robot:
        port = running_robot.line()
        assert port.startswith("/dev/")
        assert run_in_process("upload", "--port", port, "-e", "SI|F(0.1, 50)").code == 0
        assert running_robot.until("100 DONE")


def test_a_stale_registration_is_not_trusted() -> None:
    running_robot = Robot()
    assert len(directory.running_robots()) == 1
    running_robot.kill()
    [note] = directory._folder().glob("*.json")
    assert directory.running_robots() == []
    assert not note.exists()
    for text in ("", "[]", "{}", '{"address": 5}', "[" * 10_000):
        note.write_text(text, encoding="utf-8")
        assert directory.running_robots() == []
    assert run_in_process("stop", "--virtual").code == 3


def test_among_several_robots_one_must_be_named(tsc: Tsc, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ports, "list_ports", list)
    with robot() as first, robot("--world", "line") as second:
        result = tsc("doctor", "--identify", "--virtual").gives(3, second.port)
        asked_result = tsc("doctor", "--identify")  # without --virtual and without a terminal
        assert (asked_result.code, asked_result.err) == (3, result.err)
        places = sorted([(first.port, "obstacles"), (second.port, "a line to follow")])
        with monkeypatch.context() as person:
            person.setattr("sys.stdin.isatty", lambda: True)
            person.setattr("sys.stdin.readline", lambda: "2\n")
            person.setattr("sys.stderr.isatty", lambda: True)
            result = tsc("doctor", "--identify")
        assert result.code == 0
        for number, (port, world) in enumerate(places, 1):
            assert f'  {number}  {port}   virtual robot tinibot, world "{world}"\n' in result.err
        assert places[1][0] in result.out
        assert tsc("doctor", "--port", second.port).code == 0


# -- a robot for one command ----------------------------------------------------------------------


def colours(data: bytes) -> dict[str, int]:
    """Return the number of pixels near each named colour of a picture."""
    from PIL import Image

    from tiniscript.virtual import picture

    with Image.open(BytesIO(data)) as image:
        assert image.format == "PNG"
        assert image.size == (1200, 1143)  # the floor, 220 cm x 200 cm, its margins and the foot
        pixels: Any = image.convert("RGB").getcolors(image.width * image.height)
    colors = {}
    for name, colour in (
        ("way", picture.WAY_COLOUR),
        ("box", picture.BOX_COLOUR),
        ("robot", picture.ROBOT_COLOUR),
    ):
        expected_bytes = bytes.fromhex(colour[1:])
        colors[name] = sum(  # the borders of lines are mixed
            count for count, pixel in pixels
            if max(abs(a - b) for a, b in zip(pixel, expected_bytes, strict=True)) < 70
        )  # fmt: skip
    return colors


def test_upload_drives_a_virtual_robot_and_draws_its_way(tmp_path: Path) -> None:
    still_picture, way_picture = tmp_path / "still.png", tmp_path / "way.png"
    run_in_process("upload", "--virtual", "-e", "SI|S", "--plot", still_picture).gives(0)
    result = run_in_process("upload", "--virtual", "-e", OBSTACLE, "--for", "30", "--hurry", "100",
                            "--plot", way_picture)  # fmt: skip
    assert result.code == 0
    assert "The time set with --for is over.\nSaved. The button starts it.\n" in result.out
    assert f"and touched nothing. Picture: {way_picture}\n" in result.out
    colours_before, colours_after = (
        colours(still_picture.read_bytes()),
        colours(way_picture.read_bytes()),
    )
    assert colours_before["way"] < 20 < 4000 < colours_after["way"]
    assert colours_before["robot"] > 200
    assert colours_before["box"] > 10_000
    assert directory.running_robots() == []


def test_an_accelerated_robot_is_not_lost_and_a_bad_line_only_costs_time() -> None:
    text = "SI|LOOP(20);F(1, 50);B(1, 50);END_LOOP;SHOW(TIME)"
    result = run_in_process("upload", "--virtual", "-e", text, "--hurry", "max", "--faults", "3")
    assert result.code == 0  # text that a radio inserts is printed too
    assert result.out.splitlines()[1:3] in (
        ["TIME 40", "Done."],
        ["Done.", "Saved. The button starts it."],
    )


@pytest.mark.parametrize("start", ["SI", "SB"])
@pytest.mark.parametrize(("text", "code"), [("SHOW(1)", 0), ("X = 0;SHOW(1 / X)", 1)])
def test_the_exit_code_is_that_of_the_run_however_it_was_started(
    start: str, text: str, code: int
) -> None:
    result = run_in_process("upload", "--virtual", "-e", f"{start}|{text}", "--hurry", "max").gives(
        code
    )
    assert "Saved." in result.out


def test_upload_and_live_print_the_same_as_for_any_robot() -> None:
    result = run_in_process(
        "upload", "--virtual", "-e", "SI|X = 0;SHOW(1 / X)", "--json", "--seed", "7"
    )
    assert result.code == 1
    events = [json.loads(line)["event"] for line in result.out.splitlines()]
    assert events == ["RECEIPT", "FAULT", "SAVED"]
    assert "The virtual robot drove 0 cm" in result.err
    result = run_in_process("live", "--virtual", "F(0.1, 80);SHOW(BATTERY)", "--robot", "liner",
                            "--sensor", "BATTERY=7.4").gives(0)  # fmt: skip
    assert result.out.startswith("BATTERY 7.4\nDone.\nThe virtual robot drove 5 cm")


def test_ctrl_c_stops_the_virtual_robot_and_draws_its_path_so_far(tmp_path: Path) -> None:
    picture = tmp_path / "way.png"
    text = "SI|LOOP(FOREVER);F(0.1, 30);SHOW(1);END_LOOP"
    command = Command("upload", "--virtual", "-e", text, "--plot", str(picture))
    command.until("SI: running")
    command.until("SHOW 1")
    command.signal(signal.SIGINT)
    command.wait_for_result().gives(
        2, "Stopped: the robot has confirmed the stop.", out=str(picture)
    )
    assert picture.read_bytes().startswith(b"\x89PNG")


def test_every_verb_that_asks_a_robot_knows_the_virtual_one() -> None:
    """The one of `tsc robot`; without one they say how to have one."""
    for command in ("doctor", "doctor --selftest", "set trim", "monitor"):
        result = run_in_process(*command.split(), "--virtual")
        assert result.code == 3, command
        assert "Start one in another terminal:  tsc robot" in result.err, command
        assert "--virtual" in run_in_process(*command.split(), "--help").out, command
    assert "Without a robot:  --virtual" in run_in_process("upload", "-e", "SI|S").err
    with robot() as running_robot:
        for words in ((), ("--virtual",), ("--identify", "--virtual")):
            run_in_process("doctor", *words).gives(0, out=running_robot.port)
        run_in_process("doctor", "--virtual", "--port", running_robot.port).gives(2, "--virtual")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["robot", "--listen", "70000"], "--listen takes a whole number from 0 to 65535"),
        (["robot", "--noise", "51"], "--noise takes a number from 0 to 50, not 51"),
        (["robot", "--faults", "-1"], "--faults takes a number from 0 to 200"),
        (
            ["robot", "--hurry", "fast"],
            "--hurry takes a number (how many times as fast the robot runs",
        ),
        (["robot", "--hurry", "0"], "--hurry takes a number from 0.1 to 10000, not 0"),
        (["robot", "--motors", "100"], "--motors takes two numbers"),
        (["robot", "--motors", "100,1"], "--motors takes a number from 10 to 200, not 1"),
        (["robot", "--for", "0"], "--for takes a number from 0.1"),
        (["robot", "--seed", "0"], "--seed takes a whole number from 1"),
        (["robot", "--button-at", "2,x"], "--button-at takes seconds"),
        (["robot", "--name", "a" * 17], "a name has 1 to 16 bytes"),
        (["robot", "--plot", "no/such/folder/way.png"], "Choose another place with --plot"),
        (["robot", "--plot", ""], "Choose another place with --plot"),
        (["robot", "--memory", "."], "Choose another place with --memory"),
        (["robot", "--sensor", "EYES=1"], "has no sensor EYES"),
        (["robot", "--robot", "r2d2"], "There is no robot r2d2"),
        (["upload", "-e", "SI|S", "--world", "line"], "--world works only with the virtual robot"),
        (["live", "S", "--port", "COM1", "--virtual"], "--virtual cannot be combined"),
    ],
)
def test_wrong_options_are_reported(tsc: Tsc, arguments: list[str], message: str) -> None:
    tsc(*arguments).gives(2, message)
    spanish = tsc(*arguments, "--lang", "es").gives(2)
    assert message not in spanish.err or message.startswith("There")


def test_a_port_in_use_and_an_invalid_memory_are_refused(tsc: Tsc, tmp_path: Path) -> None:
    with socket.create_server(("127.0.0.1", 0)) as server_socket:
        result = tsc("robot", "--listen", str(server_socket.getsockname()[1]))
    assert result.code == 3
    assert "Choose another port with --listen" in result.err
    small_file = tmp_path / "small.bin"
    small_file.write_bytes(b"TS")
    tsc("robot", "--memory", small_file).gives(2, "which has 1024 bytes")


@pytest.mark.parametrize(("name", "commands"), [
    ("wasmtime", ["upload --virtual -e SI|S", "robot --for 1", "lesson check 1 -e SI|S"]),
    ("PIL", ["upload --virtual -e SI|S --plot way.png"]),
])  # fmt: skip
def test_missing_packages_are_reported(name: str, commands: list[str]) -> None:
    code = (
        f"import sys; sys.modules[{name!r}] = None; from tiniscript.cli import main;"
        "sys.exit(str([main(each.split()) for each in sys.argv[1:]]))"
    )
    result = Command(*commands, code=code).wait_for_result()
    assert result.err.endswith(f"{[2] * len(commands)}\n")
    assert result.err.count(install_advice.command("virtual")) == len(commands)
