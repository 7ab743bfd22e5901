"""Recordings of a run: files of anybody, and where a robot and the virtual one part."""

from __future__ import annotations

import json

import pytest

from tiniscript import compile
from tiniscript.studio import recordings, worker
from tiniscript.studio.recordings import BadRecording, Parting, Recorded, read, replay
from tiniscript.studio.simulation import Simulation
from tiniscript.virtual import worlds

LOOKS = "LOOP(2);\n  W(1);\n  SHOW(DISTANCE);\n  X = DISTANCE * 2;\n  SHOW(X);\nEND_LOOP"
LINES = ((1000, "SHOW 17.5"), (1020, "SHOW 35"), (2040, "SHOW 4"), (2060, "SHOW 8"), (2061, "DONE"))


def file(*events: tuple[int, str], text: str = LOOKS, version: int = 1) -> bytes:
    head = {"tiniscript_recording": version, "program": f"{compile(text).checksum:08x}"}
    rows = [head, *({"ms": ms, "event": event} for ms, event in events)]
    return "".join(json.dumps(row) + "\n" for row in rows).encode()


def parting(*events: tuple[int, str], text: str = LOOKS) -> Parting:
    recording = read(file(*events, text=text))
    return replay(recording, text.encode(), "tinibot", worlds.load("obstacles"))


def test_readings_of_the_recording_are_those_of_the_virtual_sensors() -> None:
    """Its world has nothing at 17.5 cm: and what is calculated of the reading is the same."""
    assert parting(*LINES) == Parting("same", 5)


@pytest.mark.parametrize(("text", "found"), [
    (LOOKS.replace("DISTANCE", "PAD_Y"), Parting("same", 5)),
    (LOOKS.replace("SHOW(DISTANCE)", "SHOW(PAD_Y + 0)").replace("DISTANCE", "PAD_Y"),
     Parting("value", 0, 3, Recorded(1000, "SHOW 17.5"), Recorded(1000, "SHOW 0"))),
])  # fmt: skip
def test_of_what_was_pressed_the_virtual_robot_has_what_is_shown(text: str, found: Parting) -> None:
    assert parting(*LINES, text=text) == found


def test_the_first_value_or_time_that_differs_is_told_with_its_line() -> None:
    found = parting(*LINES[:3], (2060, "SHOW 9"), LINES[4])
    assert (found.what, found.agreed, found.line) == ("value", 3, 5)
    assert found.robot == (2060, "SHOW 9")
    assert found.virtual is not None and found.virtual.event == "SHOW 8"
    late = [(ms + 900 * (ms > 2000), event) for ms, event in LINES]
    found = parting(*late)
    assert (found.what, found.agreed, found.line) == ("time", 2, 3)


def test_a_quarter_of_a_second_and_a_twentieth_of_the_time_are_the_same_time() -> None:
    assert parting((281, "SHOW 1"), text="SHOW(1)") == Parting("same", 1)  # the virtual one: 17
    assert parting((282, "SHOW 1"), text="SHOW(1)").what == "time"


def test_who_goes_on_alone_is_told() -> None:
    found = parting(*LINES[:2], (9000, "STOPPED"))
    assert (found.what, found.agreed, found.line) == ("virtual_more", 2, 3)
    more = parting((100, "SHOW 1"), (200, "SHOW 2"), text="SHOW(1);W(0.1)")
    assert (more.what, more.agreed) == ("value", 1)  # DONE in place of the second one
    assert parting((100, "SHOW 1"), text="W(9);SHOW(1)").what == "robot_more"


@pytest.mark.parametrize("end", [[], [(1500, "STOPPED")], [(2200, "STOPPED")], [(9000, "LOST")]])
def test_a_recording_that_is_cut_is_compared_as_far_as_it_goes(end: list[tuple[int, str]]) -> None:
    """By a person, by the link, or because the robot still runs: each of them is no difference."""
    assert parting(*LINES[:2], *end) == Parting("same", 2)
    found = parting(LINES[0], (1020, "SHOW 36"), *end)
    assert (found.what, found.agreed) == ("value", 1)


def test_what_did_not_arrive_ends_the_comparison() -> None:
    assert parting(*LINES[:2], (2060, "MISSED")) == Parting("missed", 2)
    assert parting((9, "MISSED")) == Parting("missed", 0)
    assert parting(LINES[0], (1020, "SHOW 36"), (2060, "MISSED")).what == "value"


@pytest.mark.parametrize("waited_ms", [0, 100, 7000])
def test_a_program_of_the_button_is_pushed_and_compared_from_its_first_event(
    waited_ms: int,
) -> None:
    """A hand is slow, and no robot tells when its program begins."""
    text = "SB|W(1);SHOW(5);W(2);SHOW(6)"
    lines = [(waited_ms, "SHOW 5"), (waited_ms + 2000, "SHOW 6"), (waited_ms + 2001, "DONE")]
    assert parting(*lines, text=text) == Parting("same", 3)
    found = parting(lines[0], (waited_ms + 3000, "SHOW 6"), text=text)
    assert (found.what, found.agreed) == ("time", 1)
    assert found.virtual is not None and found.virtual.ms < 3100
    assert found.robot is not None and found.robot.ms == found.virtual.ms + 1000
    assert parting(lines[0], (lines[0][0] + 900, "STOPPED"), text=text) == Parting("same", 1)
    assert parting((0, "STOPPED"), text=text) == Parting("same", 0)
    assert parting(text=text) == Parting("empty")
    assert parting((0, "SHOW 5"), (1, "DONE"), text="SB|SHOW(5)") == Parting("same", 2)
    assert parting((0, "SHOW 5"), text="SB|W(1)").what == "value"


@pytest.mark.parametrize(
    ("text", "events"),
    [
        ("SB|SHOW(5);W(30)", ((7000, "SHOW 5"), (7500, "LOST"))),
        ("SB|W(30);SHOW(5)", ((4000, "STOPPED"),)),
    ],
)
def test_the_virtual_robot_runs_no_longer_than_what_is_compared(
    text: str, events: tuple[tuple[int, str], ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    ran_ms = []

    class Timed(Simulation):
        def close(self) -> None:
            ran_ms.append(self.robot.now_ms)
            super().close()

    monkeypatch.setattr(recordings, "Simulation", Timed)
    assert parting(*events, text=text).what == "same"
    assert ran_ms[0] < 8000


def test_a_recording_of_another_program_is_not_compared() -> None:
    recording = read(file(*LINES))
    assert (
        replay(recording, b"SHOW(1)", "tinibot", worlds.load("obstacles")).what == "other_program"
    )
    assert replay(recording, b"SHOW(", "tinibot", worlds.load("obstacles")).what == "other_program"


@pytest.mark.parametrize(
    ("data", "reason", "line"),
    [
        (b"", "unreadable", 1),
        (b"\xff\xfe\x00", "unreadable", 1),
        (b"[" * 50_000, "unreadable", 1),
        (b"{}", "unreadable", 1),
        (file(version=2), "other_version", 1),
        (file(*LINES)[:-12], "unreadable", 6),  # cut
        (file((5, "SHOW 1"), (4, "SHOW 2")), "unreadable", 3),
        (file((5, "DONE"), (6, "SHOW 2")), "unreadable", 3),
        (file((5, "SHOW 99999999999")), "unreadable", 2),
        (file((5, "SHOW NaN")), "unreadable", 2),
        (file((5, "FAULT <b>")), "unreadable", 2),
        (file((5, "MISSED"), (6, "SHOW 2")), "unreadable", 3),
        (file((-1, "SHOW 1")), "unreadable", 2),
        (file((10**9, "SHOW 1")), "too_long", 2),
        (b"{" + b" " * 1_000_000, "too_long", 1),
        (file().replace(b'"program"', b'"Program"'), "unreadable", 1),
    ],
)
def test_files_of_anybody_are_refused_with_a_reason(data: bytes, reason: str, line: int) -> None:
    with pytest.raises(BadRecording) as refused:
        read(data)
    assert (refused.value.reason, refused.value.line) == (reason, line)
    asked = {"do": "replay", "robot": "tinibot", "world": "obstacles", "text": LOOKS}
    answer = json.loads(worker.answer(json.dumps({**asked, "language": "en"}), data))
    assert answer == {"what": reason, "line": line}


def test_a_number_that_no_sensor_reads_is_as_near_as_it_can() -> None:
    found = parting((1000, "SHOW 9999999"), text="W(1);SHOW(DISTANCE)")
    assert found.what == "value" and found.virtual is not None
    assert found.virtual.event == "SHOW 400"
