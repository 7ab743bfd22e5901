"""Every command that talks to a robot on a faulty line ends and names its waits; nothing
contradicts or repeats earlier output, and the next try works.

`python -m tests.between.test_commands 100 --seed 1` draws commands, faults and moments, and prints
how long each command was silent, and how long it took; a second figure is that of the line that is
right. With `--whole`, each command meets each fault, once for each seed; with `--clients`, only
those of a shared port; with `--esp32`, those with an ESP32.
"""

from __future__ import annotations

import os
import re
import signal
import sys
import tempfile
from collections import defaultdict
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from functools import lru_cache
from pathlib import Path
from random import Random
from typing import NamedTuple

import pytest

from tests.between.lines import (
    ESP32,
    FAULTS,
    KIT,
    BadEsp32Line,
    BadLine,
    BehindBadLine,
    Fault,
)
from tests.between.telling import CLOCK, Teller, own_folders
from tests.support.campaign import make_options
from tests.support.command import FOREVER, LONG_PROGRAM
from tests.support.pty_robot import PtyRobot, on

LONGEST_SILENCE_S = 3.0  # longest silence allowed
TOLERANCE_S = 0.5  # tolerance before a message counts as late
WORKERS = 8
LONGEST_END_S = 45.0  # the longest search for a robot, a request of 20 s, and a stop
LONGEST_SLOW_END_S = 240.0  # over a line that lets little through
LONGEST_STOP_S = 12.0  # time from Ctrl-C to the end
DEAD_MAN_S = 3.0  # time after which a robot without a computer stops
SHORT_PROGRAM = "SI|F(0.3, 80)"
CONFIRMED_STOP = re.compile(r"[Ss]topped the robot.*confirmed it|has confirmed|: stopped")
UNCONFIRMED_STOP = re.compile(r"has not confirmed the stop")


class Words(NamedTuple):
    """A command; `stays`: until Ctrl-C; `is_client`: `tsc monitor --hold` has the port."""

    name: str
    words: tuple[str, ...]
    stays: bool = False
    takes_s: float = 0.0  # time that the command takes by itself
    may_fail: bool = False  # whatever the state of the line
    is_client: bool = False
    robot: tuple[str, ...] = ()


COMMANDS = (
    Words("upload", ("upload", "-e", SHORT_PROGRAM)),
    Words("upload, long", ("upload", "-e", f"SI|{LONG_PROGRAM}")),
    Words("upload --detach", ("upload", "--detach", "-e", SHORT_PROGRAM)),
    Words("upload, Ctrl-C", ("upload", "-e", FOREVER), stays=True),
    Words("start", ("start",)),
    Words("live LINE", ("live", "F(0.3, 80)")),
    Words("live, Ctrl-C", ("live", "M(80, 80); W(9); M(0, 0)"), stays=True),
    Words("stop", ("stop",)),
    Words("monitor, Ctrl-C", ("monitor",), stays=True),
    Words("monitor --hold, Ctrl-C", ("monitor", "--hold"), stays=True),
    Words("start --previous", ("start", "--previous"), may_fail=True),
    Words("doctor --identify", ("doctor", "--identify")),
    Words("show --port", ("show",)),
    Words("set name", ("set", "name", "TINI")),
    Words("set trim --show", ("set", "trim", "--show")),
    Words("set trim --balance", ("set", "trim", "--balance", "3")),
    Words("set text", ("set", "text", "on")),
    Words("set owner", ("set", "owner"), takes_s=30.0, may_fail=True),
    Words("set owner --give-up", ("set", "owner", "--give-up")),
    Words("doctor --selftest --yes", ("doctor", "--selftest", "--yes"), may_fail=True),
    Words("doctor --yes", ("doctor", "--yes"), may_fail=True),
)
COMMANDS_BY_NAME = {words.name: words for words in COMMANDS}
CLIENT_COMMANDS = tuple(
    COMMANDS_BY_NAME[name]._replace(name=f"{name}, beside monitor --hold", is_client=True)
    for name in ("upload", "upload, Ctrl-C", "start", "live LINE", "stop", "doctor --yes")
)
ESP32_COMMANDS = tuple(
    words._replace(name=f"{words.name}, ESP32", robot=("--robot", ESP32))
    for words in (
        *(
            COMMANDS_BY_NAME[name]
            for name in ("upload", "upload, long", "upload, Ctrl-C", "live LINE")
        ),
        Words("live LONG LINE", ("live", "; ".join(f"SHOW(TIME * 1.234 + {k})" for k in range(6)))),
        *(COMMANDS_BY_NAME[name] for name in ("stop", "doctor --yes", "set name")),
    )
)
ALL_COMMANDS = (*COMMANDS, *CLIENT_COMMANDS, *ESP32_COMMANDS)


class TriedCommand(NamedTuple):
    """The result of one command."""

    name: str
    fault: str
    silence_s: float
    duration_s: float  # time to its end, counted from Ctrl-C if it stays
    wrong: tuple[str, ...]
    output: str


@lru_cache(maxsize=1)
def with_program() -> bytes:
    """The memory of a robot that holds a program."""
    with tempfile.TemporaryDirectory() as folder, pytest.MonkeyPatch.context() as patch:
        for name, value in own_folders(folder).items():
            patch.setenv(name, value)
        with PtyRobot(KIT) as robot:
            on(robot, "upload", "-e", SHORT_PROGRAM).gives(0, out="Saved.")
            robot.switch_off()
            return robot._memory


def try_command(words: Words, fault: Fault, seed: int) -> TriedCommand:
    """Run a command on a line with a fault, then another one on the repaired line."""
    rng = Random(f"{words.name} {fault.name} {seed}")
    with ExitStack() as stack:
        folder = stack.enter_context(tempfile.TemporaryDirectory())
        env = own_folders(folder)
        choice_after = rng.choice((0, 1, 12, 30, 60, 150))
        line = _make_line(words, fault, rng, choice_after)
        stack.callback(line.clear_away)
        holder = _start_holder(line, env, stack) if words.is_client else None
        teller = Teller([*words.words, *words.robot, "--port", line.port], env)
        stack.callback(teller.end)
        if holder is not None:
            line.begin(fault, choice_after)
        has_ended = _play_fault(teller, line, words, rng, holder)
        faults = [] if has_ended else ["it has no end"]
        if not has_ended:
            teller.process.kill()
            teller.wait(LONGEST_END_S)
        faults += _contradictions(teller, line, words)
        if fault.has_end or not fault.pulls:
            faults += _next_try(line, env, words)
        prompt_times_s = [at_s for at_s, text in teller.timed_output if not text]
        began_s = prompt_times_s[0] if prompt_times_s else teller.began_s
        assert teller.ended_s is not None
        return TriedCommand(words.name, fault.name, teller.longest_silence_s(),
                     teller.ended_s - began_s, tuple(faults), teller.text)  # fmt: skip


def _make_line(words: Words, fault: Fault, rng: Random, after: int) -> BehindBadLine:
    if words.robot:
        return BadEsp32Line(fault, rng, after)
    return BadLine(Fault("nothing") if words.is_client else fault, rng, after, with_program())


def _start_holder(line: BehindBadLine, env: dict[str, str], stack: ExitStack) -> Teller:
    """Start `tsc monitor --hold` on the port, which meets its robot before the fault."""
    holder = Teller(["monitor", "--hold", "--port", line.port], env)
    stack.callback(holder.end)
    end_s = CLOCK.now_s + LONGEST_END_S
    while not holder.has_said("Ctrl-C"):
        assert CLOCK.now_s < end_s, holder.text
        CLOCK.wait(0.05)
    return holder


def _play_fault(
    teller: Teller, line: BehindBadLine, words: Words, rng: Random, holder: Teller | None
) -> bool:
    """Apply the fault with a person present; return whether the command has ended. If there are two
    commands, the holder of the port is suspended.
    """
    fault = line.fault
    is_slow = fault.rate or fault.lost or fault.late_ms
    timeout_s = (
        LONGEST_SLOW_END_S if is_slow else LONGEST_END_S + fault.held_ms % 10**9 / 1000
    ) + words.takes_s
    end_s = CLOCK.now_s + timeout_s
    leaves_s = rng.choice((1.0, 6.0, 15.0)) if words.stays else timeout_s
    has_begun = teller.has_socket if words.is_client else lambda: line.is_used
    while not has_begun() and teller.ended_s is None and CLOCK.now_s < end_s:
        CLOCK.wait(0.01)
    teller.began_s = CLOCK.now_s
    while not line.has_begun and teller.ended_s is None and CLOCK.now_s < end_s:
        CLOCK.wait(0.01)
    if fault.pulls:
        line.pull()
    if fault.suspends and teller.ended_s is None:
        began_s, slept_teller = CLOCK.now_s, holder or teller
        slept_teller.process.send_signal(signal.SIGSTOP)
        CLOCK.wait(fault.held_ms / 1000)
        slept_teller.suspended.append((began_s, CLOCK.now_s))
        slept_teller.process.send_signal(signal.SIGCONT)
    if words.stays and not teller.wait(leaves_s):
        teller.interrupt()
        return teller.wait(LONGEST_STOP_S + 2 * fault.late_ms / 1000 + (30 if fault.rate else 0))
    return teller.wait(max(0.1, end_s - CLOCK.now_s))


def _contradictions(teller: Teller, line: BehindBadLine, words: Words) -> list[str]:
    """Return repeated and false statements of the output."""
    lines, code, fault = teller.shown_lines, teller.process.returncode, line.fault
    contradictions = [f"said twice: {sentence}" for sentence in teller.repeated_lines()]
    if "Traceback" in teller.text:
        contradictions.append("a traceback")
    is_confirmed = any(map(CONFIRMED_STOP.search, lines))
    is_unconfirmed = any(map(UNCONFIRMED_STOP.search, lines))
    if is_confirmed and is_unconfirmed:
        contradictions.append("a stop is both")
    if code and not lines:
        contradictions.append("an exit code without a word")
    is_heard = fault.name in ("nothing", "late", "slow", "loses")  # heard while a program runs, too
    if is_heard and not words.may_fail and code not in ((0, 2) if words.stays else (0,)):
        contradictions.append(f"exit code {code}")
    if fault.pulls:
        return contradictions
    if not words.name.startswith("upload --detach"):
        CLOCK.wait(0 if is_confirmed or not line.moves else DEAD_MAN_S)
        if line.moves:
            contradictions.append("it moves")
    return contradictions


def _next_try(line: BehindBadLine, env: dict[str, str], words: Words) -> list[str]:
    line.mend()
    CLOCK.wait(0.2)
    teller = Teller(["upload", "-e", SHORT_PROGRAM, *words.robot, "--port", line.port], env)
    teller.wait(LONGEST_END_S)
    code = teller.end()
    return [] if code == 0 else [f"the next try: {code}, {teller.shown_lines}"]


def list_faults(command: TriedCommand, room_s: float = TOLERANCE_S) -> list[str]:
    was_silent_too_long = command.silence_s > LONGEST_SILENCE_S + room_s
    return [
        *command.wrong,
        *([f"silent for {command.silence_s:.1f} s"] if was_silent_too_long else []),
    ]


def try_all(rows: Sequence[tuple[Words, Fault, int]]) -> list[TriedCommand]:
    with_program()
    with ThreadPoolExecutor(WORKERS) as pool:
        return list(pool.map(lambda row: try_command(*row), rows))


def print_table(commands: Sequence[TriedCommand]) -> None:
    """Print the table: of each command the worst of each figure, and in which fault it was."""
    rows: dict[str, list[TriedCommand]] = defaultdict(list)
    for tried_command in commands:
        rows[tried_command.name].append(tried_command)
    print("| command | tries | longest silence, s | to its end, s |\n|---|---:|---:|---:|")
    for command in ALL_COMMANDS:
        if tried_commands := rows[command.name]:
            quiet = max(tried_commands, key=lambda tried_command: tried_command.silence_s)
            slowest = max(tried_commands, key=lambda tried_command: tried_command.duration_s)
            print(f"| `{command.name}` | {len(tried_commands)} |"
                  f" {quiet.silence_s:.1f} ({quiet.fault}) |"
                  f" {slowest.duration_s:.1f} ({slowest.fault}) |")  # fmt: skip


def draw_cases(
    count: int, seed: int, is_whole: bool, among: Sequence[Words] = ALL_COMMANDS
) -> list[tuple[Words, Fault, int]]:
    if is_whole:
        return [(words, fault, seed + k) for k in range(count)
                for fault in FAULTS for words in among]  # fmt: skip
    rows = []
    for k in range(seed, seed + count):
        rng = Random(k)
        rows.append((rng.choice(among), rng.choice(FAULTS), k))
    return rows


def test_a_sample_of_commands_keeps_the_laws_behind_bad_lines(
    request: pytest.FixtureRequest,
) -> None:
    from tests.support import sampling

    seed = Random(sampling.seed(request.config)).randrange(10**6)
    commands = try_all(draw_cases(SAMPLE_SIZE, seed, is_whole=False))
    faults_by_name = {
        f"{tried_command.name}, {tried_command.fault}": (
            list_faults(tried_command, TOLERANCE_IN_CI_S),
            tried_command.output,
        )
        for tried_command in commands
    }
    assert not {name: faults for name, faults in faults_by_name.items() if faults[0]}


@pytest.mark.parametrize(("name", "after_s"), [
    ("nothing", 0.2), ("nothing", 0.05), ("nothing", 0.02), ("very late", 0.2),
    ("robot hears nothing", 0.2),
])  # fmt: skip
def test_a_second_ctrl_c_ends_the_wait_without_a_second_message(
    name: str, after_s: float, tmp_path: Path
) -> None:
    """The waits are for the stop, and for the save after it."""
    fault = next(fault for fault in FAULTS if fault.name == name)
    with ExitStack() as stack:
        line = BadLine(Fault("nothing"), Random(1), 0)
        stack.callback(line.clear_away)
        teller = Teller(["upload", "-e", FOREVER, "--port", line.port], own_folders(str(tmp_path)))
        stack.callback(teller.end)
        line.until(lambda: line.moves and teller.has_said(": running"), "it drives")
        line.begin(fault)
        teller.interrupt()
        CLOCK.wait(after_s)
        teller.interrupt()
        assert teller.wait(LONGEST_STOP_S)
        outcomes = [
            line
            for line in teller.shown_lines
            if CONFIRMED_STOP.search(line) or UNCONFIRMED_STOP.search(line)
        ]
        assert len(outcomes) == 1 and not teller.repeated_lines(), teller.text
        line.until(lambda: not line.moves, "it stands")


SAMPLE_SIZE = 6
TOLERANCE_IN_CI_S = 2.0  # processes start slowly when others run


if __name__ == "__main__":
    options = make_options(100, 1, "whole", "clients", "esp32")
    candidates = (
        CLIENT_COMMANDS if options.clients else ESP32_COMMANDS if options.esp32 else ALL_COMMANDS
    )
    began_s = CLOCK.now_s
    commands = try_all(draw_cases(options.count, options.seed, options.whole, candidates))
    print_table(commands)
    faults_by_command = [(tried_command, list_faults(tried_command)) for tried_command in commands]
    for tried_command, reasons in faults_by_command:
        if reasons:
            print(
                f"\n{tried_command.name}, {tried_command.fault}: {'; '.join(reasons)}\n"
                f"{tried_command.output}"
            )
    process_times = os.times()
    print(f"\n{len(commands)} tried, {sum(bool(faults) for _, faults in faults_by_command)} wrong; "
          f"{CLOCK.now_s - began_s:.0f} s, "
          f"{sum(process_times[:4]):.0f} s of a processor")  # fmt: skip
    sys.exit(any(faults for _, faults in faults_by_command))
