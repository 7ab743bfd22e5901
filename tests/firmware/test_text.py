"""The whole robot with lines of text that start it, stop it, or have no effect.

The amount of text that it accepts, in which pieces, and that it never runs a part of a program
alone.

`python -m tests.firmware.test_text 1000` throws so many times anything at a robot.
"""

from __future__ import annotations

import random
import re

import pytest

from tests.machines.host_firmware import EMPTY_EEPROM, TICKS, HostFirmware
from tests.support.campaign import each_seed, make_options
from tests.support.command import OBSTACLE
from tests.support.images import image_of
from tests.support.robot_on_host import (
    KIT,
    LONG_PROGRAM,
    actions_of,
    computer,
    outcome,
    push_button,
    send,
    switched_on,
    wait_until_saved,
)
from tests.support.text_robot import (
    HOLDING_ACTIONS,
    LINE,
    SAVED_MEMORY,
    fetch_image,
    read_back,
    robot_with_program,
    status,
    type_text,
)
from tiniscript import robots
from tiniscript.base.kit import NUMBER, REMOTE, Device, Kit
from tiniscript.link.frames import Frame, encode_frame
from tiniscript.link.messages import BY_NAME, SAVED_STORED, STATE_RUNNING, STATUSES
from tiniscript.link.requests import OK

STOP_MESSAGE = b"\0" + encode_frame(Frame(BY_NAME["STOP"].number, 99, 0))


# Lines typed at a robot at rest, and its answers in English and in Spanish.
ANSWERS = (
    ("S~00000000", "1: Line damaged. Send it again", "1: Linea danada. Enviala de nuevo"),
    ("F(2,80)#", "8: Unknown sign", "8: Signo desconocido"),
    ("W(5.)", "3: Write a number like 5 or 0.5", "3: Escribe un numero como 5 o 0.5"),
    ("X = 2147483.648", "5: Max is 2147483.647", "5: Lo maximo es 2147483.647"),
    ("Si F(1,80)", "4: Put | before this. Phone: ?123 then =\\<",
     "4: Pon | antes de esto. Movil: ?123 y =\\<"),
    ("sb", "3: Put | before this. Phone: ?123 then =\\<",
     "3: Pon | antes de esto. Movil: ?123 y =\\<"),
    ("SI|F", "5: Put ( before this", "5: Pon ( antes de esto"),
    ("PING|S", "6: PING|CHECK_CONNECTION alone", "6: PING|CHECK_CONNECTION solo"),
    ("X=1; X + 1", "6: Begin with a word like F", "6: Empieza con algo como F"),
    ("SI|FOO(1)", "4: Unknown word", "4: Palabra desconocida"),
    ("X = X + 1", "5: No value yet. Write X = 0", "5: Sin valor. Escribe X = 0"),
    ("ROUND(1)", "1: This word cannot go here", "1: Esta palabra no va aqui"),
    ("LOOP(2);TASK", "9: Not in a block", "9: No va en un bloque"),
    ("F(1,50) R(1,50)", "9: Put ; before this", "9: Pon ; antes de esto"),
    ("F 2, 80", "3: Put ( before this", "3: Pon ( antes de esto"),
    ("F(2 80)", "5: Put , before this", "5: Pon , antes de esto"),
    ("F(2,80;", "5: Check the ( and )", "5: Revisa los ( y )"),
    ("W()", "2: A value is missing", "2: Falta un valor"),
    ("F(1)", "3: Too many or too few values", "3: Sobran o faltan valores"),
    ("F(1,500)", "500: 0 to 100", "500: 0 a 100"),
    ("M(-100.4,0)", "-100.4: -100 to 100", "-100.4: -100 a 100"),
    ("W(-1)", "-1: 0 to 2147483.647", "-1: 0 a 2147483.647"),
    ("BEEP(1,5)", "5: 31 to 20000", "5: 31 a 20000"),
    ("W(TRUE)", "3: Needs a number", "3: Debe ser un numero"),
    ("IF(5)", "4: Ask, like DISTANCE < 10", "4: Pregunta: DISTANCE < 10"),
    ("X=1<2<3", "6: Compare 2 values of one kind", "6: Compara 2 del mismo tipo"),
    ("X=1+NOT TRUE", "5: Write (NOT X)", "5: Escribe (NOT X)"),
    ("X=1;X=TRUE", "7: Keep it a number, or yes/no", "7: Que siga numero, o si/no"),
    ("F(FOREVER,80)", "3: Only in LOOP, or with UNTIL", "3: Solo en LOOP, o con UNTIL"),
    ("UNTIL(TRUE)", "1: UNTIL goes after F B L R W", "1: UNTIL va tras F B L R W"),
    ("ENDIF", "1: First open a block", "1: Antes abre un bloque"),
    ("BREAK", "1: BREAK goes in a loop", "1: BREAK va en un bucle"),
    ("DISTANCE = 5", "1: This name is taken", "1: Es nombre de otra cosa"),
    ("LOOP(1);" * 17, "134: Too many, or too deep", "134: Demasiado, o muy adentro"),
    ("A" * 300, "1: Too long. Make it shorter", "1: Muy largo. Hazlo mas corto"),
    ("SI|W(0)", "OK", "OK"),
    ("S", "STOPPED", "DETENIDO"),
    ("F(1,50)", "It was stopped. Begin with SI|", "Esta detenido. Empieza con SI|"),
    ("SI|W(1/0)", "OK", "OK"),
    ("F(1,50)", "It had a fault. Begin with SI|", "Hubo una falla. Empieza con SI|"),
    ("SB|W(0)", "OK. The button starts it.", "OK. El boton lo inicia."),
    ("LOOP(2)", "Waiting for END_LOOP", "Espero END_LOOP"),
)  # fmt: skip


@pytest.mark.parametrize("language", ["en", "es"])
def test_every_message_is_in_its_language(language: str) -> None:
    robot = HostFirmware(robots.load("tinibot").kit, language=language)
    robot.wait(1000)  # a new robot stores its identity
    for line, english, spanish in ANSWERS:
        answers = type_text(robot, line + "\n", 1100)
        assert answers[0] == f"// {spanish if language == 'es' else english}", line
        robot.wait(4000)


REPEATED_LINES = ("HELP", "FOO(1)", "PING|CHECK_CONNECTION", "F(1,500)", "SI|W(0)", "SI|W(1/0)")
STOP_ACTIONS = {
    "zeros": lambda robot: robot.wait(1, bytes(8)),
    "a typed stop": lambda robot: robot.wait(1, b"\nS\n"),
    "a frame": lambda robot: robot.wait(1, STOP_MESSAGE),
    "the button": lambda robot: robot.push(),
}


@pytest.mark.parametrize("stop", STOP_ACTIONS)
def test_text_after_a_stop_does_not_continue_earlier_text(stop: str) -> None:
    """The stop comes at any moment of an answer."""
    robot, fresh = switched_on(), switched_on()
    rng = random.Random(stop)
    for line in REPEATED_LINES:
        for byte in line.encode():
            robot.step(bytes((byte,)))
        robot.step(b"\n", ticks=rng.randrange(1, 6))  # each is a line of an answer
        answers = []
        for host_firmware in (robot, fresh):
            STOP_ACTIONS[stop](host_firmware)
            host_firmware.wait(2500)
            answers.append(type_text(host_firmware, line + "\n", 1500))
            host_firmware.wait(2500)
        assert answers[0] == answers[1] != [], line


@pytest.mark.parametrize(
    "ignored_text", ["LOOP(2)", "SI|IF(TRUE)", "DEF A", "F(1,", "FOO(1)", "HELP"]
)
def test_a_line_that_is_ignored_after_a_stop_leaves_nothing(ignored_text: str) -> None:
    robot, fresh = switched_on(), switched_on()
    for line in ("F(0.1,50)", "END_LOOP", "SI|F(0.1,50)", "F(0.1,50)", *REPEATED_LINES):
        answers = []
        for host_firmware in (robot, fresh):
            type_text(host_firmware, "S\n", 20)
            if host_firmware is robot:
                type_text(host_firmware, ignored_text + "\n", 20)
            host_firmware.wait(2500)
            host_firmware.did.clear()
            answers.append((type_text(host_firmware, line + "\n", 1200), actions_of(host_firmware)))
            host_firmware.wait(2500)
        assert answers[0] == answers[1], line


@pytest.mark.sampled(of="other builds of the firmware")
@pytest.mark.parametrize(
    "language, message",
    [
        ("en", "Needs tsc, or a Mega or ESP32"),
        ("es", "Usa tsc, un Mega o un ESP32"),
        ("pt", "Use tsc, um Mega ou um ESP32"),
    ],
)
def test_an_uno_reports_the_board_that_tasks_ways_and_defs_need(
    language: str, message: str
) -> None:
    defines = ("tiniscript_no_defs",)
    robot = HostFirmware(robots.load("tinibot").kit, language=language, defines=defines)
    robot.wait(1000)
    lines = {"F(20 CM, 60)": 6, "r(90 deg, 60)": 6, "TASK": 1, "SI|WHEN(TRUE)": 4, "S;END_TASK": 3,
             "EndWhen": 1, "ENDTASK = 5": 1, "DEF A": 1}  # fmt: skip
    for line, column in lines.items():
        assert type_text(robot, line + "\n", 1100) == [f"// {column}: {message}"], line
        robot.wait(4000)


def test_typed_tasks_and_ways_run() -> None:
    """Their image states its needs, so that another robot can check them."""
    robot = switched_on()
    text = "SI|F(FOREVER, 60); WHEN(TRUE); B(9 cm, 60); W(1); END_WHEN"
    assert type_text(robot, text + "\n", 500) == ["// OK"]
    assert actions_of(robot) == ["MOTORS 60 60", "MOTORS -60 -60", "MOTORS 0 0"]
    assert type_text(robot, "S\n", 500) == ["// STOPPED"]


@pytest.mark.parametrize("end", ["\n", "\r", "\r\n"])
@pytest.mark.parametrize("pause_ms", [0, 1500])
@pytest.mark.parametrize(
    "lines",
    [
        ("F(0.2,50", ")"), ("F(0.2", ",50)"), ("F(", "(0.1", "+ 0.1), 50)"), ("F(0.1", "*2,50)"),
        ("F(0.3", "-0.1,50)"), ("SI|LOOP(1)", ";F(0.2,50)", "; // end", "END_LOOP"),
        ("F(0.2, // seconds", "50)"), ("F(0.2,", "50", ")"),
    ],
)  # fmt: skip
def test_an_open_line_may_continue_with_any_character(
    lines: tuple[str, ...], pause_ms: int, end: str
) -> None:
    """Digits and signs begin frames, too, but not where a line waits for its end."""
    robot = switched_on()
    type_text(robot, "W(0)\n", 100)
    *first_lines, last_line = lines
    for line in first_lines:
        assert set(type_text(robot, line + end, pause_ms)) <= {
            "// Waiting for )", "// Waiting for END_LOOP",
        }  # fmt: skip
    assert type_text(robot, last_line + end, 400)[-2:] == ["// OK", "// DONE"]
    assert actions_of(robot)[1:] == LINE


def test_backspace_edits_what_is_typed() -> None:
    robot = switched_on()
    assert type_text(robot, "SO\b\bSI|G\bFO\x7f(0.2,50)\n", 400) == ["// OK", "// DONE"]
    assert actions_of(robot) == LINE
    assert type_text(robot, "F(0.2,50)\b\n", 400) == ["// 10: Unknown sign"]


@pytest.mark.parametrize(
    "partial_text", ["\x1b", "\x1b[", "\x1bO", "\x1b[1", "\x1b[1;", "\x1b[1;5"]
)
@pytest.mark.parametrize("stop", ["S", "STOP", "s;", "ALTO"])
def test_after_a_second_a_partial_key_is_forgotten(partial_text: str, stop: str) -> None:
    """A terminal has sent a part of a cursor key; a stop typed then is obeyed."""
    robot = switched_on()
    assert type_text(robot, "F(60, 80)\n", 100) == ["// OK"]
    type_text(robot, partial_text, 1100)
    type_text(robot, f"{stop}\n", 300)
    assert actions_of(robot)[-1] == "MOTORS 0 0"


@pytest.mark.parametrize("language", ["en", "es"])
def test_many_mistakes_are_summarized_once(language: str) -> None:
    """After a pause they are answered again."""
    robot = HostFirmware(robots.load("tinibot").kit, language=language)
    robot.wait(1000)
    mute = ["// Son muchos. Espera 5 s." if language == "es" else "// Too many. Wait 5 s."]
    for _ in range(2):
        answers = [type_text(robot, "FOO\n", 1100) for _ in range(30)]
        assert answers[0] and answers[:16] == [answers[0]] * 16
        assert answers[16:] == [mute] + [[]] * 13
        robot.wait(3800)
        assert type_text(robot, "FOO\n", 1100) == []
        robot.wait(4000)


def done_after(robot: HostFirmware, text: str | bytes, milliseconds: int = 1200) -> list[str]:
    """Return the robot's actions after a line."""
    robot.did.clear()
    type_text(robot, text, milliseconds)
    return actions_of(robot)


# -- a line, and the program that the robot holds -------------------------------------------------


def test_a_line_runs_and_its_end_is_reported() -> None:
    robot = switched_on()
    assert type_text(robot, "SI|F(0.2,50)\n", 400) == ["// OK", "// DONE"]
    assert actions_of(robot) == LINE
    first_ms, last_ms = (int(line.split()[0]) for line in robot.did[:2])
    assert last_ms - first_ms == 200
    assert done_after(robot, "f ( 0.2 , 50 )\r") == LINE


@pytest.mark.parametrize("line", [
    "hola", "W(1); hola", "SI|W(1);hola", "F(1,80);F(1,180)", "SI|F(1,)", "SB|X=", "X=1;X=TRUE",
    "W(1);LOOP(2);END_IF", "SI|LOOP(2);\nBAD", "SI|F(1,80);W(1)~12345678", "S;S;W",
    "F(1,50) R(1,50)", "F(1,80);\x0eF(1,80)", "PING|W(1)", "W(1);TASK;X",
    "abcdefghijklmnopqrst", "9" * 300,
])  # fmt: skip
def test_a_wrong_line_changes_nothing(line: str) -> None:
    """The running program continues, and one in memory stays there; a second time, too."""
    robot, session = robot_with_program("SB|B(30, 60)", saves=False)
    bytes_before = fetch_image(robot, session)
    robot.wait(4000)
    assert push_button(robot) == ["MOTORS -60 -60"]
    robot.did.clear()
    for _ in range(2):
        (answer,) = type_text(robot, line + "\n", 1500)
        assert re.match(r"// \d+: ", answer)
        assert robot.did == []
    held_status_reply = status(robot, session)
    assert (held_status_reply.saved, held_status_reply.state) == (SAVED_MEMORY, STATE_RUNNING)
    assert fetch_image(robot, session) == bytes_before


@pytest.mark.parametrize("is_saved", [True, False])
def test_typed_lines_leave_the_stored_program(is_saved: bool) -> None:
    """Also one that is in memory only: there is room for two programs."""
    robot, session, bytes_before = read_back(is_saved)
    assert type_text(robot, "SI|F(0.2,50);SHOW(1.5)\r\n", 400) == ["// OK", "// 1.5", "// DONE"]
    assert fetch_image(robot, session) == bytes_before
    assert status(robot, session).saved == (SAVED_STORED if is_saved else SAVED_MEMORY)
    robot.wait(4000)
    assert push_button(robot) == HOLDING_ACTIONS


def test_a_typed_sb_program_waits_for_the_button_and_is_lost_at_power_off() -> None:
    robot, session, bytes_before = read_back()
    assert type_text(robot, "SB|F(0.2,50)\n", 2000) == ["// OK. The button starts it."]
    assert robot.did == [] and robot.is_lit
    for _ in range(2):
        robot.push()
        robot.wait(400)
    assert actions_of(robot) == LINE * 2
    assert done_after(robot, "SI|R(0.1,40)\n")[0] == "MOTORS 40 -40"
    assert push_button(robot) == LINE, "a line that runs at once leaves the button's program"
    assert status(robot, session).saved == SAVED_MEMORY
    restarted_robot = switched_on(robot.memory())
    assert push_button(restarted_robot) == HOLDING_ACTIONS
    assert fetch_image(restarted_robot, computer(2)) == bytes_before


def test_a_program_of_frames_replaces_sb() -> None:
    robot, session = robot_with_program()
    type_text(robot, "SB|F(0.2,50)\n")
    send(robot, session, "SB|L(0.1, 40)")
    assert push_button(robot)[0] == "MOTORS -40 40"


# -- ends of a run that text has started -----------------------------------------------------------


@pytest.mark.parametrize("stop_kind", ["s\n", "STOP", "zeros", "button"])
def test_a_stop_of_a_typed_program_latches(stop_kind: str) -> None:
    """Text within a second after it may have been under way, even if the line was silent before the
    stop.
    """
    robot, _ = robot_with_program()
    type_text(robot, "SI|F(30,50)\n", 3000)
    assert actions_of(robot) == ["MOTORS 50 50"]
    if stop_kind == "button":
        robot.push()
    elif stop_kind == "zeros":
        robot.wait(50, bytes(8))
    else:
        assert type_text(robot, stop_kind, 1100 if stop_kind == "STOP" else 60) == ["// STOPPED"]
    robot.wait(100)
    for _ in range({"STOP": 0, "s\n": 1}.get(stop_kind, 4)):  # typed here: lines soon count again
        type_text(robot, "SI|F(1,50)\n", 700)
    assert actions_of(robot) == ["MOTORS 50 50", "MOTORS 0 0"]
    robot.wait(1500)
    assert type_text(robot, "F(1,50)\n", 1100) == ["// It was stopped. Begin with SI|"]
    assert actions_of(robot) == ["MOTORS 50 50", "MOTORS 0 0"]
    assert type_text(robot, "SI|F(0.2,50)\n", 400) == ["// OK", "// DONE"]
    assert push_button(robot) == HOLDING_ACTIONS


@pytest.mark.parametrize("is_stopped_before", [False, True])
@pytest.mark.parametrize("stop", [bytes(4), STOP_MESSAGE])
def test_a_stop_discards_an_open_block_even_on_an_idle_robot(
    stop: bytes, is_stopped_before: bool
) -> None:
    """Its SETUP word is from before the stop, and does not release the robot after it."""
    robot = switched_on()
    if is_stopped_before:
        robot.wait(1500, bytes(4))
    assert type_text(robot, "SI|LOOP(2)\n", 1500) == ["// Waiting for END_LOOP"]
    robot.wait(1500, stop)
    type_text(robot, "F(1,50)\nEND_LOOP\n", 1500)
    assert actions_of(robot) == []
    assert type_text(robot, "SI|F(0.2,50)\n", 400) == ["// OK", "// DONE"]


@pytest.mark.parametrize("noise", [b"\n", b" ", b"\x05\x06", b"\0", b"\xff"])
def test_a_line_is_silent_after_a_stop_when_nothing_at_all_arrives(noise: bytes) -> None:
    robot = switched_on()
    type_text(robot, "SI|F(30,50)\n")
    robot.wait(50, bytes(8))
    for _ in range(5):
        type_text(robot, noise, 500)
    type_text(robot, b"\0SI|F(1,50)\n", 1500)
    assert actions_of(robot) == ["MOTORS 50 50", "MOTORS 0 0"]
    assert type_text(robot, "SI|F(0.2,50)\n", 400) == ["// OK", "// DONE"]


def test_a_typed_run_has_a_longest_time_but_no_dead_man_timer() -> None:
    robot = switched_on(max_run_ms=5000)
    type_text(robot, "SI|F(30,50)\n", 4900)
    assert actions_of(robot) == ["MOTORS 50 50"]
    robot.step(flags=8)  # no computer is connected
    assert actions_of(robot) == ["MOTORS 50 50"]
    assert robot.wait(300) == b"// FAULT MAX_RUN\r\n"
    assert actions_of(robot)[1:] == ["MOTORS 0 0", "FAULTED"]


def test_a_fault_is_reported_recorded_and_stored() -> None:
    robot, session = robot_with_program()
    program_checksum = status(robot, session).program
    robot.wait(4000)
    assert type_text(robot, "SI|X=0;F(0.1,50);X=1/X\n", 300) == ["// OK", "// FAULT DIVIDE_BY_ZERO"]
    assert actions_of(robot) == ["MOTORS 50 50", "MOTORS 0 0", "FAULTED"]
    values = status(robot, session)
    # A robot's own code is not fused, so no compiled image has its checksum.
    assert values.fault == 2 and values.program == program_checksum
    assert values.fault_program not in (0, program_checksum)
    robot.wait(3000)
    kept_status = status(switched_on(robot.memory()), computer(2))
    assert (kept_status.fault, kept_status.fault_at) == (2, values.fault_at)
    assert kept_status.fault_program == values.fault_program
    assert type_text(robot, "F(0.2,50)\n") == ["// It had a fault. Begin with SI|"]
    # Checksums agree where plain code equals compiled code.
    type_text(robot, "SI|W(TIME/(TIME-TIME))\n")
    image = image_of("SI|W(TIME / (TIME - TIME))")
    assert status(robot, session).fault_program == image.checksum


ENDLESS_PROGRAM = "SI|LOOP(FOREVER);M(50,50);W(9);END_LOOP\n"


@pytest.mark.parametrize("text", ["S", "stop", "S;", "\t STOP ;"])
def test_s_in_an_open_block_ends_a_run_even_without_a_line_end(text: str) -> None:
    """It does not latch, and belongs to the program, whose line may continue."""
    robot = switched_on()
    type_text(robot, ENDLESS_PROGRAM, 300)
    type_text(robot, "LOOP(2)\n", 300)
    assert type_text(robot, text, 900) == []
    assert actions_of(robot) == ["MOTORS 50 50"]
    assert robot.wait(200) == b"// Waiting for END_LOOP\r\n"
    assert actions_of(robot) == ["MOTORS 50 50", "MOTORS 0 0"]
    assert type_text(robot, "\nF(0.1,30)\nEND_LOOP\n", 400) == ["// OK", "// DONE"]
    assert actions_of(robot)[2:] == ["MOTORS 30 30", "MOTORS 0 0"] * 2 + ["FINISHED"]


@pytest.mark.parametrize("parts", [("S", "HOW(1)"), ("STO", "RE=1"), ("ST", "ART")])
def test_a_word_that_begins_like_s_in_an_open_block_may_be_typed_slowly(
    parts: tuple[str, str],
) -> None:
    robot = switched_on()
    type_text(robot, ENDLESS_PROGRAM, 300)
    type_text(robot, "LOOP(2)\n", 300)
    for part in parts:
        type_text(robot, part, 1500)
    assert type_text(robot, "\nEND_LOOP\n", 300)[-1] == "// DONE"


def test_a_truncated_or_late_program_is_reported() -> None:
    robot = switched_on()
    for garbage in (b"\0", b"\x01\x02\0"):
        type_text(robot, "SI|LOOP(2)\n")
        type_text(robot, "F(0.1")
        assert type_text(robot, garbage, 600) == ["// Lines end with Enter, not with 0"], garbage
        robot.wait(1500)
    type_text(robot, "SI|LOOP(2)\n", 1100)
    assert robot.wait(60_000) == b"// Too late. Begin again.\r\n"


# -- frames and text ------------------------------------------------------------------------------


def test_frames_work_during_and_after_text() -> None:
    robot, session = switched_on(), computer()
    type_text(robot, "SI|F(30,50)\n", 100)
    assert status(robot, session).state == 1
    assert robot.until(session, session.live(image_of("SI|F(0.1, 80)").code)) == OK
    robot.talk(session, 300)
    assert actions_of(robot) == ["MOTORS 50 50", "MOTORS 0 0", "MOTORS 80 80", "MOTORS 0 0",
                               "FINISHED"]  # fmt: skip
    robot.did.clear()
    type_text(robot, "SI|F(30,50)\n", 20)
    send(robot, session, "SI|F(0.1, 80)")
    robot.talk(session, 300)
    assert actions_of(robot)[-2:] == ["MOTORS 0 0", "FINISHED"]
    assert "MOTORS 80 80" in actions_of(robot)
    robot.did.clear()
    type_text(robot, "SI|F(0.2,50)\n", 300)
    assert actions_of(robot) == LINE


@pytest.mark.parametrize("is_burst", [True, False])
@pytest.mark.parametrize("missing_count", range(1, 12))
def test_a_live_line_right_after_text_runs_its_own_frame(
    missing_count: int, is_burst: bool
) -> None:
    """Its image is made before its frame ends: text that comes between must not be run for it."""
    robot, session = switched_on(), computer()
    robot.until(session, session.hello())
    image = image_of("SI|F(0.1, 80)")
    request = session.live(image.code)
    frame = session.poll(robot.now_ms)
    text = b"SI|M(50,50);W(5)\n\0"
    robot.step(
        text + frame[:-missing_count], flags=16 if is_burst else 0, ticks=0 if is_burst else 1
    )
    sent_bytes = robot.step(b"", ticks=4) + robot.step(frame[-missing_count:]) + robot.wait(20)
    session.receive(sent_bytes, robot.now_ms)
    robot.talk(session, 300)
    assert robot.until(session, request) == OK
    assert outcome(request).values.program == image.checksum
    assert actions_of(robot)[-3:] == ["MOTORS 80 80", "MOTORS 0 0", "FINISHED"]


@pytest.mark.parametrize("text", [b"", b"W(9)\n\0", b"FOO\nW(9)\n\0"])
def test_a_program_in_the_same_turn_as_text_has_its_checksum(text: bytes) -> None:
    """If the robot is slow, both wait: the image must be sealed before the next one is."""
    robot, session = switched_on(), computer()
    robot.until(session, session.hello())
    image = image_of("SB|F(0.1, 80)")
    request = session.upload(image)
    frame = session.poll(robot.now_ms)
    assert len(frame) < 30
    session.receive(robot.step(text + frame, flags=16, ticks=1), robot.now_ms)
    assert robot.until(session, request) == OK
    assert outcome(request).values.program == image.checksum
    type_text(robot, "W(0)\n")
    wait_until_saved(robot, session)
    restarted_robot = switched_on(robot.memory())
    assert push_button(restarted_robot, 300) == ["MOTORS 80 80", "MOTORS 0 0", "FINISHED"]


@pytest.mark.parametrize("line", ["FOO\n", "SI|F(0.2,50)\n", "SB|F(0.2,50)\n", "S\n"])
def test_an_upload_works_while_text_arrives(line: str) -> None:
    """It is complete, or refused without replacing the previous program."""
    robot, session = robot_with_program()
    bytes_before = fetch_image(robot, session)
    request = session.upload(image_of(LONG_PROGRAM))
    robot.talk(session, 10)
    for byte in line.encode():
        session.receive(robot.step(bytes((byte,))), robot.now_ms)
    outcome = robot.until(session, request)
    # A single frame may start it, and a later S stops it.
    assert outcome in (OK, STATUSES["NOT_BEGUN"], STATUSES["STALE"], STATUSES["LATCHED"])
    robot.talk(session, 6000)
    image = fetch_image(robot, session)
    if outcome == OK:
        assert image.endswith(image_of(LONG_PROGRAM).code)
    elif not line.startswith("SB"):
        assert image == bytes_before


@pytest.mark.parametrize("start", ["SI", "SB"])
def test_text_works_while_a_program_is_being_saved(start: str) -> None:
    robot, session = switched_on(), computer()
    send(robot, session, LONG_PROGRAM.replace("SI", "SB"))
    robot.wait(300)
    answers = []
    for _ in range(40):
        robot.step(b"\0")
        answers += type_text(robot, f"{start}|F(0.1,50)\n", 150)
        if answers[-1:] == ["// OK. The button starts it."]:
            break
    assert answers[-1] in ("// DONE", "// OK. The button starts it."), answers
    wait_until_saved(switched_on(robot.memory()), computer(3), 12_000)
    robot.wait(12_000)
    restarted_robot = switched_on(robot.memory())
    image = fetch_image(restarted_robot, computer(2))
    assert image.endswith(image_of(LONG_PROGRAM).code)


def test_values_wait_for_room_and_none_is_lost() -> None:
    robot = switched_on()
    answers = type_text(robot, "SI|X=0;LOOP(50);X=X+1.001;SHOW(X);END_LOOP;SHOW(X>1)\n", 3000)
    values = [f"// {(k + 1) * 1.001:.3f}" for k in range(50)]
    assert answers == [
        "// OK",
        *(value.rstrip("0").rstrip(".") for value in values),
        "// TRUE",
        "// DONE",
    ]


LINE_LETTERS = 63  # most letters of an answer, without its end

CODE_BYTES = 255

# -- limits ---------------------------------------------------------------------------------------


def test_a_program_of_255_bytes_runs_and_a_longer_one_is_refused() -> None:
    robot = switched_on()
    text = "SI|F(0.1,50)" + ";S" * (CODE_BYTES - 4)
    assert type_text(robot, text + "\n", 300) == ["// OK", "// DONE"]
    robot.did.clear()
    (answer,) = type_text(robot, text + ";S\n", 1100)
    assert answer == "// 255: Too long. Make it shorter"
    assert robot.did == []
    assert done_after(robot, "F(0.2,50)\n") == LINE


def test_long_names_are_accepted_until_the_memory_is_full() -> None:
    robot = switched_on()
    names = [f"NAME{chr(65 + k)}" + "X" * 40 for k in range(26)]
    answers = []
    for count in range(1, 12):
        text = "SI|" + "".join(f"{name}=0;" for name in names[:count]) + "SHOW(1)\n"
        answers.append(type_text(robot, text, 1100))
    fits = [answer == ["// OK", "// 1", "// DONE"] for answer in answers]
    assert fits == sorted(fits, reverse=True) and True in fits and False in fits
    assert {len(answer) for answer in answers if answer[0] != "// OK"} == {1}
    assert done_after(robot, "F(0.2,50)\n") == LINE


@pytest.mark.parametrize("pattern", ["F(1,50);", "A", " ", "(", "9", "\x01", "~", "é", "/", "SI|"])
def test_a_line_of_10000_bytes_is_discarded(pattern: str) -> None:
    robot = switched_on()
    data = (pattern * 10_000).encode()[:10_000]
    for offset in range(0, len(data), 20):  # one step for each turn
        robot.step(data[offset : offset + 20])
    robot.step(b"\n")
    assert robot.did == []
    robot.wait(1100)
    assert type_text(robot, "SI|F(0.2,50)\n", 400) == ["// OK", "// DONE"]


@pytest.mark.parametrize("letters", [1, 24, 25, 59, 60, 61, 255, 1000])
def test_help_lists_a_device_with_a_long_name(letters: int) -> None:
    """An answer is never longer than a line; a word that is longer is cut."""
    distance = Device("DISTANCE", NUMBER, "cm", 0, 400_000)
    kit = Kit((distance, Device("A" * letters, NUMBER, "", 0, 1)), ())
    robot = HostFirmware(kit, EMPTY_EEPROM)
    robot.wait(200)
    answers = type_text(robot, "HELP\n", 2000)
    assert max(map(len, answers)) <= LINE_LETTERS
    words = [word for answer in answers for word in answer.removeprefix("// ").split()]
    device_names = ["DISTANCE", "A" * min(letters, LINE_LETTERS - len("// "))]
    assert words[-10:] == [*device_names, *(device.name for device in REMOTE)]


@pytest.mark.parametrize("seed", range(4))
def test_a_robot_prints_its_number_or_a_name_without_line_ends(seed: int) -> None:
    """Otherwise an echo of it would be a program."""
    robot, session = HostFirmware(KIT, EMPTY_EEPROM, seed=0x9F0FFE8D + seed), computer()
    robot.wait(200)
    robot.until(session, session.hello())
    assert session.robot and not session.robot.name
    robot.wait(4000)
    (answer,) = type_text(robot, "PING|CHECK_CONNECTION\n")
    assert answer.startswith(f"// {session.robot.id:08x}, kit {KIT.fingerprint:04x}, ")
    robot.until(session, session.name(b"\r\nS;\x1b[2J\xc3\xb1\x00\x7f"))
    robot.wait(4000)
    (answer,) = type_text(robot, "PING|CHECK_CONNECTION\n")
    assert answer.encode("latin-1").startswith(b"// ??S;?[2J\xc3\xb1??, kit ")


@pytest.mark.parametrize("end", ["\n", "\r", "\r\n"])
def test_the_obstacle_program_runs_line_by_line(end: str) -> None:
    robot = switched_on()
    lines = ["SI|LOOP(FOREVER);", "  F(1, 80);", "  DISTANCE;", "  IF(DISTANCE < 10);",
             "    STOP;", "    R(1, 60);", "  ENDIF;", "END_LOOP"]  # fmt: skip
    robot.set_readings(0, 0, 50_000)
    assert type_text(robot, end.join(lines) + end) == ["// OK"]
    robot.wait(2500)
    robot.set_readings(0, 0, 9_000)
    robot.wait(1000)
    assert actions_of(robot)[-1] == "MOTORS 60 -60"
    assert type_text(robot, OBSTACLE.rstrip("\n").replace("\n", end) + end)[-1] == "// OK"


# -- answers that are cut -------------------------------------------------------------------------

PACE = 21  # ticks of a byte at 9600 baud
ANSWERED_LINES = ("HELP", "PING|CHECK_CONNECTION", "F(1,500)")
INTERRUPTIONS = {
    "zeros": bytes(8),
    "a message": b"\0" + encode_frame(Frame(BY_NAME["STOP"].number, 99, 0)),
    "a line": b"\nS\n",
    "another question": b"\nW(5.)\n",
}
STEP_MS = 37


def robot_on_slow_line() -> HostFirmware:
    robot = HostFirmware(KIT)
    robot.wait(200)
    robot.set_byte_ticks(PACE)
    return robot


def answer_to(robot: HostFirmware, line: str) -> bytes:
    """Return the robot's complete answer to a line."""
    answer = robot.wait(1, f"{line}\n".encode())
    while part := robot.wait(2500):
        answer += part
    return answer


@pytest.mark.sampled("cut")
@pytest.mark.parametrize("cut", INTERRUPTIONS)
@pytest.mark.parametrize("line", ANSWERED_LINES)
def test_a_truncated_answer_is_repeated_from_its_beginning(line: str, cut: str) -> None:
    """The cut may come at any moment of the answer: the rest is not sent, and the next answer is
    that of a fresh robot.
    """
    expected_answer = answer_to(robot_on_slow_line(), line)
    assert expected_answer.startswith(b"//")
    robot = robot_on_slow_line()
    lasts_ms = 1 + len(expected_answer) * PACE // TICKS
    for began_ms in range(1, lasts_ms + STEP_MS, STEP_MS):
        robot.wait(began_ms, f"{line}\n".encode())
        # lines after the interrupted one
        rest = robot.wait(8000, INTERRUPTIONS[cut]).split(b"\n")[1:]
        if cut != "another question":  # another question waits for the previous answer
            assert not {*rest} & {*expected_answer.split(b"\n")[:-1]}, (began_ms, rest)
        robot.wait(2500, b"\n")
        assert answer_to(robot, line) == expected_answer, began_ms


def test_text_is_accepted_right_after_power_on() -> None:
    robot = HostFirmware(KIT, robot_with_program()[0].memory())
    robot.step(b"SI|F(0.2,50)\n", flags=16, ticks=0)
    assert robot.step(ticks=3) == b"// Still saving. Send it again.\r\n"
    robot.wait(300)
    assert done_after(robot, "SI|F(0.2,50)\n") == LINE
    (hello,) = type_text(HostFirmware(KIT, EMPTY_EEPROM), "PING|CHECK_CONNECTION\n")
    assert hello.endswith(", text uno")


# -- programs that must not run in parts -----------------------------------------------------------


@pytest.mark.parametrize("seed", range(4))
def test_a_program_too_long_for_the_buffer_is_not_run_in_part(seed: int) -> None:
    """The bytes may be in a line that opens a block, before it, or after it."""
    rng = random.Random(seed)
    robot = switched_on()
    type_text(robot, "SI|W(0)\n", 200)  # from here on a line needs no SETUP word
    lost_count = 0
    for _ in range(12):
        robot.wait(1500)
        robot.did.clear()
        rows = ["// before it"] * rng.randrange(6) + ["LOOP(2)"]
        rows += [f"F(0.01,{rng.randrange(20, 90)})" for _ in range(rng.randrange(1, 6))]
        text = "\n".join([*rows, "END_LOOP", ""]).encode()
        cut_index = rng.randrange(len(text))
        answer = robot.step(text[:cut_index], flags=16)
        answer += "\n".join(type_text(robot, text[cut_index:], 300)).encode()
        is_lost = b"// Bytes were lost. Begin again." in answer
        lost_count += is_lost
        assert not is_lost or not robot.did, text
    assert 0 < lost_count < 12


@pytest.mark.parametrize("intervening_bytes", ["zero", "frame", "button", "two tabs"])
def test_the_rest_of_a_lost_program_is_not_run(intervening_bytes: str) -> None:
    """Its lines are whole, and have another meaning on their own."""
    robot, session = switched_on(), computer()
    type_text(robot, "SI|LOOP(2)\n")
    if intervening_bytes == "zero":
        type_text(robot, b"R(0.1,\0")
    elif intervening_bytes == "frame":
        assert robot.until(session, session.clear()) == OK
    elif intervening_bytes == "button":
        robot.step(flags=2)
        robot.push()
    else:
        type_text(robot, "BAD\n")
    type_text(robot, "F(0.2,50)\nF(0.2,50)\n", 400)
    type_text(robot, "END_LOOP\n", 400)
    assert robot.did == []
    robot.wait(1100)
    assert done_after(robot, "SI|F(0.2,50)\n") == LINE


@pytest.mark.parametrize("blanks", ["\t\t", "\t", "  ", "\t \t"])
def test_a_line_of_a_program_may_come_late_and_indented(blanks: str) -> None:
    robot = switched_on()
    type_text(robot, "SI|LOOP(2)\n", 1500)
    type_text(robot, f"{blanks}F(0.2,50)\n", 1500)
    assert type_text(robot, "END_LOOP\n", 700) == ["// OK", "// DONE"]
    assert actions_of(robot) == LINE[:2] * 2 + LINE[2:]


@pytest.mark.parametrize(
    ("text", "awaited_text"),
    [
        ("LOOP(2)\n", "END_LOOP"), ("LOOP(FOREVER)\n", "END_LOOP"), ("IF(TRUE)\n", "ENDIF"),
        ("IF(TRUE);ELSE\n", "ENDIF"), ("WHILE(TRUE)\n", "END_WHILE"), ("DEF A\n", "END_DEF"),
        ("TASK\n", "END_TASK"), ("WHEN(TRUE)\nS\n", "END_WHEN"),
        ("X=(1\n", ")"), ("LOOP(2)\nX=1+", "END_LOOP"), ("LOOP(2)\nX=-", "END_LOOP"),
        ("IF(TRUE)\nX=TRUE AND NOT ", "ENDIF"), ("IF(TRUE)\nX=MIN(1,", "ENDIF"),
        ("DEF A\nF(1,", "END_DEF"),
    ],
)  # fmt: skip
def test_the_end_that_an_open_block_awaits_is_reported(text: str, awaited_text: str) -> None:
    """This holds in the middle of a line, too, whose stored beginning is no block."""
    assert type_text(switched_on(), text, 1100) == [f"// Waiting for {awaited_text}"]


if __name__ == "__main__":
    from tests.support.text_fuzz import run

    each_seed(run, make_options(1000, 1_000_000))
