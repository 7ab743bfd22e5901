"""A sentence of several orders gets all of them, or none: no number and no turn is lost."""

from __future__ import annotations

import pytest

from tests.pupils.corpus import check
from tiniscript.base.source import Source, applied
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.fixing import edits_of, fixed
from tiniscript.diagnostics.rendering import message


def said(program: str) -> list[tuple[str, str]]:
    """Return the code and the repair of each message."""
    return [(each.code.number, each.values.get("fix", "")) for each in check(program)]


@pytest.mark.parametrize(
    ("program", "orders", "example"),
    [
        ("avanza 2 segundos y luego para", "F(2, 80);S", "80 %"),
        ("avanza 2 segundos y gira a la derecha", "F(2, 80);R(2, 80)", "2 s, 80 %"),
        ("go forward 3 seconds then stop", "F(3, 80);STOP", "80 %"),
        ("Avanza 2 segundos, gira a la izquierda y para.", "F(2, 80);L(2, 80);S", "2 s, 80 %"),
        ("avanza 1 segundo gira 2 segundos a la derecha", "F(1, 80);R(2, 80)", "80 %"),
        ("avanza 2 s al 50% y despu\u00e9s retrocede 1 s al 30%", "F(2, 50);B(1, 30)", ""),
        ("turn right for half a second and go back 2 seconds", "R(0.5, 80);B(2, 80)", "80 %"),
        ("d\u00ea r\u00e9 por 2 segundos e vire \u00e0 esquerda", "B(2, 80);L(2, 80)", "2 s, 80 %"),
        (
            "o rob\u00f4 anda pra frente at\u00e9 a parede e depois o robo vira pra direita",
            "F(FOREVER, 80) UNTIL(DISTANCE < 10);R(2, 80)",
            "10 cm, 2 s, 80 %",
        ),
        ("F 2 segundos y luego S", "F(2, 80);S", "80 %"),
        ("espera 500 ms y avanza despacio 2 segundos", "W(0.5);F(2, 40)", ""),
        (
            "pita 3 veces y para 1 segundo",
            "LOOP(3);BEEP(1, 440);W(1);END_LOOP;S;W(1)",
            "1 s, 440 Hz",
        ),
        (
            "avanza hasta la pared y gira 1 segundo a la derecha",
            "F(FOREVER, 80) UNTIL(DISTANCE < 10);R(1, 80)",
            "10 cm, 80 %",
        ),
    ],
)
def test_each_order_of_a_sentence_is_written(program: str, orders: str, example: str) -> None:
    (found,) = check(program)
    assert found.code is codes.SEVERAL_ORDERS
    assert found.values["fix"] == orders
    assert found.values["example"] == example
    edits = edits_of(found)
    assert edits and not check(applied(program, edits))
    if example:
        assert fixed(program, check).text == program, "an example is a guess"
    for lang in ("es", "en"):
        assert example in message(found, Source(program), lang).message


@pytest.mark.parametrize(
    "program",
    [
        "avanza 50 y para",  # seconds, or percent
        "avanza 2 segundos a la derecha y para",
        "avanza sin parar y retrocede",
        "avanza 2 segundos y no pares",
        "avanza 2 segundos y mira si hay pared",
        "avanza rapido 2 segundos y luego despacio",
        "avanza 2 pasos y para",
        "despu\u00e9s de 2 segundos avanza y para",
        "retrocede hasta la pared y para",  # DISTANCE looks ahead
        "avanza y gira a la derecha 4 veces",
        "avanza y baila",
        "gira derecho y para",
    ],
)
def test_a_sentence_with_something_else_in_it_is_not(program: str) -> None:
    found = said(program)
    assert found
    assert not any(fix for code, fix in found if code == codes.SEVERAL_ORDERS.number)
    assert fixed(program, check).text.count("(") == 0


def test_a_turn_without_a_way_is_asked_for() -> None:
    program = "dobla, avanza 3 segundos y despues dobla"
    (found,) = check(program)
    assert found.code is codes.SEVERAL_ORDERS
    assert found.values["right"] == "R(2, 80);F(3, 80);R(2, 80)"
    assert message(found, Source(program), "en").fix.endswith(
        "with L in place of R where it turns left."
    )
    assert fixed(program, check).text == program, "which way is not guessed"


@pytest.mark.parametrize(
    ("program", "line"),
    [
        ("repite 4 veces avanza 1 segundo y gira a la derecha 1 segundo",
         "LOOP(4);F(1, 80);R(1, 80);END_LOOP"),
        ("si hay pared retrocede 1 segundo y gira a la derecha",
         "IF(DISTANCE < 10);B(1, 80);R(2, 80);ENDIF"),
        ("si no hay una pared avanza 1 segundo si no gira a la derecha",
         "IF(DISTANCE > 10);F(1, 80);ELSE;R(2, 80);ENDIF"),
        ("se tiver uma parede na frente, para e apita",
         "IF(DISTANCE < 10);S;BEEP(1, 440);ENDIF"),
        ("se a dist\u00e2ncia for maior que 20, vai pra frente",
         "IF(DISTANCE > 20);F(2, 80);ENDIF"),
        ("if there is a wall ahead turn right for 1 second", "IF(DISTANCE < 10);R(1, 80);ENDIF"),
        ("mientras no hay pared avanza 0.5 segundos",
         "WHILE(DISTANCE > 10);F(0.5, 80);END_WHILE"),
    ],
)  # fmt: skip
def test_orders_in_a_block_are_written_with_it(program: str, line: str) -> None:
    ((_, fix),) = said(program)
    assert fix == line


@pytest.mark.parametrize(
    "program",
    [
        "repite 4 veces avanza 1 segundo y luego pita",  # once, or four times
        "si hay pared a la derecha gira a la izquierda",  # DISTANCE looks ahead
        "si hay pared derecha y para",
    ],
)
def test_a_block_whose_orders_are_not_sure_is_not(program: str) -> None:
    assert all("END" not in fix for _, fix in said(program))


def test_a_block_that_goes_on_below_is_not_ended() -> None:
    found = said("si hay pared gira a la derecha\nsi no avanza")
    assert found[0][1] == "IF(DISTANCE < 10);R(2, 80)"


@pytest.mark.parametrize(
    ("program", "fix"),
    [
        ("go forward until you see a wall", "F(FOREVER, 80) UNTIL(DISTANCE < 10)"),
        ("cuando veas una pared para", "IF(DISTANCE < 10);S;ENDIF"),
        ("move(50, 50)", ""),  # two powers, and no move of 50 s
        ("move(2, 50)", "F(2, 50)"),
        ("avanza 2 minutos", "F(120, 80)"),
        ("avanzar 20 cm", "F(20 CM, 80)"),
        ("gira a la izquierda 45 grados al 50%", "L(45 DEG, 50)"),
        ("turn right 90 degrees", "R(90 DEG, 80)"),
        ("avanza 20 cm 3 s", ""),
        ("avanza 10 cm y retrocede 5 cm", "F(10 CM, 80);B(5 CM, 80)"),
        ("Hola robot, avanza 2 segundos y para", "F(2, 80);S"),
    ],
)
def test_what_one_sentence_gets(program: str, fix: str) -> None:
    ((_, found),) = said(program)
    assert found == fix
