"""`tsc upload`, the programs that a robot keeps, `tsc start --previous`: on the whole firmware."""

from __future__ import annotations

import json
import signal
from pathlib import Path

import pytest

from tests.support.command import LONG_PROGRAM, OBSTACLE, Command, CommandResult, run_in_process
from tests.support.pty_robot import PtyRobot, on, start_endless_upload
from tests.support.terminal import Terminal
from tiniscript import compile_text, robots
from tiniscript.cli.commands import start_previous
from tiniscript.cli.errors import CommandError

KIT = robots.load("tinibot").kit


def test_upload_runs_the_program_and_stays_until_it_ends(
    pty_robot: PtyRobot, tmp_path: Path
) -> None:
    program = tmp_path / "drive.ts"
    program.write_text("SI|F(0.2, 80)\nSHOW(DISTANCE + 1.5); SHOW(TRUE)\n", encoding="utf-8")
    pty_robot.ask(lambda robot: robot.set_readings(0, 0, 42_000))
    result = on(pty_robot, "upload", program).gives(0, "")
    receipt, *rest = result.out.splitlines()
    assert receipt == f"{program} -> tinibot ({pty_robot.port})   SI: running"
    assert rest == [
        "DISTANCE + 1.5 43.5",
        "SHOW TRUE",
        "Done.",
        "Saved. The button starts it.",
    ]
    assert pty_robot.actions == ["MOTORS 80 80", "MOTORS 0 0", "FINISHED"]


def test_slots_and_checksums_are_printed_on_request(pty_robot: PtyRobot) -> None:
    image = compile_text("SI|S", KIT).image
    checksum = f"{int.from_bytes(image[10:14], 'little'):08x}"
    result = on(pty_robot, "upload", "-e", "SI|S", "--verbose").gives(0, "")
    receipt, _, last_line = result.out.splitlines()
    assert receipt.startswith(f"-e -> tinibot ({pty_robot.port})   {len(image)} bytes")
    assert receipt.endswith(f"checksum {checksum}   saving   SI: running")
    assert last_line == "Saved in slot 0."
    result = on(pty_robot, "upload", "-e", "SI|S", "--json").gives(0, "")
    rows = [json.loads(line) for line in result.out.splitlines()]
    assert (rows[0]["checksum"], rows[0]["code_bytes"]) == (checksum, 1)
    assert {row["slot"] for row in rows if row.get("slot") is not None} == {0}
    # The warning about losing the program without power is always printed.
    result = on(pty_robot, "upload", "-e", "SI|S;S", "--no-save")
    assert result.out.splitlines()[0].endswith("   only in RAM   SI: running")


def test_a_program_continues_without_tsc(pty_robot: PtyRobot) -> None:
    result = on(pty_robot, "upload", "-e", OBSTACLE, "--detach")
    assert result.code == 0 and result.out.endswith("SI: running without tsc\n")
    pty_robot.ask(lambda robot: robot.wait(7000))
    assert pty_robot.actions[:3] == ["MOTORS 80 80", "MOTORS 0 0", "MOTORS 60 -60"]


def test_a_program_that_waits_ends_with_its_receipt(pty_robot: PtyRobot) -> None:
    result = on(pty_robot, "upload", "-e", "SB|F(0.1, 80)")
    assert (result.code, pty_robot.actions) == (0, [])
    assert "SB: waiting for the button or tsc start\nSaved." in result.out
    pty_robot.push()
    pty_robot.until(lambda: "FINISHED" in pty_robot.actions, "the button starts it")
    result = on(pty_robot, "start").gives(0)
    assert result.out.endswith("Done.\n")
    assert pty_robot.actions.count("FINISHED") == 2


def test_a_longer_program_goes_in_pieces_and_comes_back(
    pty_robot: PtyRobot, tmp_path: Path
) -> None:
    """Noise on the line costs only time."""
    compiled_file, robot_file = tmp_path / "ours.bin", tmp_path / "theirs.bin"
    compiled_file.write_bytes(compile_text(LONG_PROGRAM, KIT).image)
    for damages in (0, 211):
        pty_robot.damages = damages
        result = on(pty_robot, "upload", compiled_file, "--no-run", "--no-save")
        assert (result.code, pty_robot.actions) == (0, [])
        assert "only in RAM   SI: waiting" in result.out
        assert on(pty_robot, "show", "-o", robot_file).code == 0
        assert robot_file.read_bytes() == compiled_file.read_bytes(), damages
        fields = json.loads(on(pty_robot, "doctor", "--json").out)["robot"]
        assert bool(fields["damaged"]) == bool(damages)
    listing = on(pty_robot, "show").out
    assert listing.split("\n", 1)[1] == run_in_process("show", compiled_file).out.split("\n", 1)[1]


def test_the_receipt_is_available_as_json(pty_robot: PtyRobot) -> None:
    text = "SI|SHOW(0.5);SHOW(2);SHOW(FALSE);X = 0;SHOW(1 / X)"
    result = on(pty_robot, "upload", "-e", text, "--json").gives(1)
    lines = [json.loads(line) for line in result.out.splitlines()]
    kinds = [line["event"] for line in lines]
    assert kinds == ["RECEIPT", "SHOW", "SHOW", "SHOW", "FAULT", "SAVED"]
    assert [line["value"] for line in lines[1:4]] == [0.5, 2, False]
    assert (lines[0]["start"], lines[0]["is_running"], lines[0]["saved"]) == ("SI", True, "SAVING")
    assert lines[0]["is_pushed"] is False
    assert (lines[4]["fault"], lines[4]["line"]) == ("DIVIDE_BY_ZERO", 1)


def test_a_fault_names_its_line(pty_robot: PtyRobot, tmp_path: Path) -> None:
    program = tmp_path / "divide.ts"
    program.write_text("SI|F(0.1, 50)\nX = 0\nSHOW(1 / X)\n", encoding="utf-8")
    on(pty_robot, "upload", program, "--lang", "es").gives(
        1, "falla DIVIDE_BY_ZERO", "línea 3:  SHOW(1 / X)"
    )
    assert not pty_robot.moves
    result = on(pty_robot, "doctor")  # the text is in the cache
    assert "divide.ts, line 3:  SHOW(1 / X)" in result.out
    assert on(pty_robot, "start").code == 1


def test_a_program_with_mistakes_is_not_sent(pty_robot: PtyRobot) -> None:
    on(pty_robot, "upload", "-e", "F(2 80)").gives(1, "TS017")
    assert pty_robot.received == b""


def test_a_program_that_does_not_fit_is_refused_with_sizes(
    pty_robot: PtyRobot, tmp_path: Path
) -> None:
    target = tmp_path / "a.bin"
    target.write_bytes(compile_text("SHOW(TIME * 1.234);" * 90, robots.load("grabber").kit).image)
    result = on(pty_robot, "upload", target)
    assert result.code == 1
    assert "540 bytes of code, 151 more than the robot has room for (389)" in result.err
    on(pty_robot, "upload", "-e", "SHOW(LINE_L)", "--robot", "liner").gives(3, "--robot tinibot")
    on(pty_robot, "start").gives(3, "tsc upload")


def test_a_long_way_has_a_bar_that_is_gone_at_the_end() -> None:
    with PtyRobot(KIT, bytes_per_ms=1) as pty_robot:
        words = ("upload", "-e", LONG_PROGRAM, "--no-run", "--no-save", "--port", pty_robot.port)
        terminal = Terminal(*words, size=(200, 5), types=False)
        assert terminal.end() == 0
    assert b"sending [" in terminal.output_bytes
    assert terminal.lines()[0].startswith("-e -> tinibot")
    assert "sending" not in "".join(terminal.lines())


@pytest.mark.parametrize("is_many", [False, True])
def test_a_reset_during_a_run_is_not_success(pty_robot: PtyRobot, is_many: bool) -> None:
    """After a power cycle, a program has not ended by itself, however it was started."""
    more_options = ("--port", "/dev/none") if is_many else ()
    command = Command("upload", "-e", "SI|F(200, 80)", "--port", pty_robot.port, *more_options)
    pty_robot.until(lambda: pty_robot.moves, "it drives")
    pty_robot.power_cycle()
    result = command.wait_for_result()
    assert result.code == 3 and "Done." not in result.out + result.err
    assert "restarted, which ended its program" in result.out + result.err, result


# -- stored programs, and failures to store them ---------------------------------------------------

WAITING_PROGRAM = "SI|LOOP(FOREVER);W(1);END_LOOP"


def interrupt(command: Command) -> CommandResult:
    command.signal(signal.SIGINT)
    return command.wait_for_result()


def test_saving_is_reported_while_a_program_without_moves_runs(pty_robot: PtyRobot) -> None:
    command = Command("upload", "-e", WAITING_PROGRAM, "--port", pty_robot.port)
    command.until("Saved. The button starts it.")
    pty_robot.power_cycle()
    command.kill()
    assert json.loads(on(pty_robot, "doctor", "--json").out)["robot"]["saved"] == "STORED"


def test_after_ctrl_c_the_save_is_reported(pty_robot: PtyRobot) -> None:
    interrupt(start_endless_upload(pty_robot)).gives(
        2, "the robot has confirmed the stop", out="Saved. The button starts it."
    )
    pty_robot.power_cycle()
    assert json.loads(on(pty_robot, "doctor", "--json").out)["robot"]["saved"] == "STORED"


def test_while_driving_a_name_and_a_trim_are_reported_as_saved_later(pty_robot: PtyRobot) -> None:
    command = start_endless_upload(pty_robot)
    naming, trimming = ("set", "name", "ANA"), ("set", "trim", "--balance", "5")
    for words in (naming, trimming):
        result = on(pty_robot, *words)
        assert result.code == 3 and not result.out, words
        assert "will save it as soon as its motors have stopped" in result.err
    assert "lo guarda en" in on(pty_robot, *naming, "--lang", "es").err
    assert pty_robot.moves, "nothing has stopped it"
    interrupt(command)
    for words in (naming, trimming):
        assert on(pty_robot, *words).code == 0, words
    pty_robot.power_cycle()
    assert json.loads(on(pty_robot, "doctor", "--json").out)["robot"]["name"] == "ANA"


def test_weak_batteries_are_reported(pty_robot: PtyRobot) -> None:
    pty_robot.ask(lambda robot: robot.set_supply(is_low=True))
    result = on(pty_robot, "upload", "-e", "SI|SHOW(6)", "--no-save")
    assert result.code == 0 and "batter" not in result.err + result.out, "nothing is to be saved"
    result = on(pty_robot, "upload", "-e", "SI|SHOW(7)")
    assert "SHOW 7" in result.out, "it runs all the same"
    assert result.code == 3 and "Change the batteries and send the program again" in result.err
    result = on(pty_robot, "upload", "-e", "SB|SHOW(8)", "--lang", "es")
    assert result.code == 3 and "Cambia las pilas y envíalo otra vez" in result.err
    assert "RAM: the robot's batteries are too weak to save it" in on(pty_robot, "doctor").out
    fields = json.loads(on(pty_robot, "doctor", "--json").out)["robot"]
    assert (fields["saved"], fields["slot"]) == ("LOW_SUPPLY", None)
    for words in (("set", "name", "ANA"), ("set", "trim", "--balance", "5")):
        on(pty_robot, *words).gives(3, "Change the batteries")
        assert "Cambia las pilas" in on(pty_robot, *words, "--lang", "es").err
    pty_robot.ask(lambda robot: robot.set_supply(is_low=False))
    assert on(pty_robot, "set", "name", "ANA").code == 0
    assert json.loads(on(pty_robot, "doctor", "--json").out)["robot"]["saved"] == "STORED"


def test_a_recovered_supply_saves_the_running_program(pty_robot: PtyRobot) -> None:
    """Somebody plugs the USB cable in."""
    pty_robot.ask(lambda robot: robot.set_supply(is_low=True))
    command = Command("upload", "-e", WAITING_PROGRAM, "--port", pty_robot.port, "--json")
    command.until('"saved": "LOW_SUPPLY"')
    pty_robot.ask(lambda robot: robot.set_supply(is_low=False))
    command.until('"event": "SAVED"')
    assert interrupt(command).code == 2


# -- the program before comes back, or cannot -----------------------------------------------------

FIRST_PROGRAM, SECOND_PROGRAM = "SB|F(0.1, 50)", "SB|F(0.1, 60)"


def upload_two(pty_robot: PtyRobot) -> list[str]:
    """Send two programs; return their checksums."""
    results = [
        on(pty_robot, "upload", "--json", "-e", text) for text in (FIRST_PROGRAM, SECOND_PROGRAM)
    ]
    assert [result.code for result in results] == [0, 0]
    return [json.loads(result.out.splitlines()[0])["checksum"] for result in results]


def test_undo_reports_the_restored_program_and_its_save(pty_robot: PtyRobot) -> None:
    """The JSON form is a receipt."""
    first_checksum, second_checksum = upload_two(pty_robot)
    for language, checksum, expected, saved_text in (
        ("en", first_checksum, "it has the previous program again, checksum", "Saved. The button"),
        ("es", second_checksum, "vuelve a tener el programa anterior, suma", "Guardado. Empieza"),
    ):
        result = on(pty_robot, "start", "--previous", "--lang", language).gives(0, "")
        lines = result.out.splitlines()
        assert f"{expected} {checksum}" in lines[0] and "tsc start --previous" in lines[0]
        assert len(lines) == 2 and lines[1].startswith(saved_text)
        pty_robot.power_cycle()
        assert json.loads(on(pty_robot, "doctor", "--json").out)["robot"]["program"] == checksum
    receipt, kept_state = map(
        json.loads, on(pty_robot, "start", "--previous", "--json").out.splitlines()
    )
    assert receipt["event"] == "RECEIPT" and receipt["checksum"] == first_checksum
    assert receipt["saved"] == "SAVING" and receipt["slot"] is None
    assert kept_state["event"] == "SAVED" and kept_state["slot"] == 0


def test_the_file_of_the_program_is_named_where_it_is_known(
    pty_robot: PtyRobot, tmp_path: Path
) -> None:
    file = tmp_path / "square.ts"
    file.write_text(FIRST_PROGRAM + "\n", encoding="utf-8")
    assert on(pty_robot, "upload", file).code == 0
    assert on(pty_robot, "upload", "-e", SECOND_PROGRAM).code == 0
    assert "square.ts)" in on(pty_robot, "start", "--previous").out


def test_without_a_previous_program_the_next_step_is_named(pty_robot: PtyRobot) -> None:
    assert on(pty_robot, "upload", "-e", FIRST_PROGRAM).code == 0
    for language, expected, advice in (
        ("en", "no earlier program that it can run.", "Send the program that you want"),
        ("es", "ningún programa anterior que pueda", "Envía el programa que quieras"),
    ):
        on(pty_robot, "start", "--previous", "--lang", language).gives(3, expected, advice, out="")
    assert json.loads(on(pty_robot, "doctor", "--json").out)["robot"]["saved"] == "STORED"


def test_undo_ends_the_program_of_another_terminal(pty_robot: PtyRobot) -> None:
    upload_two(pty_robot)
    command = start_endless_upload(pty_robot)
    result = on(pty_robot, "start", "--previous").gives(0)
    assert result.out.splitlines()[-1].startswith("Saved.")
    assert not pty_robot.moves
    assert command.wait_for_result().code in (0, 3)


@pytest.mark.parametrize("is_saved", [False, True])
def test_undo_through_a_port_that_is_lost_says_which_program_the_robot_has(
    pty_robot: PtyRobot, monkeypatch: pytest.MonkeyPatch, is_saved: bool
) -> None:
    first_checksum, second_checksum = upload_two(pty_robot)
    real_wait = start_previous.UndoSaving.wait

    def lose(saving: start_previous.UndoSaving) -> None:
        monkeypatch.setattr(start_previous.UndoSaving, "wait", real_wait)
        if is_saved:
            real_wait(saving)
        pty_robot.power_cycle()
        raise CommandError(3, "port_lost")

    monkeypatch.setattr(start_previous.UndoSaving, "wait", lose)
    pty_robot.ask(lambda robot: robot.set_supply(is_low=not is_saved))
    result = run_in_process("start", "--previous", "--port", pty_robot.port)
    assert result.code == (0 if is_saved else 3), result
    assert ("newer program again" in result.err) != is_saved
    checksum = json.loads(on(pty_robot, "doctor", "--json").out)["robot"]["program"]
    assert checksum == (first_checksum if is_saved else second_checksum)


@pytest.mark.sampled(of="slow commands")
def test_with_weak_batteries_undo_reports_that_nothing_is_lost(pty_robot: PtyRobot) -> None:
    first_checksum, second_checksum = upload_two(pty_robot)
    pty_robot.ask(lambda robot: robot.set_supply(is_low=True))
    for language, expected in (("en", "Nothing is lost"), ("es", "No se pierde nada")):
        on(pty_robot, "start", "--previous", "--lang", language).gives(
            3, expected, out=first_checksum
        )
        assert on(pty_robot, "start", "--previous").code == 0, "the second one is saved already"
    on(pty_robot, "start", "--previous")
    pty_robot.ask(lambda robot: robot.set_supply(is_low=False))
    pty_robot.power_cycle()
    assert json.loads(on(pty_robot, "doctor", "--json").out)["robot"]["program"] in (
        first_checksum,
        second_checksum,
    )


def test_undo_accepts_the_ports_and_options_of_other_verbs() -> None:
    for words in (("--port", "/dev/no-such-port"), ("--virtual",)):
        result = run_in_process("start", "--previous", *words)
        assert result.code == 3 and result.err.startswith("tsc: ") and not result.out
    assert run_in_process("start", "--previous", "--all", "--port", "X").code == 2
    assert run_in_process("start", "--previous", "what").code == 2
