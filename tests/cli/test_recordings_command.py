"""`tsc run --record`, `tsc upload --record` and `tsc run` of their files, and of the studio's."""

from __future__ import annotations

from functools import partial
from io import TextIOWrapper
from pathlib import Path
from random import Random
from time import monotonic
from types import SimpleNamespace
from typing import cast

import pytest

from tests.support.command import Tsc, run_in_process
from tiniscript import compile, robots
from tiniscript.base import files
from tiniscript.cli.commands import upload
from tiniscript.cli.errors import CommandError
from tiniscript.cli.paths import is_foreign
from tiniscript.cli.robot import event_printer, recorder
from tiniscript.cli.robot.event_printer import EventPrinter
from tiniscript.cli.robot.recorder import ENDING_EVENTS, Recorder, Rows
from tiniscript.cli.robot.run_monitor import Saving
from tiniscript.cli.robot.simulator import CommandSimulator
from tiniscript.link.payloads import ReadingEvent
from tiniscript.studio import recordings
from tiniscript.studio.playing import play, prepare
from tiniscript.studio.recordings import REAL, Row, decode, encode, header_line

TEXT = "SI|W(0.2); SHOW(5);\nX = 0; W(0.2);\nSHOW(1 / X)"
CHECKSUM = compile(TEXT).checksum
HEAD = header_line(REAL, TEXT, robots.load("tinibot"), CHECKSUM)
SAME_RUN_MESSAGE = "The virtual robot did exactly the same again. Rows compared: "


def real_recording(*events: tuple[int, str]) -> bytes:
    rows = [Row(*event) for event in events]
    return encode(HEAD, rows, rows[-1].ms if rows else 0).encode()


def test_a_run_on_the_virtual_robot_is_recorded_and_played_again(tsc: Tsc, tmp_path: Path) -> None:
    program, file = tmp_path / "p.ts", tmp_path / "run.tsr"
    program.write_text(
        "F(1, 80) UNTIL(DISTANCE < 15);\nSHOW(RANDOM(1, 99));\nIF(KEY_A);SHOW(TRUE);ENDIF"
    )
    words = ("--record", file, "--seed", "7", "--sensor", "KEY_A=TRUE", "--world", "line")
    result = tsc("run", program, *words).gives(0)
    assert result.out.startswith("0 START\n0 READ DISTANCE ") and "SHOW TRUE" in result.out
    assert result.out.endswith("DONE\n") and not is_foreign(file)
    recording = decode(file.read_bytes())
    assert (recording.seed, recording.world and recording.world.name) == (7, "line")
    replayed_result = tsc("run", file)
    assert (replayed_result.code, replayed_result.out) == (0, result.out)
    assert replayed_result.err == f"{SAME_RUN_MESSAGE}{len(recording.rows)}.\n"
    show = next(row for row in recording.rows if row.event.startswith("SHOW"))
    old_and_new_row = (
        recordings.encode_row(show),
        recordings.encode_row(show._replace(event="SHOW 100")),
    )
    file.write_text(file.read_text().replace(*old_and_new_row))
    other_result = tsc("run", file, "--lang", "es").gives(1)
    assert (
        "Línea 2: la grabación tiene 100 a los 1.0 s, y esta vez el robot virtual"
        in other_result.err
    )
    assert f"hizo {show.event[5:]} a los 1.0 s" in other_result.err


def test_a_run_is_as_long_as_it_may_be(tsc: Tsc, tmp_path: Path) -> None:
    file = tmp_path / "run.tsr"
    tsc("run", "-e", "SB|LOOP(FOREVER);W(0.4);SHOW(1);END_LOOP", "--max-time", "1.5",
        "--record", file).gives(0)  # fmt: skip
    rows = decode(file.read_bytes()).rows
    assert [row.event for row in rows] == ["BUTTON DOWN", "BUTTON UP", "START", *["SHOW 1"] * 3]
    assert tsc("run", file).gives(0).err.startswith(SAME_RUN_MESSAGE)


def test_a_fault_is_recorded_and_reported(tsc: Tsc, tmp_path: Path) -> None:
    file = tmp_path / "run.tsr"
    result = tsc("run", "-e", TEXT, "--record", file).gives(1)
    assert "FAULT DIVIDE_BY_ZERO" in result.out and "ine 3" in result.err
    assert tsc("run", file).gives(0).out == result.out


def test_a_world_of_a_file_is_in_the_file_of_the_run(tsc: Tsc, tmp_path: Path) -> None:
    file, world = tmp_path / "run.tsr", tmp_path / "own.toml"
    shipped_path = Path(recordings.__file__).parents[1] / "virtual" / "worlds" / "obstacles.toml"
    text = shipped_path.read_text(encoding="utf-8")
    world.write_text(text.replace("heading =", "heading = 33.333 #", 1), encoding="utf-8")
    tsc("run", "-e", "F(1, 60) UNTIL(DISTANCE < 15)", "--record", file, "--world", world).gives(0)
    world.unlink()
    assert tsc("run", file).gives(0).err.startswith(SAME_RUN_MESSAGE)


def test_a_real_run_is_recorded_and_compared(tsc: Tsc, tmp_path: Path) -> None:
    program, file = tmp_path / "p.ts", tmp_path / "run.tsr"
    program.write_text(TEXT)
    run_in_process("upload", program, "--virtual", "--record", file).gives(1, "3")
    recording = decode(file.read_bytes())
    assert (recording.program, recording.text, recording.robot_kind) == (CHECKSUM, TEXT, REAL)
    assert [row.event for row in recording.rows] == ["SHOW 5", "FAULT DIVIDE_BY_ZERO"]
    assert 0 < recording.rows[0].ms <= recording.rows[1].ms < 2000
    assert not is_foreign(file)
    result = tsc("run", file)
    assert (result.code, result.err) == (0, "Both robots did the same. Values compared: 2.\n")
    file.write_bytes(file.read_bytes().replace(b'SHOW 5"', b'SHOW 6"'))
    result = tsc("run", file, "--world", "line", "--lang", "es").gives(1)
    assert result.err.startswith("Línea 1: el robot dice 6 a los 0.")
    assert "el virtual, 5 a los 0.2 s" in result.err


SENSOR_PROGRAM = """LOOP(6)
  F(0.2, 60)
  X = DISTANCE * 2
  SHOW(X)
  IF(X < 60); SHOW(1); B(0.1, 50); ENDIF
END_LOOP
F(FOREVER, 60) UNTIL(DISTANCE < 20)
SHOW(LIGHT_L + LIGHT_R)"""


def test_a_real_run_is_recorded_with_its_readings_and_replayed_in_another_world(
    tmp_path: Path,
) -> None:
    program, file = tmp_path / "p.ts", tmp_path / "run.tsr"
    program.write_text(SENSOR_PROGRAM)
    result = run_in_process(
        "upload", program, "--virtual", "--world", "obstacles", "--record", file
    )
    assert result.gives(0, "").err == ""
    recording = decode(file.read_bytes())
    read_sensors = {row.event.split()[1] for row in recording.rows if row.is_reading}
    assert read_sensors == {"DISTANCE", "LIGHT_L", "LIGHT_R"}
    values = sum(row.event.startswith("SHOW") for row in recording.rows)
    for world in ("obstacles", "line"):
        result = run_in_process("run", file, "--world", world)
        assert (result.code, result.err) == (
            0,
            f"Both robots did the same. Values compared: {values + 1}.\n",
        )


def test_a_robot_without_reading_reports_is_noted(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(upload, "READINGS", 0)
    program, file = tmp_path / "p.ts", tmp_path / "run.tsr"
    program.write_text("X = DISTANCE;SHOW(1)")
    result = run_in_process("upload", program, "--virtual", "--record", file).gives(0)
    assert "This robot does not report what its program reads" in result.err
    assert not [row for row in decode(file.read_bytes()).rows if row.is_reading]
    result = run_in_process("run", file).gives(0)
    assert "the recording lacks that reading" in result.err


@pytest.mark.parametrize("hurry", ["20", "max"])
def test_a_virtual_robot_that_hurries_is_recorded_in_its_own_time(
    tmp_path: Path, hurry: str
) -> None:
    program, file = tmp_path / "p.ts", tmp_path / "run.tsr"
    program.write_text("X = 0; LOOP(6); W(2); X = X + 1; SHOW(X); END_LOOP; W(3)")
    run_in_process("upload", program, "--virtual", "--hurry", hurry, "--record", file).gives(0)
    events = decode(file.read_bytes()).rows
    assert [event.event for event in events] == [*(f"SHOW {k}" for k in range(1, 7)), "DONE"]
    for event, expected_ms in zip(events, (*range(2000, 12_001, 2000), 15_000), strict=True):
        assert expected_ms <= event.ms <= expected_ms + 100, events
    result = run_in_process("run", file)
    assert (result.code, result.err) == (0, "Both robots did the same. Values compared: 7.\n")


def test_a_run_that_is_stopped_ends_in_the_time_of_the_robot(tmp_path: Path) -> None:
    program, file = tmp_path / "p.ts", tmp_path / "run.tsr"
    program.write_text("SHOW(TRUE); W(FOREVER) UNTIL(FALSE)")
    run_in_process(
        "upload", program, "--virtual", "--hurry", "max", "--for", "30", "--record", file
    )
    first, last = decode(file.read_bytes()).rows
    assert (first.event, last.event) == ("SHOW TRUE", "STOPPED")
    assert first.ms <= 100 and last.ms >= 29_900


@pytest.mark.parametrize(
    ("events", "code", "expected"),
    [
        (
            ((200, "SHOW 5"), (400, "FAULT DIVIDE_BY_ZERO")),
            0,
            "Both robots did the same. Values compared: 2.",
        ),
        (((200, "SHOW 5"), (300, "LOST")), 0, "Both robots did the same. Values compared: 1."),
        (((200, "SHOW 5"), (400, "MISSED")), 0, "Some of the robot's values did not arrive"),
        ((), 1, "The recording ends before the robot sent anything"),
        (((200, "LOST"),), 1, "The recording ends before the robot sent anything"),
        (((900, "SHOW 5"),), 1, "Line 1: the times differ."),
        (((200, "SHOW 5"), (400, "DONE")), 1, "Line 3: the robot reported DONE after 0.4 s"),
        (((200, "SHOW 5"), (9000, "STOPPED")), 1, "Line 3: the virtual robot reported FAULT"),
    ],
)
def test_a_real_run_of_the_page_is_compared(
    tsc: Tsc, tmp_path: Path, events: tuple[tuple[int, str], ...], code: int, expected: str
) -> None:
    file = tmp_path / "run.tsr"
    file.write_bytes(real_recording(*events))
    assert not is_foreign(file)
    result = tsc("run", file)
    assert (result.code, result.err[: len(expected)]) == (code, expected)


def test_a_file_that_another_program_has_saved_is_read(tsc: Tsc, tmp_path: Path) -> None:
    """PowerShell and Notepad write a byte order mark and other line ends."""
    file = tmp_path / "run.tsr"
    text = real_recording((200, "SHOW 5"), (400, "FAULT DIVIDE_BY_ZERO")).decode() + "\n"
    for encoding in ("utf-8-sig", "utf-16", "utf-16-le", "utf-16-be"):
        mark = "\ufeff" if encoding.startswith("utf-16-") else ""
        for end in ("\n", "\r\n"):
            file.write_bytes((mark + text.replace("\n", end)).encode(encoding))
            result = tsc("run", file)
            assert result.err == "Both robots did the same. Values compared: 2.\n", (
                encoding,
                end,
                result,
            )


@pytest.mark.parametrize(
    ("data", "message", "dicho"),
    [
        (
            real_recording((5, "SHOW 1"))[:-4],
            "is damaged or is not a recorded run (line 3)",
            "(línea 3)",
        ),
        (HEAD.encode(), "the end of", "le falta el final"),
        (
            b'{"tiniscript_recording": 1}',
            "was recorded by an older tsc",
            "de un tsc anterior",
        ),
        (
            HEAD.replace('run":1', 'run":2').encode(),
            "was recorded by a newer tsc.",
            "viene de un tsc más nuevo",
        ),
        (HEAD.replace('"tinibot"', '"mine"').encode(), "does not have", "no trae"),
        (
            real_recording().replace(b"SHOW(5)", b"SHOW(6)"),
            "has a different meaning in this tsc",
            "significa otra cosa",
        ),
        (real_recording((999_999, "DONE")), "ten minutes at most", "diez minutos como máximo"),
        (HEAD.encode() + b" " * 1_100_000, "is too long", "es demasiado largo"),
    ],
    ids=["torn", "cut", "older", "newer", "robot", "program", "long", "large"],
)
def test_an_unplayable_file_is_refused_with_a_reason(
    tsc: Tsc, tmp_path: Path, data: bytes, message: str, dicho: str
) -> None:
    file = tmp_path / "run.tsr"
    file.write_bytes(data)
    for language, words in (("en", message), ("es", dicho)):
        tsc("run", file, "--lang", language).gives(2, words, out="")


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("run", "-e", TEXT, "--replay", "r"), "--replay any more. Try:  tsc run run.tsr"),
        (("run", "-e", TEXT, "--world", "line"), "--world works only with --record"),
        (("run", "p.bin", "--record", "new"), "needs the program's source"),
        (("run", "-e", TEXT, "--record", "new", "--world", "nowhere"), "nowhere"),
        (("run", "-e", TEXT, "--record", "new", "--robot", "own.toml"), "that come with tsc"),
        (("run", "-e", TEXT, "--record", "new", "--machine", "cpp"), "--machine does not work"),
        (("run", "-e", TEXT, "--record", "new", "--show"), "--show does not work with --record"),
        (("run", "-e", TEXT, "--record", "new", "--pace", "0"), "--pace does not work with"),
        (("run", "-e", TEXT, "--record", "letter"), "tsc did not write it."),
        (("run", "r", "--sensor", "DISTANCE=5"), "--sensor does not work with a recorded run"),
        (("run", "r", "--seed", "7"), "--seed does not work with a recorded run"),
        (("run", "r", "--max-time", "3"), "--max-time does not work with a recorded run"),
        (("run", "r", "--robot", "liner"), "--robot does not work with a recorded run"),
        (("run", "r", "--record", "new"), "--record does not work with a recorded run"),
        (("upload", "-e", "SB|S", "--record", "new"), "--record needs a run that tsc follows"),
        (("upload", "-e", TEXT, "--detach", "--record", "new"), "--record needs a run"),
        (("upload", "-e", TEXT, "--no-run", "--record", "new"), "--record needs a run"),
        (("upload", "-e", TEXT, "--all", "--record", "new"), "--record needs a run"),
        (("upload", "p.bin", "--virtual", "--record", "new"), "needs the program's source"),
        (("upload", "-e", TEXT, "--virtual", "--record", "letter"), "tsc did not write it."),
    ],
)  # fmt: skip
def test_unrecordable_runs_are_refused_with_a_reason(
    tsc: Tsc, working_folder: Path, words: tuple[str, ...], message: str
) -> None:
    assert tsc("compile", "-e", TEXT, "-o", "p.bin").code == 0
    shipped_path = Path(recordings.__file__).parents[1].joinpath("robots/tinibot.toml")
    robot_text = shipped_path.read_text(encoding="utf-8").replace(
        'name = "tinibot"', 'name = "own"'
    )
    Path("own.toml").write_text(robot_text, encoding="utf-8")
    Path("letter").write_bytes(b"a letter")
    Path("r").write_bytes(real_recording((5, "SHOW 5")))
    tsc(*words).gives(2, message, out="")
    assert Path("r").read_bytes() == real_recording((5, "SHOW 5")) and not Path("new").exists()


def record(
    file: Path, *events: tuple[str, str], start_s: float | None = None, end: str = ""
) -> tuple[Row, ...]:
    """Record these events of a robot; return the content of the file."""
    recorder = Recorder(str(file), HEAD, began_s=start_s)
    for event in events:
        recorder.add_event(7, *event)
    if end:
        recorder.end_recording(end)
    recorder.close()
    return decode(file.read_bytes()).rows


def test_a_recording_has_an_end_and_no_more(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file, show = tmp_path / "run.tsr", ("SHOW", "1")
    for end_options, expected_texts in (
        ((), ["SHOW 1", "STOPPED"]),
        ((("MISSED", "3"), ("SHOW", "2"), ("DONE", "")), ["SHOW 1", "MISSED"]),
        ((("TEXT", "hello"), ("STOPPED", "BUTTON"), ("DONE", "")), ["SHOW 1", "STOPPED"]),
    ):
        events = record(file, show, *end_options, start_s=monotonic())
        assert [event.event for event in events] == expected_texts
    with monkeypatch.context() as patch:
        patch.setattr(recordings, "MAX_ROW_BYTES", 30)
        events = record(file, *(("SHOW", str(k)) for k in range(9)), end="LOST")
    assert [event.event for event in events] == ["SHOW 0", "SHOW 1"]
    assert events[0] == Row(0, "SHOW 0")  # the value shown when the recording began
    start_s = monotonic()
    monkeypatch.setattr(recorder, "monotonic", lambda: 1e9)
    events = record(file, show, start_s=start_s)
    assert events == ()  # longer than may be
    assert record(file) == (Row(0, "STOPPED"),)


@pytest.mark.parametrize("seed", range(20))
def test_messages_after_the_end_of_a_run_are_not_recorded(tmp_path: Path, seed: int) -> None:
    rng, file, kit = Random(seed), tmp_path / "run.tsr", robots.load("tinibot").kit
    tested_recorder = Recorder(str(file), HEAD, monotonic(), kit=kit)
    for k in range(12):
        name = rng.choice(["SHOW", "READING", "READING", "TEXT", *ENDING_EVENTS])
        if name == "READING":
            tested_recorder.add_reading(ReadingEvent(7, rng.randrange(3), 1000 * k, 0))
        else:
            tested_recorder.add_event(7, name, "OVERFLOW" if name == "FAULT" else str(k))
    tested_recorder.close()
    names = [row.event.partition(" ")[0] for row in decode(file.read_bytes()).rows]
    assert names[-1] in ENDING_EVENTS and not {*names[:-1]} & {*ENDING_EVENTS}


@pytest.mark.parametrize(("event", "expected_text"), [("", "STOPPED"), ("LOST", "LOST")])
def test_a_recording_ends_when_the_run_does(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, event: str, expected_text: str
) -> None:
    """A robot that hangs after its first value and is stopped by hand has not done the same."""
    file, clock = tmp_path / "run.tsr", iter((10.2, 70.0))
    monkeypatch.setattr(recorder, "monotonic", lambda: next(clock))
    events = record(file, ("SHOW", "5"), start_s=10.0, end=event)
    assert events == (Row(200, "SHOW 5"), Row(60_000, expected_text))
    compared_divergence = play(prepare(decode(file.read_bytes()))).divergence
    assert compared_divergence is not None and compared_divergence.outcome == (
        "same" if event else "virtual_more"
    )


def test_after_ctrl_c_the_time_of_saving_does_not_count(
    tsc: Tsc, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file, now_s = tmp_path / "run.tsr", [5.0]

    def raise_ctrl_c(*_: object) -> int:
        now_s[0] += 2
        raise KeyboardInterrupt

    def save_slowly(_: Saving) -> None:
        now_s[0] += 30

    def make_printer_slowly(*arguments: object) -> EventPrinter:
        now_s[0] += 3  # the robot runs while this is loaded, and its time counts from before
        return make_printer(*arguments)  # type: ignore[arg-type]

    make_printer = event_printer.printer_of
    monkeypatch.setattr(upload, "printer_of", make_printer_slowly)
    monkeypatch.setattr(upload, "monotonic", lambda: now_s[0])
    monkeypatch.setattr(recorder, "monotonic", lambda: now_s[0])
    monkeypatch.setattr(upload, "follow_run", raise_ctrl_c)
    monkeypatch.setattr(Saving, "wait", save_slowly)
    monkeypatch.setattr(CommandSimulator, "event_ms", None)  # like a real robot, it has no clock
    tsc("upload", "-e", "SI|F(9, 60)", "--virtual", "--record", file).gives(2, "confirmed")
    assert decode(file.read_bytes()).rows == (Row(5000, "STOPPED"),)


def test_a_full_disk_is_reported_while_recording(tmp_path: Path) -> None:
    with pytest.raises(CommandError) as exception_info:
        Recorder(str(tmp_path / "no" / "run.tsr"), HEAD, began_s=monotonic())
    assert "with --record" in exception_info.value.sentence("en")
    if Path("/dev/full").exists():
        with pytest.raises(CommandError, match="unwritable_more"):
            Recorder("/dev/full", HEAD, began_s=monotonic())


def test_each_row_is_in_the_file_before_the_next_one_comes(tmp_path: Path) -> None:
    """This holds however the command ends."""
    path, written_text = tmp_path / "rows.csv", "head\n"
    rows = Rows(str(path), written_text.encode())
    for k in range(4):
        rows.add_row(k, "a")
        written_text += f"{k},a\n"
        assert path.read_text("utf-8") == written_text
        rows.add_line(f"line {k}")
        written_text += f"line {k}\n"
        assert path.read_text("utf-8") == written_text
    rows.close()


def test_a_disk_that_is_full_is_said_at_each_row_and_leaves_the_old_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object) -> None:
        raise OSError(28, "No space left on device")

    path = tmp_path / "rows.csv"
    rows = Rows(str(path), b"old\n")
    rows._file.close()
    rows._file = cast(TextIOWrapper, SimpleNamespace(write=fail, flush=fail, close=fail))
    for add in (partial(rows.add_row, 1, "a"), partial(rows.add_line, "a")):
        for _ in range(2):
            with pytest.raises(CommandError, match="unwritable_more"):
                add()
    rows.close()  # nothing more is said
    monkeypatch.setattr(files, "replace", fail)
    with pytest.raises(CommandError, match="unwritable_more"):
        Rows(str(path), b"new\n")
    assert path.read_text("utf-8") == "old\n"


def test_a_run_that_a_button_begins_counts_from_its_first_event(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its file is closed at its end."""
    now_s = 100.0
    monkeypatch.setattr(recorder, "monotonic", lambda: now_s)
    record = Recorder(str(tmp_path / "run.tsr"), HEAD, began_s=None)
    now_s += 7
    for value in ("1", "2", "3"):
        record.add_event(0, "SHOW", value)
        now_s += 0.5
    record.close()
    assert record._rows._file.closed
    rows = decode((tmp_path / "run.tsr").read_bytes()).rows
    expected = [(0, "SHOW 1"), (500, "SHOW 2"), (1000, "SHOW 3"), (1500, "STOPPED")]
    assert [(row.ms, row.event) for row in rows] == expected
