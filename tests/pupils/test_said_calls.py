"""One instruction said in another way is read as a whole, or not at all."""

from __future__ import annotations

import pytest

from tests.pupils.corpus import check
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.rendering import message
from tiniscript.repairs.fixing import fixed
from tiniscript.repairs.said_calls import LONGEST, said_call
from tiniscript.source import Source


@pytest.mark.parametrize(
    ("text", "call"),
    [
        ("F 2 s 60", "F(2, 60)"),
        ("F 2 s, 60 %", "F(2, 60)"),
        ("F 60% 2s", "F(2, 60)"),
        ("R 1 segundo a 40", "R(1, 40)"),
        ("F(tiempo 2, potencia 60)", "F(2, 60)"),
        ("F(potencia: 60, tiempo: 2)", "F(2, 60)"),
        ("adelante 2 seg 60 pot", "F(2, 60)"),
        ("F(dos y medio, sesenta)", "F(2.5, 60)"),
        ("W(un minuto y medio)", "W(90)"),
        ("W(1/2 minuto)", "W(30)"),
        ("W(media hora)", "W(1800)"),
        ("F(2, la mitad)", "F(2, 50)"),
        ("F(2, rápido)", "F(2, 100)"),
        ("F(2, cuarenta y cinco por ciento)", "F(2, 45)"),
        ("F(O.5, 8O)", "F(0.5, 80)"),
        ("F(0,5 s, 60)", "F(0.5, 60)"),
        ("F(2'60)", "F(2, 60)"),
        ("F(0.5.60)", "F(0.5, 60)"),
        ("F - 2 - 60", "F(2, 60)"),
        ("F（2，60）", "F(2, 60)"),
        ("F(X s, 60)", "F(X, 60)"),
        ("BEEP(440 hz, 1 s)", "BEEP(1, 440)"),
        ("BEEP(1 segundo, nota DO)", "BEEP(1, 262)"),
        ("M 50% 60%", "M(50, 60)"),
        ("F;2;60", "F(2, 60)"),
        ("F(60 de potencia, 2 segundos)", "F(2, 60)"),
        ("BEEP 440 1", "BEEP(1, 440)"),
        ("F.2.60", "F(2, 60)"),
        ("F_2_60", "F(2, 60)"),
        ("F: t=2, vel=60", "F(2, 60)"),
        ("F 80 s, vel 60", "F(80, 60)"),
        ("F 80 %, 2 s", "F(2, 80)"),
        ("R 50 %, 3 S", "R(3, 50)"),
        ("F(2),(60)", "F(2, 60)"),
        ("F(2|60)", "F(2, 60)"),
        ("F(2 & 60)", "F(2, 60)"),
        ("beep(uno, cuatrocientos cuarenta)", "BEEP(1, 440)"),
        ("F(vel=60, t=2)", "F(2, 60)"),
        ("F2-60", "F(2, 60)"),
        ("F(2, 60,0)", "F(2, 60.0)"),
        ("F(2 y medio segundos, 60)", "F(2.5, 60)"),
        ("F(2\u00b760)", "F(2, 60)"),
        ("mostrar luz izquierda", "SHOW(LIGHT_L)"),
        ("SHOW(distancia cm)", "SHOW(DISTANCE)"),
    ],
)
def test_all_that_is_said_is_in_the_call(text: str, call: str) -> None:
    said = said_call(text, {"X"})
    assert said is not None
    assert (said.call, said.example) == (call, "")


@pytest.mark.parametrize(
    "text",
    [
        "F 10 cm 60",
        "R(90 grados, 50)",
        "F 80 2",  # 80 s, or a power
        "F 80",
        "F(2.80 s)",
        "F(-2, 80)",
        "F(2, 120)",
        "F(2 potencia 80)",  # the power may be the 2
        "F(2, half)",
        "F.1.5",  # 1.5 s, or 1 s with 5 %
        "F(2, 1velocidad)",  # a name, with its digit in front
        "F(2-60)",  # calculated
        "F(2,8 0)",
        "F(2, 80) cuatro veces",
        "F(2, 80) S",
        "F(2) 60",  # the 60 may be another instruction's
        "F 2 60 60",
        "F 2 s o 60",
        "F 2 s no 60",
        "F 2 s 60 R",
        "W 1 S",  # 1 second, or a stop
        "W(2, 5)",
        "WAIT(500)",  # rather milliseconds
        "F(1h, 1h)",
        "gira 2 60",
        "X 2 60",
        "(F(2, 80)",
        "SHOW(hola)",
        "SHOW EL distancia",  # EL is a variable here
        "S 2",
        "F(2 s, 60 %" + " " * LONGEST + ")",
        "F 80=vel 2",  # the power is rather the 80
        "F(80 = vel, 2)",
        "F(80:vel, 2)",
        "F(80 => vel 2)",
        "F 80, vel 2",  # 80 s
        "R(90, potencia 50)",
        "BEEP(440, nota DO)",
        "M 50 -50",  # a wheel that goes back
        "MOTOR 30 -30",
        "motores 50 -50",
        "M 50-50",
        "M(50 - 50)",
    ],
)
def test_what_is_not_all_sure_is_not_read(text: str) -> None:
    assert said_call(text, {"X", "EL"}) is None


@pytest.mark.parametrize(
    ("program", "call"),
    [("F 80 %, 2 s", "F(2, 80)"), ("R 50 %, 3 s", "R(3, 50)"), ("F 80 %, 2", "F(2, 80)")],
)
def test_a_power_before_its_time_stays_a_power(program: str, call: str) -> None:
    (found,) = check(program)
    assert found.values["fix"] == call
    assert fixed(program, check).text == program, "its author looks"


def test_a_tone_without_a_time_is_an_example() -> None:
    (found,) = check("BEEP(440 Hz)")
    assert (found.values["fix"], found.values["example"]) == ("BEEP(1, 440)", "1 s")


def test_what_was_not_said_is_called_an_example() -> None:
    (found,) = check("F(2 segundos)")
    assert found.code is codes.OTHER_CALL
    assert found.values["fix"] == "F(2, 80)"
    for lang in ("es", "en"):
        assert "80 %" in message(found, Source("F(2 segundos)"), lang).message
    assert fixed("F(2 segundos)", check).text == "F(2 segundos)", "an example is a guess"


@pytest.mark.parametrize(
    ("program", "right"),
    [
        ("SI|F 2 s 60 // gira", "SI|F(2, 60) // gira"),
        ("F(2 s; 60 %);R 1 s 40", "F(2, 60); R(1, 40)"),
        ("F 2 s 60 UNTIL(DISTANCE < 10)", "F(2, 60) UNTIL(DISTANCE < 10)"),
        ("F;2;60;R;1;50", "F(2, 60);R(1, 50)"),
        ("F(2|60)", "F(2, 60)"),
        ("LOOP(2)\n  F 2 s 60\nEND_LOOP", "LOOP(2)\n  F(2, 60)\nEND_LOOP"),
        ("EL = 5\nSHOW EL distancia", "EL = 5\nSHOW(EL);SHOW(DISTANCE)"),
        ("M 50 -50", "M(50, -50)"),
        ("motores 30 -30", "M(30, -30)"),
        ("M 50-50", "M 50-50"),  # calculated, or two values
        ("F(2, 80)\r\nF 2 s 60\r\n", "F(2, 80)\r\nF(2, 60)\r\n"),
    ],
)
def test_the_whole_instruction_is_replaced_and_nothing_beside_it(program: str, right: str) -> None:
    assert fixed(program, check).text == right


@pytest.mark.parametrize(
    "program", ["R(media vuelta)", "L(vuelta, 50)", "R 90", "R(90)", "l(dos vueltas, 80)"]
)
def test_a_turn_by_rounds_or_degrees_takes_a_time(program: str) -> None:
    (found,) = check(program)
    assert found.code is codes.WHICH_WAY
    assert found.values["word"] == program[0].upper()


def test_a_call_that_is_cut_in_two_gets_no_example() -> None:
    assert all(each.values.get("fix") != "F(2, 80)" for each in check("F(2 s;90"))


@pytest.mark.parametrize(
    ("program", "fix"),
    [
        ("SB1|S", "SB|"),
        ("Boton|S", "SB|"),
        ("GO|S", "SI|"),
        ("FF(2, 80)", "F"),
        ("SHOW(sensor)", "LIGHT_R, LIGHT_L o DISTANCE"),
        ("BEEP(1000, 440)", "BEEP(1, 440)"),
        ("BEEP(440, 1000)", "BEEP(1, 440)"),
        ("BEEP(1000, 500)", "1000 milisegundos son 1 segundo"),  # either may be the time
        ("F(500, 80)", "F(0.5, 80)"),
        ("BEEP(hz=440, t=1)", "BEEP(1, 440)"),
        ("BEEP(tono=440, seg=1)", "BEEP(1, 440)"),
        ("BEEP(freq=440, time=1)", "BEEP(1, 440)"),
        ("W(-1)", "desde 0"),
        ("STOP 2", "STOP;W(2)"),
        ("W(un ratito)", "W(2)"),
        ("SI | | S", "Quita |"),
        ("F(2, 80) / avanza", "// avanza"),
        ("IF(DISTANCE < 50 por ciento);S;ENDIF", "50"),
    ],
)
def test_what_one_word_or_number_gets(program: str, fix: str) -> None:
    (found,) = check(program)
    assert fix in message(found, Source(program), "es").fix


@pytest.mark.parametrize(
    "speaker",
    ["[20:14] Luis: ", "[20:14, 21/11/2026] Mi Amigo: ", "21/11/2026, 8:14 p. m. - Luis: "],
)
def test_who_says_a_line_in_a_chat_is_no_part_of_it(speaker: str) -> None:
    program = f"{speaker}F(2, 80)\n{speaker}R(1, 50)"
    (found,) = check(program)
    assert found.code is codes.PASTED
    assert not check("F(2, 80)\nR(1, 50)")


def test_a_long_program_of_such_lines_is_repaired_in_a_few_steps() -> None:
    checks = []

    def counted(text: str) -> list[codes.Diagnostic]:
        checks.append(text)
        return check(text)

    assert fixed("F 2 s 60;" * 150, counted).text == "F(2, 60);" * 150
    assert len(checks) < 20
