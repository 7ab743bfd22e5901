"""A typed stop on a simulated Uno: in every state of the receiver, in all spellings, at both rates.

It reaches the motor pins less than a millisecond after the end of its line, or, if the bytes began
as a frame, less than a millisecond after 100 ms of silence; there, only the strict spellings count.
Text before it starts nothing afterwards.
`python -m tests.firmware.test_typed_stops 10000` types it after so many random bytes.
"""

from __future__ import annotations

import random
import shutil
import tempfile
from collections.abc import Callable, Iterator
from contextlib import nullcontext
from pathlib import Path

import pytest

from tests.machines.host import make_once
from tests.machines.uno import skip_unless_available
from tests.machines.wired import Wired
from tests.support.campaign import make_options
from tests.support.images import image_of
from tests.support.platformio import firmware, shared_folder
from tests.support.robot_on_uno import FORWARD, KIT, NAMES, OBSTACLE_LINES, OFF, states
from tests.support.stop_spellings import (
    ALL_PREFIXES,
    FRAME_PREFIXES,
    MAX_MS,
    RUNNING_LINE,
    SHORTEST_STOP_MS,
    SILENCE_MS,
    STRICT_SPELLINGS,
    spellings_after,
)
from tiniscript.link.requests import OK
from tiniscript.link.session import Session
from tools.bench.link import build
from tools.uno import CYCLES_PER_MS, Uno

BAUDS = (9600, 115_200)
TURN_MS = 2.1  # the clock counts one or two milliseconds each 1.024 ms
BUSY_TURN_MS = 5.0  # lateness of a main loop that reads lines and writes answers

STOPS_PER_STATE = 25  # random stops, after which the last one applies


@pytest.fixture(scope="session", params=BAUDS)
def sketch(
    request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory
) -> tuple[Path, int]:
    skip_unless_available()
    baud: int = request.param
    folder, run = tmp_path_factory.mktemp("sketch"), shared_folder(tmp_path_factory)
    if baud == BAUDS[0]:
        return firmware("uno", folder, run), baud
    return make_once(
        run / f"uno_{baud}.elf", lambda path: shutil.copy(build(baud, folder), path)
    ), baud


@pytest.fixture
def uno_at(sketch: tuple[Path, int]) -> Iterator[tuple[Uno, int]]:
    with started_uno(*sketch) as uno:
        yield uno, sketch[1]


@pytest.fixture(scope="module")
def driving_at(sketch: tuple[Path, int]) -> Iterator[tuple[Uno, int]]:
    """A driving robot after a second of silence: tests branch off from there."""
    with started_uno(*sketch) as uno:
        drive(uno)
        yield uno, sketch[1]


def started_uno(sketch: Path, baud: int) -> Uno:
    uno = Uno(sketch, names=NAMES, baud=baud, resets_on_open=False, tells_sleep=False)
    uno.run_ms(300)
    return uno


def answer_lines(uno: Uno, start: int) -> str:
    return bytes(byte.value for byte in uno.sent_bytes[start:]).decode("latin-1")


def drive(uno: Uno) -> None:
    """Make the robot drive by a line, followed by a second of silence."""
    uno.run_ms(SILENCE_MS + 50)
    uno.send(RUNNING_LINE)
    uno.run_ms(SILENCE_MS + 100)
    assert states(uno) == FORWARD, answer_lines(uno, 0)[-200:]


def stop_after(uno: Uno, baud: int, prefix: bytes, spelling: bytes, is_busy: bool = False) -> float:
    """Type a stop while the robot drives. Its pins are off in time, and no motor starts again.

    Returns the ms from the end of the line to the pins.

    For bytes that began as a frame, that is after 100 ms of silence. A robot that `is_busy` takes a
    little longer, or stops sooner: when the main loop gives that up, for which it may have had no
    room.
    """
    byte_ms = 10_000 / baud
    uno.send(prefix + spelling)
    uno.run_ms(len(prefix + spelling) * byte_ms + SHORTEST_STOP_MS + 10)
    end = next(
        k
        for k in reversed(range(len(uno.received_bytes)))
        if uno.received_bytes[k].value not in b"\r\n\0"
    )
    line_end = uno.received_bytes[end + 1]  # the CR of a CR LF
    off_cycle = max(uno.pins[name].cycle for name in ("left", "right"))
    description = f"{prefix!r} {spelling!r}"
    assert states(uno) == OFF, description
    late_ms = (off_cycle - line_end.cycle) / CYCLES_PER_MS
    behind_ms = (off_cycle - uno.received_bytes[-1].cycle) / CYCLES_PER_MS
    is_held = behind_ms < SHORTEST_STOP_MS + (BUSY_TURN_MS if is_busy else TURN_MS)
    if not is_busy:
        is_held = is_held and behind_ms > SHORTEST_STOP_MS - TURN_MS
    assert late_ms < MAX_MS or is_held, f"{description}: {late_ms} ms"
    changes = len(uno.pins.history("left"))
    uno.send(b"F(1,80)\n")  # before a second of silence
    uno.run_ms(150)
    assert states(uno) == OFF and len(uno.pins.history("left")) == changes, description
    return late_ms


@pytest.mark.sampled("name", keep=6)
@pytest.mark.parametrize("name", ALL_PREFIXES)
def test_a_typed_stop_works_in_every_state(driving_at: tuple[Uno, int], name: str) -> None:
    """Half of the spellings are typed at one rate, the others at the other one; the receiver
    alone gets each of them after any prefix in `tests/link`. After the last one the robot is asked
    whether it is latched."""
    uno, baud = driving_at
    spellings = spellings_after(name)[(list(ALL_PREFIXES).index(name) + BAUDS.index(baud)) % 2 :: 2]
    for spelling in spellings:
        with uno.try_out():
            stop_after(uno, baud, ALL_PREFIXES[name], spelling)
            if spelling == spellings[-1]:
                check_latched(uno)


@pytest.mark.parametrize("name", FRAME_PREFIXES)
def test_a_loose_spelling_in_a_frame_does_not_stop(driving_at: tuple[Uno, int], name: str) -> None:
    uno, _ = driving_at
    with uno.try_out():
        uno.send(FRAME_PREFIXES[name] + b"stop!\nS()\nalto\n")
        uno.run_ms(SHORTEST_STOP_MS + 50)
        assert states(uno) == FORWARD


# -- stops that do not wait for the end of their line ----------------------------------------------


def stop_time_ms(uno: Uno, data: bytes, byte_ms: float) -> float:
    """Send bytes; return the ms from the last of them to the pins, which are off."""
    uno.send(data)
    uno.run_ms(len(data) * byte_ms + 10)
    assert states(uno) == OFF, data
    off_cycle = max(uno.pins[name].cycle for name in ("left", "right"))
    return (off_cycle - uno.received_bytes[-1].cycle) / CYCLES_PER_MS


@pytest.mark.parametrize(
    "data", [b"SSS", b"s s\tS", b"FFFFSSS", b"SI|F(1,80)SSS", b"STOPSTOP", b"stop stop", b"\0xSSS",
             b"F(1,stop STOP", b"S" * 40],
)  # fmt: skip
def test_a_stop_without_line_ends_stops_when_repeated(
    driving_at: tuple[Uno, int], data: bytes
) -> None:
    """A held button's row of S, and a second STOP."""
    uno, baud = driving_at
    with uno.try_out():
        assert stop_time_ms(uno, data, 10_000 / baud) < MAX_MS


def test_a_row_of_s_without_line_ends_stops_at_the_third(driving_at: tuple[Uno, int]) -> None:
    uno, _ = driving_at
    with uno.try_out():
        for sent_count in range(1, 9):
            uno.send(b"S")
            uno.run_ms(400)
            assert (states(uno) == OFF) == (sent_count >= 3), sent_count
        check_latched(uno)


@pytest.mark.parametrize("data", [b"S", b"STOP", b"alto", b"S.", b"Stop now"])
def test_an_unterminated_stop_stops_after_a_second(
    driving_at: tuple[Uno, int], data: bytes
) -> None:
    uno, baud = driving_at
    with uno.try_out():
        uno.send(data)
        uno.run_ms(SILENCE_MS - 50)
        assert states(uno) == FORWARD
        uno.run_ms(50 + len(data) * 10_000 / baud + 2 * TURN_MS)
        assert states(uno) == OFF


@pytest.mark.parametrize(
    "data", [b"SS", b"S.S.S", b"// SSS", b"STO STO", b"CLASS", b"F(1,80)S S", b"ALT OSTOP"],
)  # fmt: skip
def test_a_stop_without_a_line_end_does_not_stop(driving_at: tuple[Uno, int], data: bytes) -> None:
    uno, _ = driving_at
    with uno.try_out():
        uno.send(data)
        uno.run_ms(200)
        assert states(uno) == FORWARD


@pytest.mark.sampled("prefix", "data", keep=3)
@pytest.mark.parametrize("prefix", [b"", b"\n", b"F(1,80)\r\n"])
@pytest.mark.parametrize("data", [b"\x03", b"\x03\x03\x03", b"\x03\r\n"])
def test_ctrl_c_alone_stops_after_silence(
    driving_at: tuple[Uno, int], prefix: bytes, data: bytes
) -> None:
    uno, baud = driving_at
    with uno.try_out():
        late_ms = stop_time_after_silence_ms(uno, prefix + data, 10_000 / baud)
        assert SHORTEST_STOP_MS - TURN_MS < late_ms < SHORTEST_STOP_MS + BUSY_TURN_MS
        check_latched(uno)
    for data_with_rest in (b"x" + data, b"\0" + data, data + b"x", b" " + data):
        with uno.try_out():
            uno.send(data_with_rest)
            uno.run_ms(3 * SHORTEST_STOP_MS)
            assert states(uno) == FORWARD, data_with_rest


def stop_time_after_silence_ms(uno: Uno, data: bytes, byte_ms: float) -> float:
    uno.send(data)
    uno.run_ms(len(data) * byte_ms + SHORTEST_STOP_MS + 2 * BUSY_TURN_MS)
    assert states(uno) == OFF, data
    off_cycle = max(uno.pins[name].cycle for name in ("left", "right"))
    return (off_cycle - uno.received_bytes[-1].cycle) / CYCLES_PER_MS


# -- when lines count again -----------------------------------------------------------------------

NEXT_PROGRAM = b"SI|F(1,60)\n"
STEP_MS = 300
PAUSE_LINE = "// Stopped: wait a second\r\n"


def repeat_until_it_drives(uno: Uno, limit_ms: int) -> int:
    """Send a line every EACH_MS; return after how many ms the robot drives, or most_ms."""
    passed_ms = 0
    while passed_ms < limit_ms:
        uno.send(NEXT_PROGRAM)
        uno.run_ms(STEP_MS)
        passed_ms += STEP_MS
        if states(uno) == FORWARD:
            return passed_ms
    return limit_ms


@pytest.mark.parametrize("stop", [b"S\n", b"PARA\n", b"SSS"])
def test_a_remote_that_repeats_is_heard_again_after_a_second(
    driving_at: tuple[Uno, int], stop: bytes
) -> None:
    uno, _ = driving_at
    with uno.try_out():
        count_before = len(uno.sent_bytes)
        uno.send(stop)
        uno.run_ms(50)
        assert states(uno) == OFF
        again_ms = repeat_until_it_drives(uno, 3000)
        assert SILENCE_MS - 100 < again_ms <= SILENCE_MS + 2 * STEP_MS
        assert answer_lines(uno, count_before).count(PAUSE_LINE) == 1, (
            "what is dropped is told once"
        )


def test_after_the_stop_sequence_a_second_of_silence_is_needed(
    driving_at: tuple[Uno, int],
) -> None:
    uno, _ = driving_at
    with uno.try_out():
        count_before = len(uno.sent_bytes)
        uno.send(bytes(8))
        uno.run_ms(50)
        assert states(uno) == OFF
        assert repeat_until_it_drives(uno, 3000) == 3000
        assert answer_lines(uno, count_before).count(PAUSE_LINE) == 1
        uno.run_ms(SILENCE_MS)
        assert repeat_until_it_drives(uno, 3000) == STEP_MS


STOPS: dict[str, Callable[[Uno], object]] = {
    "typed": lambda uno: uno.send(b"S\n"),
    "letters": lambda uno: uno.send(b"SSS"),
    "sequence": lambda uno: uno.send(bytes(8)),
    "button": lambda uno: uno.press("button"),
}


@pytest.mark.sampled("stop", keep=1)
@pytest.mark.parametrize("stop", STOPS)
def test_how_long_a_stop_lasts_does_not_depend_on_an_earlier_one(
    driving_at: tuple[Uno, int], stop: str
) -> None:
    waits_ms: dict[str, int] = {}
    for earlier in ("", *STOPS):
        uno, _ = driving_at
        with uno.try_out():
            if earlier:
                STOPS[earlier](uno)
                uno.run_ms(SILENCE_MS + 100)
                assert states(uno) == OFF
                assert repeat_until_it_drives(uno, 3000) == STEP_MS
            STOPS[stop](uno)
            uno.run_ms(100)
            assert states(uno) == OFF
            waits_ms[earlier] = repeat_until_it_drives(uno, 2 * SILENCE_MS)
    assert set(waits_ms.values()) == {waits_ms[""]}, waits_ms


def test_in_an_open_block_a_spelling_belongs_to_the_program(
    driving_at: tuple[Uno, int],
) -> None:
    """The running program ends; the robot is latched only if the line is wrong there."""
    uno, _ = driving_at
    for line, is_stopped in ((b"S", False), (b"STOP;STOP", False), (b"STOP NOW", True)):
        with uno.try_out():
            for data in (b"SI|LOOP(2)", line):
                uno.send(data + b"\r\n")
                uno.run_ms(100)
            assert states(uno) == OFF, line
            count_before = len(uno.sent_bytes)
            uno.send(b"F(0.1,80)\r\nEND_LOOP\r\n")
            uno.run_ms(200)
            assert ("// OK" in answer_lines(uno, count_before)) is not is_stopped, answer_lines(
                uno, count_before
            )


# -------------------------------------------------------------------------------------------------


def check_latched(uno: Uno) -> None:
    uno.run_ms(SILENCE_MS + 100)
    count_before = len(uno.sent_bytes)
    uno.send(b"F(1,80)\n")
    uno.run_ms(200)
    assert states(uno) == OFF and "// It was stopped." in answer_lines(uno, count_before), (
        "it is latched"
    )


def test_a_line_in_a_block_belongs_to_the_program(uno_at: tuple[Uno, int]) -> None:
    """The paper's listing, typed line by line while another program runs: no stop latches."""
    uno, _ = uno_at
    uno.set_sonar_distance("trigger", "echo", 40)
    drive(uno)
    for line in OBSTACLE_LINES[:-1]:
        uno.send(line.encode() + b"\r\n")
        uno.run_ms(60)
    assert states(uno) == OFF
    count_before = len(uno.sent_bytes)
    uno.send(OBSTACLE_LINES[-1].encode() + b"\r\n")
    uno.run_ms(60)
    assert states(uno) == FORWARD and answer_lines(uno, count_before) == "// OK\r\n"


def test_a_pending_mistake_message_is_dropped_by_the_next_line(
    uno_at: tuple[Uno, int],
) -> None:
    """A stop after them is looked for before the wire is free; here it belongs to a block."""
    uno, _ = uno_at
    uno.run_ms(SILENCE_MS + 50)
    count_before = len(uno.sent_bytes)
    uno.send(b"FOO\nFOO\nIF(TRUE)\nS\n")
    uno.run_ms(SILENCE_MS + 500)
    first, *others = answer_lines(uno, count_before).splitlines()
    assert first == "// 1: Unknown word"
    assert set(others) <= {first, "// Waiting for ENDIF"} and others[-1] != first


@pytest.mark.sampled("way")
@pytest.mark.parametrize("way", ["live", "upload", "long upload"])
def test_code_that_holds_a_typed_stop_runs(uno_at: tuple[Uno, int], way: str) -> None:
    """A frame that arrives whole is not stopped by a line of S among its bytes."""
    uno, baud = uno_at
    text_before = "SHOW(1); " * 20 if way == "long upload" else ""
    image = image_of(f"SI|{text_before}M(10, 10); W(FOREVER) UNTIL(TIME > 3)")
    wired_uno = Wired(uno, Session(1, baud, KIT.fingerprint))
    request = (
        wired_uno.session.live(image.code) if way == "live" else wired_uno.session.upload(image)
    )
    assert wired_uno.until(request) == OK
    assert b"\nS\n" in bytes(byte.value for byte in uno.received_bytes)
    began_ms = wired_uno.now_ms
    wired_uno.run(SILENCE_MS + SHORTEST_STOP_MS)
    assert states(uno) == FORWARD
    while states(uno) == FORWARD:
        wired_uno.run(10)
    assert 2900 < wired_uno.now_ms - began_ms < 3200
    wired_uno.run(50)
    assert wired_uno.session.events()[-1].name == "DONE"


def random_prefix(rng: random.Random) -> bytes:
    parts = [rng.choice(list(ALL_PREFIXES.values())) for _ in range(rng.randrange(3))]
    odd_bytes = bytes(rng.choice(b"\0\x01S\n s;T\r\x1b[OPp\t5(") for _ in range(rng.randrange(20)))
    parts += [odd_bytes, rng.randbytes(rng.randrange(30))]
    rng.shuffle(parts)
    end = rng.choice((b"\n", b"\r\n", b"\0"))  # a line begins, in frames too
    return b"".join(parts).replace(b"\0\0\0", b"\0") + end


def stop_after_random_bytes(sketch: Path, baud: int, rng: random.Random, count: int) -> float:
    """Type so many stops after random bytes; return the ms that the slowest took."""
    slowest_ms = 0.0
    with started_uno(sketch, baud) as uno:
        for k in range(count):
            if k % STOPS_PER_STATE == 0:
                drive(uno)
            prefix, spelling = random_prefix(rng), rng.choice(STRICT_SPELLINGS)
            is_last = k % STOPS_PER_STATE == STOPS_PER_STATE - 1
            with nullcontext() if is_last else uno.try_out():
                late_ms = stop_after(uno, baud, prefix, spelling, is_busy=True)
            slowest_ms = max(slowest_ms, late_ms)
    return slowest_ms


# -- lines that are pasted faster than an Uno reads them ------------------------------------------


BAUD = 115_200
LOST_BYTES_LINE = "// Bytes were lost. Begin again."
TOO_MANY_LINE = "// Too many. Wait 5 s."  # answer after too many mistakes
LINES = (
    "F(0.1,80)", "SI|F(0.1,80)", "SB|F(0.1,80)", "SHOW(1)", "X=1", "HELP", "FOO", "(1)", "1=2",
    "E(", "PING|CHECK_CONNECTION", "ñandú", "F(0.1,80);" * 6,
)  # fmt: skip
MISTAKE_LIMIT = 20
QUIET_MS = 700  # longer than a program of these lines


@pytest.fixture(scope="module")
def quick_uno(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Uno]:
    """A robot after a second of silence: tests branch off from there."""
    skip_unless_available()
    with started_uno(build(BAUD, tmp_path_factory.mktemp("sketch")), BAUD) as uno:
        uno.run_ms(SILENCE_MS)
        yield uno


def printed_lines(uno: Uno, data: bytes) -> list[str]:
    """Return the lines that the robot says to this, until it is silent and no program runs."""
    start_index, sent_count = len(uno.sent_bytes), -1
    uno.send(data)
    while sent_count != len(uno.sent_bytes):
        sent_count = len(uno.sent_bytes)
        uno.run_ms(QUIET_MS)
    return answer_lines(uno, start_index).splitlines()


@pytest.mark.sampled("line")
@pytest.mark.parametrize("line", LINES, ids=lambda line: line[:20])
def test_a_lost_pasted_line_is_reported(quick_uno: Uno, line: str) -> None:
    """An Uno keeps 62 bytes of text that waits. At 115200 baud, lines arrive faster than it reads
    them, and while it answers it reads none."""
    uno, data = quick_uno, line.encode() + b"\r\n"
    with uno.try_out():
        first_lines = [
            line
            for line in printed_lines(uno, data)
            if line not in ("// DONE", "// 1", LOST_BYTES_LINE)
        ]
        for count in (MISTAKE_LIMIT // 2, MISTAKE_LIMIT):
            with uno.try_out():
                all_lines = printed_lines(uno, data * count)
                answers = sum(line in first_lines for line in all_lines)
                is_told = LOST_BYTES_LINE in all_lines or TOO_MANY_LINE in all_lines
                assert is_told or answers == len(first_lines) * count, all_lines
                assert is_told or count < MISTAKE_LIMIT, "as twenty lines are, some are lost"
                count_before = len(uno.sent_bytes)
                uno.send(b"SI|SHOW(7)\n")
                uno.run_ms(100)
                assert answer_lines(uno, count_before).endswith("// 7\r\n// DONE\r\n")


def test_a_line_of_227_bytes_is_pasted_whole(quick_uno: Uno) -> None:
    with quick_uno.try_out():
        assert printed_lines(quick_uno, b"SI|" + b"F(2,80);" * 28 + b"\n") == ["// OK"]


if __name__ == "__main__":
    options = make_options(10_000, 1)
    drawn_random = random.Random(options.seed)
    with tempfile.TemporaryDirectory() as folder:
        for rate in BAUDS:
            simulator = build(rate, Path(folder))
            for first in range(0, options.count // 2, 500):
                stop_count = min(500, options.count // 2 - first)
                slowest = stop_after_random_bytes(simulator, rate, drawn_random, stop_count)
                print(
                    f"{stop_count} stops at {rate} baud, the slowest {slowest:.1f} ms", flush=True
                )
