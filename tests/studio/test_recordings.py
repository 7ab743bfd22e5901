"""Files of recorded runs: arbitrary input, and where a robot and the virtual one diverge."""

from __future__ import annotations

import json
import random
from types import SimpleNamespace
from typing import Any

import pytest

from tests.studio.runs_again import record_run, replay_difference
from tiniscript import compile, robots
from tiniscript.link.messages import AFTER_GAP
from tiniscript.link.payloads import ReadingEvent
from tiniscript.studio import recordings
from tiniscript.studio.playing import Divergence, PlayedRun, play, prepare
from tiniscript.studio.recordings import (
    BadRecording,
    ReadingRows,
    Row,
    Rows,
    decode,
    encode,
    header_line,
)
from tiniscript.studio.robot_link import RobotLink

SHOW_PROGRAM = "LOOP(2);\n  W(1);\n  SHOW(DISTANCE);\n  X = DISTANCE * 2;\n  SHOW(X);\nEND_LOOP"
LINES = ((1000, "SHOW 17.5"), (1020, "SHOW 35"), (2040, "SHOW 4"), (2060, "SHOW 8"), (2061, "DONE"))
TINIBOT = robots.load("tinibot")


def first_line(text: str = SHOW_PROGRAM, robot_kind: str = recordings.REAL, **fields: Any) -> str:
    if robot_kind == recordings.VIRTUAL:
        fields = {"world": "obstacles", **fields}
    return header_line(robot_kind, text, TINIBOT, compile(text).checksum, **fields)


def file(*events: tuple[int, str], text: str = SHOW_PROGRAM, **fields: Any) -> bytes:
    rows = [Row(*event) for event in events]
    end_ms = rows[-1].ms if rows else 0
    return encode(first_line(text, **fields), rows, end_ms).encode()


def parting(*events: tuple[int, str], text: str = SHOW_PROGRAM) -> Divergence:
    was_started_by_button = text.startswith("SB|")
    played_run = play(
        prepare(decode(file(*events, text=text, was_started_by_button=was_started_by_button)))
    )
    assert played_run.divergence is not None
    return played_run.divergence


def recording_of(*events: tuple[int, str], text: str = SHOW_PROGRAM) -> tuple[str, int, int]:
    return parting(*events, text=text)[:3]


def test_recorded_readings_are_fed_to_the_virtual_sensors() -> None:
    """Its world has nothing at 17.5 cm: calculations from the reading agree, too."""
    assert parting(*LINES) == Divergence("same", 5)


def test_pressed_keys_are_known_where_the_program_shows_them() -> None:
    assert parting(*LINES, text=SHOW_PROGRAM.replace("DISTANCE", "PAD_Y")) == Divergence("same", 5)


@pytest.mark.parametrize("value", ["17.5", "38.7"])
def test_no_divergence_is_marked_after_an_unrecorded_reading(value: str) -> None:
    """This holds whether the rest is the same or not."""
    text = "SHOW(1);\nX = DISTANCE + 0;\nSHOW(X);\nSHOW(2)"
    lines = [(20, "SHOW 1"), (40, f"SHOW {value}"), (60, "SHOW 2"), (61, "DONE")]
    divergence = parting(*lines, text=text)
    assert (divergence.outcome, divergence.agreed) == ("unread", 1)
    assert (divergence.line, divergence.sensor) == (2, "DISTANCE")
    wrong = parting((20, "SHOW 7"), *lines[1:], text=text)
    assert wrong.outcome == "value"  # the value before it


@pytest.mark.parametrize("value", ["TRUE", "FALSE"])
def test_a_recorded_reading_holds_from_its_time_on(value: str) -> None:
    text = "W(1);\nIF(KEY_A);SHOW(1);ENDIF;W(1);\nSHOW(DISTANCE * 2)"
    show_rows = [(1017, "SHOW 1")] if value == "TRUE" else []
    rows = [(0, f"READ KEY_A {value}"), (900, "READ DISTANCE 8"), *show_rows,
            (1900, "READ DISTANCE 9"), (2030, "SHOW 18"), (2031, "DONE")]  # fmt: skip
    assert parting(*rows, text=text) == Divergence("same", len(show_rows) + 2)
    rows[-2] = (2030, "SHOW 16")
    assert recording_of(*rows, text=text) == ("value", len(show_rows), 3)


def test_the_first_divergence_is_reported_with_its_line() -> None:
    divergence = parting(*LINES[:3], (2060, "SHOW 9"), LINES[4])
    assert (divergence.outcome, divergence.agreed, divergence.line) == ("value", 3, 5)
    assert divergence.robot == Row(2060, "SHOW 9")
    assert divergence.virtual is not None and divergence.virtual.event == "SHOW 8"
    late_rows = [(ms + 900 * (ms > 2000), event) for ms, event in LINES]
    assert recording_of(*late_rows) == ("time", 2, 3)


def test_time_differences_within_tolerance_are_ignored() -> None:
    assert recording_of((281, "SHOW 1"), text="SHOW(1)")[0] == "same"  # the virtual one: 17
    assert recording_of((282, "SHOW 1"), text="SHOW(1)")[0] == "time"


def test_a_robot_that_continues_longer_is_reported() -> None:
    assert recording_of(*LINES[:2], (9000, "STOPPED")) == ("virtual_more", 2, 3)
    divergence = recording_of((100, "SHOW 1"), (200, "SHOW 2"), text="SHOW(1);W(0.1)")
    assert divergence[:2] == ("value", 1)  # DONE in place of the second one
    assert recording_of((100, "SHOW 1"), text="W(9);SHOW(1)")[0] == "robot_more"


@pytest.mark.parametrize("end", [[], [(1500, "STOPPED")], [(2200, "STOPPED")], [(9000, "LOST")]])
def test_a_recording_that_ends_early_is_compared_as_far_as_it_goes(
    end: list[tuple[int, str]],
) -> None:
    """A person or the link may end it, or the robot may still be running: none of these is a
    difference.
    """
    assert parting(*LINES[:2], *end) == Divergence("same", 2)
    assert recording_of(LINES[0], (1020, "SHOW 36"), *end)[:2] == ("value", 1)


def test_missed_events_end_the_comparison() -> None:
    assert parting(*LINES[:2], (2060, "MISSED")) == Divergence("missed", 2)
    assert parting((9, "MISSED")) == Divergence("missed", 0)
    assert recording_of(LINES[0], (1020, "SHOW 36"), (2060, "MISSED"))[0] == "value"
    assert parting((9, "LOST")).outcome == parting().outcome == "empty"


@pytest.mark.parametrize("waited_ms", [0, 100, 7000])
def test_a_button_program_is_compared_from_its_first_event(
    waited_ms: int,
) -> None:
    """A hand is slow, and no robot tells when its program begins."""
    text = "SB|W(1);SHOW(5);W(2);SHOW(6)"
    lines = [(waited_ms, "SHOW 5"), (waited_ms + 2000, "SHOW 6"), (waited_ms + 2001, "DONE")]
    assert parting(*lines, text=text) == Divergence("same", 3)
    divergence = parting(lines[0], (waited_ms + 3000, "SHOW 6"), text=text)
    assert (divergence.outcome, divergence.agreed) == ("time", 1)
    assert divergence.virtual is not None and divergence.virtual.ms < 3100
    assert divergence.robot is not None and divergence.robot.ms == divergence.virtual.ms + 1000
    assert parting(lines[0], (lines[0][0] + 900, "STOPPED"), text=text) == Divergence("same", 1)
    assert parting((0, "STOPPED"), text=text) == Divergence("same", 0)
    assert parting((0, "SHOW 5"), (1, "DONE"), text="SB|SHOW(5)") == Divergence("same", 2)
    assert parting((0, "SHOW 5"), text="SB|W(1)").outcome == "value"


@pytest.mark.parametrize(
    ("text", "events"),
    [
        ("SB|SHOW(5);W(30)", ((7000, "SHOW 5"), (7500, "LOST"))),
        ("SB|W(30);SHOW(5)", ((4000, "STOPPED"),)),
    ],
)
def test_the_virtual_robot_runs_only_as_long_as_compared(
    text: str, events: tuple[tuple[int, str], ...]
) -> None:
    played_run = play(prepare(decode(file(*events, text=text, was_started_by_button=True))))
    assert played_run.divergence is not None and played_run.divergence.outcome == "same"
    assert played_run.robot.now_ms < 8700


def test_an_impossible_reading_is_approximated() -> None:
    divergence = parting((1000, "SHOW 9999999"), text="W(1);SHOW(DISTANCE)")
    assert divergence.outcome == "value" and divergence.virtual is not None
    assert divergence.virtual.event == "SHOW 400"


def test_a_program_with_a_changed_meaning_is_not_replayed() -> None:
    for text in ("SHOW(1)", "SHOW("):
        with pytest.raises(BadRecording, match="other_program"):
            prepare(
                decode(
                    file(*LINES).replace(
                        json.dumps(SHOW_PROGRAM).encode(), json.dumps(text).encode()
                    )
                )
            )


# -- files of anybody -----------------------------------------------------------------------------

VIRTUAL = {"robot_kind": recordings.VIRTUAL}


@pytest.mark.parametrize(
    ("data", "reason", "line"),
    [
        (b"", "unreadable", 1),
        (b"\xff\xfe\x00", "unreadable", 1),
        (b"[" * 50_000, "unreadable", 1),
        (b"{}", "unreadable", 1),
        (b'{"tiniscript_recording": 1, "program": "89abcdef", "robot": "tinibot"}', "older", 1),
        (file().replace(b'run":1', b'run":2'), "other_version", 1),
        (file().replace(b'run":1', b'run":"1"'), "unreadable", 1),
        (file().replace(b'"tinibot"', b'"../tinibot"'), "other_robot", 1),
        (file().replace(b'"tinibot"', b'"liner"'), "other_robot", 1),
        (file().replace(b'"text"', b'"Text"'), "unreadable", 1),
        (file().replace(b'"real"', b'"unreal"'), "unreadable", 1),
        (file(*LINES)[:-3], "unreadable", 7),  # within its last row
        (file(*LINES)[:-14], "cut", 6),
        (first_line().encode(), "cut", 1),
        (file((5, "SHOW 1"), (4, "SHOW 2")), "unreadable", 3),
        (file((5, "MISSED"), (6, "SHOW 2")), "unreadable", 3),
        (file((5, "END"), (6, "SHOW 2")), "unreadable", 3),
        (file((5, "SHOW 99999999999")), "unreadable", 2),
        (file((5, "SHOW NaN")), "unreadable", 2),
        (file((5, "FAULT <b>")), "unreadable", 2),
        (file((5, "BUTTON DOWN")), "unreadable", 2),
        (file((-1, "SHOW 1")), "unreadable", 2),
        (file((10**9, "SHOW 1")), "too_long", 2),
        (file((5, "KEYS 64 0 0"), **VIRTUAL), "unreadable", 2),
        (file((5, "KEYS 1 0 101"), **VIRTUAL), "unreadable", 2),
        (file((5, "KEYS 1"), **VIRTUAL), "unreadable", 2),
        (file(**VIRTUAL).replace(b'"obstacles"', b'"nowhere"'), "unreadable", 1),
        (file(**VIRTUAL, seed=0), "unreadable", 1),
        (file(**VIRTUAL, given_readings={0: []}), "unreadable", 1),
        (file(**VIRTUAL, given_readings={0: [10**9]}), "unreadable", 1),
        (b"{" + b" " * 1_000_000, "too_long", 1),
    ],
)  # fmt: skip
def test_foreign_files_are_refused_with_a_reason(data: bytes, reason: str, line: int) -> None:
    with pytest.raises(BadRecording) as exception_info:
        decode(data)
    assert (exception_info.value.reason, exception_info.value.line) == (reason, line)


def test_a_file_with_any_change_is_refused_or_can_be_played() -> None:
    """No file of anybody ends in another error."""
    rng = random.Random(1)
    world = {"form": 1}
    recordings_data = [
        file(*LINES),
        file((289, "START"), (300, "KEYS 5 -100 0"), (400, "SHOW 1"), **VIRTUAL),
        file(**VIRTUAL, world=world),
        file(**VIRTUAL, given_readings={0: [5000, 6000]}),
    ]
    outcomes = set()
    for _ in range(3000):
        data = bytearray(rng.choice(recordings_data))
        for _ in range(rng.randint(1, 3)):
            offset = rng.randrange(len(data))
            piece = bytes(
                rng.choice(b'09-,"[]{}:e.\\nulltruE\xff ') for _ in range(rng.randint(0, 3))
            )
            data[offset : offset + rng.randint(0, 4)] = piece
        try:
            recording = decode(bytes(data))
        except BadRecording as error:
            outcomes.add(error.reason)
            continue
        outcomes.add("read")
        assert recording.rows == tuple(sorted(recording.rows, key=lambda row: row.ms))
        assert recording.end_ms >= max((row.ms for row in recording.rows), default=0)
    assert {"read", "unreadable", "cut", "other_robot"} <= outcomes


def test_a_long_recording_ends_before_its_file_is_too_large() -> None:
    rows = Rows()
    added = [rows.add(Row(ms, f"READ DISTANCE {ms % 400}.5")) for ms in range(100_000)]
    assert rows.is_full and added == sorted(added, reverse=True)
    data = encode(first_line(), rows.rows, rows.rows[-1].ms).encode()
    assert len(data) < recordings.MAX_BYTES
    assert decode(data).rows == tuple(rows.rows)
    short_rows = Rows()
    assert short_rows.add(Row(recordings.MAX_MS, "SHOW 1"))
    assert not short_rows.add(Row(recordings.MAX_MS + 1, "SHOW 1"))


@pytest.mark.parametrize("seed", range(5))
def test_a_recording_has_a_reading_where_it_changes_and_nothing_after_its_end(seed: int) -> None:
    rng, rows, values = random.Random(seed), Rows(), dict[str, int]()
    for ms in range(60):
        name, value = rng.choice(("DISTANCE", "LIGHT_L")), rng.randrange(3)
        is_other = values.get(name) != value
        assert rows.add(Row(ms, f"READ {name} {value}")) == is_other
        values[name] = value
    assert rows.add(Row(60, recordings.HELD))
    for ms in (60, 61, 99):
        assert rows.is_full and not rows.add(Row(ms, "SHOW 1"))


# -- a virtual robot's run is the same again ------------------------------------------------------


def test_each_differing_row_is_reported() -> None:
    data, rows = record_run(3)
    assert play(prepare(decode(data))).divergence == Divergence("again", len(rows))
    lines = data.decode().splitlines()
    for k, row in enumerate(rows):
        if k % max(1, len(rows) // 10):
            continue
        index = next(n for n, line in enumerate(lines) if line == recordings.encode_row(row))
        for changed_lines in ([recordings.encode_row(Row(row.ms, "BEEP 1 1"))], []):
            changed_text = "\n".join((*lines[:index], *changed_lines, *lines[index + 1 :]))
            divergence = play(prepare(decode(changed_text.encode()))).divergence
            assert divergence is not None
            assert divergence.outcome == "otherwise" and divergence.agreed <= k


@pytest.mark.parametrize("number", range(12))
@pytest.mark.parametrize("is_held", [False, True])
def test_a_run_is_reproduced(number: int, is_held: bool) -> None:
    assert replay_difference(number, is_held) is None


def test_a_replay_accepts_no_input_from_the_viewer() -> None:
    data, rows = record_run(5)
    played_run = PlayedRun(prepare(decode(data)))
    while not played_run.is_over:
        played_run.press(63, 100, 100)
        played_run.push()
        played_run.set_breakpoints((0, 3))
        played_run.advance(37)
    assert played_run.divergence == Divergence("again", len(rows))


GAP_TEXT = "SHOW(1);\nX = DISTANCE + 0;\nW(1);\nX = DISTANCE + 0;\nSHOW(X);\nSHOW(2)"


@pytest.mark.parametrize("value", ["8", "9"])
@pytest.mark.parametrize("is_known_again", [False, True])
def test_no_divergence_is_marked_after_an_unreported_reading(
    value: str, is_known_again: bool
) -> None:
    rows = [(0, "READ DISTANCE 8"), (1, "UNREAD DISTANCE"), (20, "SHOW 1"), (1040, f"SHOW {value}"),
            (1060, "SHOW 2"), (1061, "DONE")]  # fmt: skip
    if is_known_again:
        rows.insert(4, (1030, "READ DISTANCE 8"))
    divergence = parting(*rows, text=GAP_TEXT)
    assert (divergence.outcome, divergence.agreed) == ("unread", 1)
    assert (divergence.line, divergence.sensor) == (4, "DISTANCE")
    wrong = parting(*rows[:2], (20, "SHOW 7"), *rows[3:], text=GAP_TEXT)
    assert wrong.outcome == "value", "before it"


def test_a_shown_sensor_value_is_known_despite_unreported_readings() -> None:
    rows = [(0, "READ DISTANCE 8"), (1, "UNREAD DISTANCE"), (1020, "SHOW 9"), (1040, "DONE")]
    assert parting(*rows, text="X = DISTANCE + 0;W(1);\nSHOW(DISTANCE)").outcome == "same"
    text = "X = DISTANCE + 0;W(1);\nSHOW(DISTANCE);\nX = DISTANCE + 0;W(1)"
    divergence = parting(*rows[:-1], (2040, "DONE"), text=text)
    assert (divergence.outcome, divergence.line) == ("unread", 3)


def test_a_reading_may_follow_later_rows() -> None:
    text = "X = DISTANCE + 0;W(1);\nSHOW(X)"
    rows = [(1020, "SHOW 8"), (3, "READ DISTANCE 8"), (1021, "DONE")]
    assert parting(*rows, text=text) == Divergence("same", 2)
    with pytest.raises(BadRecording):
        parting((1020, "SHOW 8"), (3, "SHOW 8"), text=text)


@pytest.mark.parametrize("seed", range(5))
def test_a_robots_clock_may_be_fast_or_slow(seed: int) -> None:
    """Readings have the time of its clock, all other rows that of the computer."""
    rng, rows, now_ms = random.Random(seed), Rows(), 0
    reading_rows, speed = ReadingRows(TINIBOT.kit), rng.uniform(0.97, 1.03)
    for _ in range(200):
        now_ms += rng.choice((0, 20, 300))
        if rng.random() < 0.5:
            rows.add(Row(now_ms, f"SHOW {rng.randrange(9)}"))
            continue
        clock_ms = max(0, round((now_ms - rng.randrange(200)) * speed))
        event = ReadingEvent(1, 2, rng.randrange(9000), clock_ms % recordings.MS_MODULUS)
        for row in reading_rows.rows(event, now_ms):
            rows.add(row)
    recording = decode(encode(first_line(), rows.rows, now_ms).encode())
    expected_rows = [row._replace(ms=min(row.ms, now_ms)) for row in rows.rows]
    assert sorted(recording.rows) == sorted(expected_rows)
    assert [row.ms for row in recording.rows] == sorted(row.ms for row in expected_rows)


def test_an_out_of_range_reading_becomes_the_nearest_valid_one() -> None:
    text = "X = DISTANCE + 0;W(1);\nSHOW(X)"
    rows = [(3, "READ DISTANCE 9999999"), (4, "READ NOBODY 1"), (1020, "SHOW 400"), (1021, "DONE")]
    assert parting(*rows, text=text) == Divergence("same", 2)


def test_readings_have_the_robots_time_whenever_they_arrive() -> None:
    """Also where more than 65 s go by between two of them, each is 300 ms under way, and the
    computer's clock is faster or slower.
    """
    kit, rng = TINIBOT.kit, random.Random(1)
    for _ in range(200):
        speed = rng.uniform(0.99, 1.01)
        reading_rows, ms, ms_of = ReadingRows(kit), 0, dict[str, list[int]]()
        for _ in range(20):
            ms += rng.choice((0, 1, 20, 999, 40_000, 70_000, 150_000))
            is_untold = rng.random() < 0.1
            event = ReadingEvent(1, 2 | AFTER_GAP * is_untold, rng.randrange(400_000), ms % 65_536)
            rows = reading_rows.rows(event, round(ms * speed) + rng.randrange(300))
            assert (rows[-1].ms, rows[-1].is_reading) == (ms, True)
            if len(rows) == 2:
                last_ms = ms_of.get("DISTANCE", [-1])[-1]
                assert rows[0] == Row(last_ms + 1, "UNREAD DISTANCE")
            ms_of.setdefault("DISTANCE", []).append(ms)
        assert reading_rows.incomplete_names in ([], ["DISTANCE"])
    assert ReadingRows(kit).rows(ReadingEvent(1, 99, 1, 1), 0) == [], "of no sensor"


@pytest.mark.parametrize("seed", range(10))
def test_readings_of_each_run_are_timed_from_its_start(seed: int) -> None:
    rng, events, now_ms = random.Random(seed), list[tuple[int, ReadingEvent]](), 0
    connection: Any = SimpleNamespace(
        robot=SimpleNamespace(kit=TINIBOT.kit.fingerprint),
        boot=0,
        enable_place_events=lambda: None,
        event=lambda _: events.pop(0) if events else None,
    )
    link = RobotLink(connection, "en")
    number = 0
    for _ in range(6):
        number += 1
        if rng.random() < 0.4:  # the robot restarted, and begins its run numbers again
            connection.boot, number = connection.boot + 1, 1
        now_ms += rng.randrange(1, 300_000)
        times_ms = sorted(rng.sample(range(60_000), 4))
        events += [
            (now_ms + ms, ReadingEvent(number, 2, rng.randrange(400_000), ms)) for ms in times_ms
        ]
        now_ms += times_ms[-1]
        assert [row[0] for news in link.news() for row in news["rows"]] == times_ms
