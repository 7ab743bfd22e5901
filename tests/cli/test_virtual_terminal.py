"""The virtual robot on a real pseudo-terminal: the visible output, and the effects of keys."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from tests.support.command import run_subprocess
from tests.support.terminal import Terminal

SIZE = (90, 30)


def test_upload_draws_the_world_and_the_way(tmp_path: Path) -> None:
    program = tmp_path / "drive.ts"
    program.write_text("SI|F(0.6, 80)\nSHOW(DISTANCE)\nX = 0; SHOW(1 / X)", encoding="utf-8")
    terminal = Terminal("upload", program, "--virtual", "--world", "light", size=SIZE)
    terminal.until(r"left motor +80 %")
    assert terminal.end() == 1
    lines = terminal.lines()
    drawn_text = "\n".join(lines)
    assert "── TiniBot ── lamps in the dark ──" in drawn_text
    assert re.search(r"time +0\.6\d* s +fault", drawn_text)
    assert re.search(r"DISTANCE +154\.5 cm +distance sensor", drawn_text)
    assert re.search(r"SHOW +154\.5", drawn_text)
    assert "→" in drawn_text
    assert drawn_text.count("*") == 2  # the lamps
    assert "The virtual robot drove 22 cm" in drawn_text
    assert "fault DIVIDE_BY_ZERO" in drawn_text
    assert terminal.output_bytes.rfind(b"\x1b[?25h") > terminal.output_bytes.rfind(
        b"\x1b[?25l"
    )  # cursor


def test_keys_push_the_buttons_of_the_robot(tmp_path: Path) -> None:
    memory = tmp_path / "kept.bin"
    terminal = Terminal("robot", "--memory", memory, "--lang", "es", size=SIZE)
    terminal.until("q: terminar   b: botón   h: botón 2 s   r: reinicio   p: apagar y encender")
    terminal.until("todavía sin programa")
    run_subprocess("upload", "--virtual", "-e", "SB|LOOP(FOREVER);L(1, 40);END_LOOP").gives(0)
    terminal.until("su botón lo inicia")
    terminal.type("b")
    terminal.until(r"motor der\. +40 %")
    terminal.type("b")
    terminal.until(r"s +detenido")
    # Below the picture, because the next one is of the next run.
    terminal.until(r"motor der\. +0 %")
    terminal.type("r")
    terminal.type("b")
    terminal.until(r"motor der\. +40 %")
    terminal.type("p")
    terminal.until(r"s +apagado")
    terminal.type("q")
    assert terminal.end() == 0
    assert "El robot virtual recorrió 0 cm" in "\n".join(terminal.lines())


@pytest.mark.parametrize("is_wanted", [True, False])
def test_without_a_robot_the_virtual_one_is_offered(is_wanted: bool) -> None:
    """Without any port, it asks; otherwise the robot is listed as a port."""
    terminal = Terminal("upload", "-e", "SI|F(0.1, 50)", size=SIZE)
    match = terminal.until(r"\[Y/n\]|(\d+) +\S[^\n]*\nNumber in the list:")
    if match[1]:
        terminal.type(f"{match[1]}\n" if is_wanted else "\x04")
    else:
        terminal.type("\n" if is_wanted else "n\n")
    assert terminal.end() == (0 if is_wanted else 3)
    drawn_text = "\n".join(terminal.lines())
    assert ("The virtual robot drove" in drawn_text) == is_wanted


def test_the_button_of_a_program_that_waits_is_a_key() -> None:
    terminal = Terminal("upload", "-e", "SB|F(30, 80)", "--virtual", "--lang", "es", size=SIZE)
    terminal.until(r"s +su botón lo inicia")
    terminal.until("b: botón de inicio +q: terminar")
    terminal.type("b")
    terminal.until(r"motor izq\. +80 %")
    terminal.type("b")
    terminal.until(r"s +detenido")
    terminal.until("El robot se detuvo con su botón")
    terminal.type("b")  # the second press
    terminal.until(r"motor izq\. +80 %")
    terminal.type("q")
    assert terminal.end() == 0
    drawn_text = "\n".join(terminal.lines())
    assert re.search(r"motor izq\. +0 %", drawn_text)
    assert re.search(r"s +apagado", drawn_text)
    assert "b: botón" not in drawn_text  # the key has no effect any more


def test_a_program_that_waits_ends_when_it_has_ended_or_its_time_is_over() -> None:
    terminal = Terminal("upload", "-e", "SB|F(0.2, 80)", "--virtual", size=SIZE)
    terminal.until("q: end")
    terminal.type("xb")
    assert terminal.end() == 0
    assert "Done." in "\n".join(terminal.lines())
    terminal = Terminal("upload", "-e", "SB|F(0.2, 80)", "--virtual", "--for", "1", size=SIZE)
    assert terminal.end() == 0  # the button was not pressed
    assert "The virtual robot drove 0 cm in 0.0 s" in "\n".join(terminal.lines())


def test_after_ctrl_c_the_motors_are_also_off_in_the_picture() -> None:
    terminal = Terminal("upload", "-e", "SI|F(30, 80)", "--virtual", size=SIZE)
    terminal.until(r"left motor +80 %")
    terminal.interrupt()
    assert terminal.end() == 2
    drawn_text = "\n".join(terminal.lines())
    assert re.search(r"left motor +0 %", drawn_text)
    assert re.search(r"s +stopped", drawn_text)
    assert "80 %" not in drawn_text


def test_the_prompt_shows_only_requested_values() -> None:
    terminal = Terminal("live", "--virtual", size=SIZE)
    terminal.until("tini>")
    terminal.type("X = 5; SHOW(7)\n")
    terminal.until("SHOW +7")
    terminal.until(r"tini>\s*$")
    terminal.type("help\n")
    terminal.until("The robot has LIGHT_R, LIGHT_L, DISTANCE")
    terminal.type("quit\n")
    assert terminal.end() == 0
    assert b"2147483" not in terminal.output_bytes
    assert b"before" not in terminal.output_bytes
