"""`tsc run --show` on a real pseudo-terminal: the visible output, and the content of a file.

No test here measures time: code that depends on it gets its own clock.
"""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import pytest

from tests.support.command import FOREVER, run_in_process
from tests.support.terminal import Terminal
from tiniscript import compile_text, robots
from tiniscript.base.trace import Ending, Event, Senses
from tiniscript.cli.terminal import FRAME_S, run_drawing, sketch, world_drawing
from tiniscript.cli.terminal import screen as terminal_screen
from tiniscript.virtual import worlds
from tiniscript.virtual.robot import Settings, VirtualRobot
from tiniscript.vm.runner import run

OBSTACLES = (
    "SI|START;LOOP(FOREVER);F(1, 80) UNTIL(DISTANCE < 10);IF(DISTANCE < 10);STOP;R(1, 60);"
    "ENDIF;END_LOOP"
)
SENSOR_OPTIONS = ["--sensor", "DISTANCE=50,9,50,30,8,50", "--max-time", "4"]
GRABBER = (
    "SI|LED(TRUE);GRIPPER(90);M(50, 80);W(1);TEMPERATURE;BUTTON;SHOW(1.5);SHOW(BUTTON);"
    "BEEP(5, 440);B(0.5, 30)"
)
HIDE_CURSOR, SHOW_CURSOR = b"\x1b[?25l", b"\x1b[?25h"


def run_to_end(
    *words: str, code: int = 0, size: tuple[int, int] = (80, 24),
    output: Path | None = None, env: dict[str, str] | None = None,
) -> Terminal:  # fmt: skip
    """Run `tsc run --show` to its end."""
    terminal = Terminal("run", *words, "--show", size=size, output=output, env=env, types=False)
    assert terminal.end() == code
    return terminal


def plain_output(*arguments: str) -> str:
    """Return the output of `tsc run` without a terminal."""
    return run_in_process("run", *arguments).out


def row(lines: list[str], name: str) -> list[str]:
    """Return the words of the line that begins with `name`, among the text next to the path."""
    return next(line[line.index(name) :].split() for line in lines if f"{name} " in line)


def picture(lines: list[str]) -> list[str]:
    """The last picture: from its title on."""
    return lines[max(k for k, line in enumerate(lines) if line.startswith("──")) :]


# ---- drawing


@pytest.mark.parametrize(
    ("pace", "size"), [("0", (80, 24)), ("20", (80, 24)), ("20", (40, 15)), ("20", (24, 6))]
)
def test_the_trace_stands_above_the_picture(pace: str, size: tuple[int, int]) -> None:
    """The picture shows the path in color, and the values next to it or below; the cursor
    reappears."""
    terminal = run_to_end("-e", OBSTACLES, *SENSOR_OPTIONS, "--pace", pace, size=size)
    written_bytes, lines = terminal.output_bytes, terminal.whole()
    if pace != "0":  # in that case the picture is drawn once
        assert written_bytes.count(HIDE_CURSOR) == 1 and written_bytes.rindex(
            SHOW_CURSOR
        ) > written_bytes.rindex(HIDE_CURSOR)
    trace = plain_output("-e", OBSTACLES, *SENSOR_OPTIONS).splitlines()
    top = next(k for k in range(len(lines)) if lines[k].startswith("0 "))
    assert lines[top : top + len(trace)] == trace
    drawn_lines = picture(lines)
    assert lines[top + len(trace) :] == drawn_lines and drawn_lines[0].startswith("── TiniBot")
    if size[0] >= 40:
        assert b"\x1b[36m" in written_bytes
        picture_rows = drawn_lines if size[0] == 80 else drawn_lines[1:8]
        assert any(arrow in line for line in picture_rows for arrow in sketch.ARROWS)
        assert any("⠀" < c <= "⣿" for line in picture_rows for c in line)
        assert row(drawn_lines, "DISTANCE") == ["DISTANCE", "50", "cm", "distance", "sensor"]
        assert row(drawn_lines, "time") == ["time", "4", "s", "hit", "the", "limit"]
        assert row(drawn_lines, "left motor")[2] == "0"


def test_a_file_gets_the_trace_byte_for_byte(tmp_path: Path) -> None:
    file = tmp_path / "trace"
    terminal = run_to_end("-e", OBSTACLES, *SENSOR_OPTIONS, "--pace", "20", output=file)
    assert file.read_bytes() == plain_output("-e", OBSTACLES, *SENSOR_OPTIONS).encode()
    assert b"MOTORS" not in terminal.output_bytes
    assert picture(terminal.whole())[0].startswith("── TiniBot")


def test_actuators_shown_values_and_yes_no_are_drawn() -> None:
    terminal = run_to_end("-e", GRABBER, "--robot", "grabber", "--pace", "10")
    lines = picture(terminal.whole())
    assert row(lines, "GRIPPER") == ["GRIPPER", "90", "°", "gripper"]
    assert row(lines, "LED") == ["LED", "TRUE", "lamp"]
    assert row(lines, "BUTTON")[:2] == ["BUTTON", "FALSE"]
    assert row(lines, "SHOW") == ["SHOW", "FALSE", "before:", "1.5"]
    assert row(lines, "time")[-1] == "done"
    assert "♪ 440 Hz".encode() in terminal.output_bytes  # shown while the tone sounded
    assert not any("♪" in line for line in lines)


def test_a_terminal_without_color_or_braille_gets_plain_signs_in_its_language() -> None:
    env = {"PYTHONIOENCODING": "latin-1", "NO_COLOR": "1"}
    terminal = run_to_end("-e", OBSTACLES, *SENSOR_OPTIONS, "--pace", "10", "--lang", "es", env=env)
    output = terminal.output_bytes.decode("latin-1")
    assert "[36m" not in output and "\\u28" not in output and "*" in output
    assert "en el límite" in output and "sensor de distancia" in output


def test_a_fault_is_in_the_picture_and_explained_below_it() -> None:
    terminal = run_to_end("-e", "SI|F(1, 50);X = 0;Y = 1 / X", "--pace", "10", code=1)
    lines = picture(terminal.whole())
    assert row(lines, "time")[-1] == "fault"
    assert any(line.startswith("fault DIVIDE_BY_ZERO") for line in lines)


def test_without_a_terminal_there_is_no_picture() -> None:
    result = run_in_process("run", "-e", OBSTACLES, *SENSOR_OPTIONS, "--show")
    assert (result.code, result.out) == (0, plain_output("-e", OBSTACLES, *SENSOR_OPTIONS))
    assert "TiniBot" not in result.err


# ---- how it ends


@pytest.mark.parametrize("writes_to_file", [False, True])
def test_ctrl_c_leaves_a_clean_terminal(writes_to_file: bool, tmp_path: Path) -> None:
    words = ("run", "-e", FOREVER, "--max-time", "1000000", "--show")
    output = tmp_path / "trace" if writes_to_file else None
    terminal = Terminal(*words, output=output, types=False)
    terminal.until("↑")
    terminal.interrupt()
    assert terminal.end() == 2
    assert terminal.output_bytes.rindex(SHOW_CURSOR) > terminal.output_bytes.rindex(HIDE_CURSOR)
    lines = terminal.whole()
    assert lines[-lines[::-1].index("Stopped.") - 1 :].count("Stopped.") == 1
    assert not any("Traceback" in line for line in lines)


# ---- in pieces, with a clock of its own


def events_of(program: str, robot_name: str = "tinibot") -> list[Event | Ending]:
    robot = robots.load(robot_name)
    compilation = compile_text(program, robot.kit)
    assert compilation.is_right
    number = [device.name for device in robot.kit.sensors].index("DISTANCE")
    return list(run(compilation.code, robot.kit, Senses(robot.kit, {number: [50_000]}), 3000))


def frames(events: list[Event | Ending], pace: float, monkeypatch: pytest.MonkeyPatch) -> int:
    """Watch these events with a clock that only sleeping moves; return the number of drawings."""
    clock = SimpleNamespace(now_s=100.0)
    clock.monotonic = lambda: clock.now_s
    clock.sleep = lambda seconds: setattr(clock, "now_s", clock.now_s + seconds)
    draw_times_ms: list[float] = []
    monkeypatch.setattr(terminal_screen, "time", clock)
    monkeypatch.setattr(
        terminal_screen.Screen, "draw", lambda self, screen, now_ms: draw_times_ms.append(now_ms)
    )
    assert run_drawing.watch(iter(events), robots.load("tinibot"), pace, "en") == events[-1]
    assert draw_times_ms == sorted(draw_times_ms)
    if pace:
        passed_ms = (clock.now_s - 100) * 1000 * pace
        assert 3000 <= passed_ms <= 3000 + 1000 * pace * FRAME_S * 1.01
    return len(draw_times_ms)


def test_the_checks_of_until_do_not_add_frames(monkeypatch: pytest.MonkeyPatch) -> None:
    watched_endings = events_of("SI|F(3, 80) UNTIL(DISTANCE < 10)")
    assert len(watched_endings) > 150
    assert frames(watched_endings, 1, monkeypatch) == frames(
        events_of("SI|F(3, 80)"), 1, monkeypatch
    )
    assert frames(watched_endings, 1, monkeypatch) in (46, 47)
    assert frames(watched_endings, 10, monkeypatch) <= 6
    assert frames(watched_endings, 0, monkeypatch) == 1


@pytest.mark.parametrize("language", ["en", "es"])
def test_every_picture_fits_its_terminal(language: str) -> None:
    robot = robots.load("grabber")
    for width in (1, 2, 5, 19, 20, 39, 40, 59, 60, 61, 80, 200):
        for height in (1, 2, 3, 4, 5, 8, 12, 18, 50):
            picture = run_drawing.Picture(robot, language)
            for event in events_of(GRABBER, "grabber")[:-1]:
                assert isinstance(event, Event)
                picture.add_event(event)
                lines = picture.lines(width, height, event.time_ms)
                assert 1 <= len(lines) <= height
                assert all(line.cell_len <= width for line in lines)


def test_values_stand_beside_the_floor_on_a_wide_terminal() -> None:
    """The distance is the same at 100 and 200 columns, and constant while the robot drives."""
    robot = VirtualRobot(robots.load("tinibot"), worlds.load("obstacles"), Settings())
    picture = world_drawing.WorldPicture(robot, "es")
    places = {}
    for width in (60, 100, 200):
        lines = [line.plain for line in picture.lines(width, 16, 0)]
        places[width] = lines[1].index("tiempo")
        assert all(len(line) <= width for line in lines)
        assert lines[1][: places[width]].rstrip()[-1] > "\u2800"  # the floor's right wall
        assert lines[1][: places[width]].endswith("  ")
        assert any(line.endswith("sensor de luz izquierdo") for line in lines) == (width > 60)
    assert places[100] == places[200]


def test_a_long_path_stays_in_view_and_in_bounded_memory(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sketch, "MAX_CORNERS", 100)
    long_sketch = sketch.Sketch(robots.load("tinibot"))
    for k in range(3000):
        long_sketch.set_motors(k * 500, 60 + k % 30, 90 - k % 41)
        if k % 10 == 0:
            drawn_text = "\n".join(line.plain for line in long_sketch.draw(30, 12, k * 500))
            assert any(arrow in drawn_text for arrow in sketch.ARROWS)
            assert len(long_sketch.way.corners) <= 100


@pytest.mark.parametrize(("percent", "bar"), [
    (0, "     │     "), (100, "     │█████"), (-100, "█████│     "), (1, "     │▌    "),
    (-50, "  ▐██│     "), (80, "     │████ "),
])  # fmt: skip
def test_a_bar_shows_amount_and_direction(percent: int, bar: str) -> None:
    assert run_drawing._bar(percent) == bar
