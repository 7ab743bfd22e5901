"""Recordings of a run: files of anybody, and where a robot and the virtual one part."""

from __future__ import annotations

import json

import pytest

from tests.support.virtual_robot import missing
from tiniscript import compile
from tiniscript.studio import worker
from tiniscript.studio.recordings import BadRecording, Parting, read, replay
from tiniscript.virtual import worlds

pytestmark = pytest.mark.skipif(bool(missing()), reason=missing() or "there is wasmtime")
LOOKS = "LOOP(2);\n  W(1);\n  SHOW(DISTANCE);\n  X = DISTANCE * 2;\n  SHOW(X);\nEND_LOOP"
LINES = ((1000, "SHOW 17.5"), (1020, "SHOW 35"), (2040, "SHOW 4"), (2060, "SHOW 8"), (2061, "DONE"))


def file(*events: tuple[int, str], text: str = LOOKS, version: int = 1) -> bytes:
    head = {"tiniscript_recording": version, "program": f"{compile(text).checksum:08x}"}
    rows = [head, *({"ms": ms, "event": event} for ms, event in events)]
    return "".join(json.dumps(row) + "\n" for row in rows).encode()


def parting(*events: tuple[int, str], text: str = LOOKS) -> Parting:
    found = read(file(*events, text=text))
    return replay(found, text.encode(), "tinibot", worlds.load("obstacles"))


def test_readings_of_the_recording_are_those_of_the_virtual_sensors() -> None:
    """Its world has nothing at 17.5 cm: and what is calculated of the reading is the same."""
    assert parting(*LINES) == Parting("same", 5)


def test_the_first_value_that_differs_is_told_with_its_line() -> None:
    found = parting(*LINES[:3], (2060, "SHOW 9"), LINES[4])
    assert (found.what, found.agreed, found.line) == ("value", 3, 5)
    assert found.robot == (2060, "SHOW 9")
    assert found.virtual is not None and found.virtual.event == "SHOW 8"


def test_the_first_time_that_differs_is_told() -> None:
    late = [(ms + 900 * (ms > 2000), event) for ms, event in LINES]
    found = parting(*late)
    assert (found.what, found.agreed, found.line) == ("time", 2, 3)


def test_who_goes_on_alone_is_told() -> None:
    assert parting(*LINES[:4]).what == "virtual_more"
    more = parting((100, "SHOW 1"), (200, "SHOW 2"), text="SHOW(1);W(0.1)")
    assert (more.what, more.agreed) == ("value", 1)  # DONE in place of the second one
    assert parting((100, "SHOW 1"), text="W(9);SHOW(1)").what == "robot_more"


def test_a_stop_by_a_person_is_no_difference() -> None:
    assert parting(*LINES[:2], (1500, "STOPPED")) == Parting("same", 3)


def test_a_recording_of_another_program_is_not_compared() -> None:
    found = read(file(*LINES))
    assert replay(found, b"SHOW(1)", "tinibot", worlds.load("obstacles")).what == "other_program"
    assert replay(found, b"SHOW(", "tinibot", worlds.load("obstacles")).what == "other_program"


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
