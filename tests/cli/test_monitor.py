"""`tsc monitor` and a robot: its output, its files and its drawings."""

from __future__ import annotations

import json
import signal
from argparse import Namespace
from contextlib import nullcontext
from pathlib import Path
from random import Random
from types import SimpleNamespace
from typing import Any, cast

import pytest

from tests.support.command import Command, run_in_process
from tests.support.pty_robot import PtyRobot, on
from tests.support.terminal import Terminal
from tiniscript.cli.commands import monitor
from tiniscript.cli.commands.monitor_hold import _Log
from tiniscript.cli.errors import CommandError
from tiniscript.cli.robot.bookkeeping import BOOKKEEPING_MARK
from tiniscript.cli.robot.connect import Connection
from tiniscript.link.outcomes import LOST, Event, LostEvent, ShownEvent
from tiniscript.link.payloads import DoneEvent
from tiniscript.link.requests import OK


def test_monitor_writes_the_robots_values(pty_robot: PtyRobot, tmp_path: Path) -> None:
    rows = tmp_path / "rows.csv"
    assert (
        on(pty_robot, "upload", "-e", "SB|SHOW(1.5);W(0.1);SHOW(TRUE);X = 0;SHOW(1 / X)").code == 0
    )
    command = Command("monitor", "--port", pty_robot.port, "--csv", str(rows), "--json")
    assert command.process.stderr
    command.process.stderr.readline()  # waits until it watches
    pty_robot.push()
    pty_robot.until(
        lambda: "FAULT" in rows.read_text(encoding="utf-8"), "the fault is written down"
    )
    command.signal(signal.SIGINT)
    result = command.wait_for_result().gives(0)
    events = [json.loads(line) for line in result.out.splitlines()]
    assert [event["event"] for event in events] == ["SHOW", "SHOW", "FAULT"]
    assert [row.split(",")[1:] for row in rows.read_text(encoding="utf-8").splitlines()] == [
        ["event", "value", "name"], ["SHOW", "1.5", ""], ["SHOW", "TRUE", ""],
        ["FAULT", "DIVIDE_BY_ZERO", ""],
    ]  # fmt: skip


def test_monitor_keeps_the_last_rows_if_no_robot_answers(tmp_path: Path) -> None:
    rows = tmp_path / "rows.csv"
    rows.write_text("ms,event,value\n1,SHOW,5\n", encoding="utf-8")
    run_in_process(
        "monitor", "--port", tmp_path / "no-port", "--csv", rows, "--max-time", "1"
    ).gives(3)
    assert rows.read_text(encoding="utf-8") == "ms,event,value\n1,SHOW,5\n"


def test_a_silent_robot_leaves_the_last_rows(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    rows = tmp_path / "rows.csv"
    rows.write_text("ms,event,value\n1,SHOW,5\n", encoding="utf-8")

    def meet() -> None:
        raise CommandError(3, "link_silent")

    connection = nullcontext(SimpleNamespace(meet=meet))
    monkeypatch.setattr(monitor, "connect", lambda *_: connection)
    with pytest.raises(CommandError, match="link_silent"):
        monitor.run(Namespace(max_time=None, csv=str(rows), plot=False, json=False), "en")
    assert rows.read_text(encoding="utf-8") == "ms,event,value\n1,SHOW,5\n"


def test_monitor_draws_a_curve(pty_robot: PtyRobot) -> None:
    """The output is read as a terminal does: only the value in the title changes."""
    assert on(pty_robot, "upload", "-e", "SB|SHOW(-2.5);W(0.3);SHOW(7);W(0.3);SHOW(TRUE)").code == 0
    terminal = Terminal("monitor", "--port", pty_robot.port, "--plot", types=False)
    terminal.until("── SHOW")
    pty_robot.push()
    terminal.until(r"(?s)── SHOW 1 .*Done\.|Done\..*── SHOW 1 ")
    terminal.interrupt()
    assert terminal.end() == 0
    output = terminal.output_bytes.decode()
    assert "SHOW -2.5" in output and "SHOW TRUE" in output
    assert any("⠀" < letter <= "⣿" for letter in output)
    assert output.endswith("\n")


@pytest.mark.parametrize("values", [[], [(0, 5)], [(0, -5), (900, 7000), (20_000, 7000)]])
def test_every_curve_fits_its_terminal(values: list[tuple[int, int]]) -> None:
    from tiniscript.cli.terminal.plot import Plot

    plot = Plot("todavía ningún valor")
    title = plot.lines(80, 8, 0)[0].plain
    assert title.startswith("── SHOW todavía ningún valor ──")
    for time_ms, value in values:
        plot.add_value(time_ms, value, is_yes_no=False)
    for now_ms in (20_000, 45_000, 90_000):
        for width in (1, 2, 5, 8, 20, 80, 200):
            for height in (1, 2, 3, 8, 50):
                lines = plot.lines(width, height, now_ms)
                assert 1 <= len(lines) <= height
                assert all(line.cell_len <= width for line in lines)


def test_monitor_survives_a_full_disk(pty_robot: PtyRobot, tmp_path: Path) -> None:
    files = [Path("/dev/full"), tmp_path, tmp_path / "no" / "such"]
    for file in files if files[0].exists() else files[1:]:
        on(pty_robot, "monitor", "--csv", file, "--max-time", "1").gives(2, "--csv", out="")
    assert on(pty_robot, "monitor", "--max-time", "1").code == 0


@pytest.mark.parametrize("seed", range(20))
def test_a_robot_that_is_lost_is_found_whenever_it_comes_back(
    capsys: pytest.CaptureFixture[str], seed: int
) -> None:
    """This holds for any number of losses and unanswered searches; each robot is found once.
    Values that `tsc live` makes it show are not printed."""
    rng = Random(seed)
    searches: list[Any] = []
    is_reachable, losses, wait_count = True, 0, 0
    # The last one comes first: a value, the mark and a value after it, and a value of the next run.
    values = 8000, None, 5000, BOOKKEEPING_MARK, 7000
    bookkeeping: list[Event] = [
        DoneEvent(1) if value is None else ShownEvent(value, False) for value in values
    ]

    class Over(Exception):
        pass

    def event() -> tuple[int, Event] | None:
        nonlocal is_reachable, losses, wait_count
        wait_count += 1
        if wait_count > 400:
            raise Over
        if is_reachable:
            if losses < 5 and rng.random() < 0.1:
                is_reachable, losses = False, losses + 1
                return wait_count, LostEvent()
            if losses < 5 or not bookkeeping:
                return None
            return wait_count, bookkeeping.pop()
        questions = [search for search in searches if search.outcome is None]
        assert len(questions) == 1, "nobody looks for it"
        if rng.random() < 0.3:
            is_reachable = rng.random() < 0.3
            questions[0].outcome = SimpleNamespace(status=OK if is_reachable else LOST)
        return None

    def search() -> Any:
        searches.append(SimpleNamespace(outcome=None))
        return searches[-1]

    connection = SimpleNamespace(language="en", name="TINI", port="p", event=event, search=search)
    with pytest.raises(Over):
        _Log(cast(Connection, connection), is_json=True).print_events()
    event_names = [json.loads(line)["event"] for line in capsys.readouterr().out.splitlines()]
    assert losses == 5
    assert event_names == ["LINKED", *["LOST", "FOUND"] * 5, "SHOW", "DONE", "SHOW"]
