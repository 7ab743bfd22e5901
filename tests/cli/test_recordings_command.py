"""`tsc upload --record` and `tsc run --replay`: the same files as those of the studio."""

from __future__ import annotations

import json
from pathlib import Path
from time import monotonic

import pytest

from tests.support.command import Done, Tsc, inside
from tiniscript import compile
from tiniscript.cli.commands import upload
from tiniscript.cli.errors import CommandError
from tiniscript.cli.paths import is_foreign
from tiniscript.cli.robot import event_printer, recorder
from tiniscript.cli.robot.event_printer import EventPrinter
from tiniscript.cli.robot.recorder import Recorder
from tiniscript.cli.robot.run_monitor import Saving
from tiniscript.cli.robot.simulator import CommandSimulator
from tiniscript.studio import recordings
from tiniscript.studio.recordings import Recorded, read, replay
from tiniscript.virtual import worlds

TEXT = "SI|W(0.2); SHOW(5);\nX = 0; W(0.2);\nSHOW(1 / X)"
CHECKSUM = compile(TEXT).checksum


def of_the_page(*events: tuple[int, str]) -> bytes:
    """Return a file as the studio's page writes it."""
    head = {"tiniscript_recording": 1, "program": f"{CHECKSUM:08x}", "robot": "tinibot"}
    rows = [head, *({"ms": ms, "event": event} for ms, event in events)]
    return "".join(json.dumps(row, separators=(",", ":")) + "\n" for row in rows).encode()


def test_a_run_is_recorded_and_compared(tsc: Tsc, tmp_path: Path) -> None:
    program, file = tmp_path / "p.ts", tmp_path / "run.jsonl"
    program.write_text(TEXT)
    inside("upload", program, "--virtual", "--record", file).gives(1, "3")
    recording = read(file.read_bytes())
    assert recording.program == CHECKSUM
    assert [event.event for event in recording.events] == ["SHOW 5", "FAULT DIVIDE_BY_ZERO"]
    assert 0 < recording.events[0].ms <= recording.events[1].ms < 2000
    assert not is_foreign(file)
    done = tsc("run", program, "--replay", file)
    assert (done.code, done.out) == (
        0, "Both did the same. Comparisons: 2.\n",
    )  # fmt: skip
    file.write_bytes(file.read_bytes().replace(b"SHOW 5", b"SHOW 6"))
    done = tsc("run", program, "--replay", file, "--world", "line", "--lang", "es").gives(1)
    assert done.out.startswith("Línea 1: el robot dice 6 a los 0.")
    assert "el virtual, 5 a los 0.2 s" in done.out


@pytest.mark.parametrize("hurry", ["20", "max"])
def test_a_virtual_robot_that_hurries_is_recorded_in_its_own_time(
    tmp_path: Path, hurry: str
) -> None:
    program, file = tmp_path / "p.ts", tmp_path / "run.jsonl"
    program.write_text("X = 0; LOOP(6); W(2); X = X + 1; SHOW(X); END_LOOP; W(3)")
    inside("upload", program, "--virtual", "--hurry", hurry, "--record", file).gives(0)
    events = read(file.read_bytes()).events
    assert [event.event for event in events] == [*(f"SHOW {k}" for k in range(1, 7)), "DONE"]
    for each, wanted_ms in zip(events, (*range(2000, 12_001, 2000), 15_000), strict=True):
        assert wanted_ms <= each.ms <= wanted_ms + 100, events
    done = inside("run", program, "--replay", file)
    assert (done.code, done.out) == (0, "Both did the same. Comparisons: 7.\n")


def test_a_run_that_is_stopped_ends_in_the_time_of_the_robot(tmp_path: Path) -> None:
    program, file = tmp_path / "p.ts", tmp_path / "run.jsonl"
    program.write_text("SHOW(TRUE); W(FOREVER) UNTIL(FALSE)")
    inside("upload", program, "--virtual", "--hurry", "max", "--for", "30", "--record", file)
    first, last = read(file.read_bytes()).events
    assert (first.event, last.event) == ("SHOW TRUE", "STOPPED")
    assert first.ms <= 100 and last.ms >= 29_900


@pytest.mark.parametrize(
    ("events", "code", "said"),
    [
        (((200, "SHOW 5"), (400, "FAULT DIVIDE_BY_ZERO")), 0, "Both did the same. Comparisons: 2."),
        (((200, "SHOW 5"), (300, "LOST")), 0, "Both did the same. Comparisons: 1."),
        (((200, "SHOW 5"), (400, "MISSED")), 0, "Then values of the robot did not arrive"),
        ((), 1, "The recording ends before the robot said anything"),
        (((200, "LOST"),), 1, "The recording ends before the robot said anything"),
        (((900, "SHOW 5"),), 1, "Line 1: the robot got there at another time."),
        (((200, "SHOW 5"), (400, "DONE")), 1, "Line 3: the robot says DONE after 0.4 s"),
        (((200, "SHOW 5"), (9000, "STOPPED")), 1, "Line 3: the virtual robot says FAULT"),
    ],
)
def test_a_recording_of_the_page_is_compared(
    tsc: Tsc, tmp_path: Path, events: tuple[tuple[int, str], ...], code: int, said: str
) -> None:
    file = tmp_path / "run.jsonl"
    file.write_bytes(of_the_page(*events))
    assert not is_foreign(file)
    done = tsc("run", "-e", TEXT, "--replay", file)
    assert (done.code, done.out[: len(said)]) == (code, said)
    done = tsc("run", "-e", "SHOW(5)", "--replay", file)
    assert (done.code, done.out[:39]) == (1, "The recording is of another program. Na")


def test_a_recording_that_another_program_has_saved_is_read(tsc: Tsc, tmp_path: Path) -> None:
    """PowerShell and Notepad write a byte order mark and other line ends."""
    file = tmp_path / "run.jsonl"
    text = of_the_page((200, "SHOW 5"), (400, "FAULT DIVIDE_BY_ZERO")).decode() + "\n"
    for encoding in ("utf-8-sig", "utf-16", "utf-16-le", "utf-16-be"):
        mark = "\ufeff" if encoding.startswith("utf-16-") else ""
        for end in ("\n", "\r\n"):
            file.write_bytes((mark + text.replace("\n", end)).encode(encoding))
            done = tsc("run", "-e", TEXT, "--replay", file)
            assert done.out == "Both did the same. Comparisons: 2.\n", (encoding, end, done)


@pytest.mark.parametrize(
    ("data", "said", "dicho"),
    [
        (b"a letter", "is damaged, or no recording (line 1)", "no es una grabación (línea 1)"),
        (of_the_page((5, "SHOW 1"))[:-4], "(line 2)", "(línea 2)"),
        (b'{"tiniscript_recording": 2}', "comes from a newer tsc", "viene de un tsc más nuevo"),
        (of_the_page((999_999, "DONE")), "ten minutes at most", "diez minutos como máximo"),
        (b" " * 1_100_000, "is too long", "es demasiado largo"),
    ],
    ids=["letter", "cut", "newer", "long", "large"],
)
def test_a_file_that_cannot_be_compared_says_why(
    tsc: Tsc, tmp_path: Path, data: bytes, said: str, dicho: str
) -> None:
    file = tmp_path / "run.jsonl"
    file.write_bytes(data)
    for language, words in (("en", said), ("es", dicho)):
        tsc("run", "-e", TEXT, "--replay", file, "--lang", language).gives(2, words, out="")


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("run", "-e", TEXT, "--world", "line"), "--world is for --replay"),
        (("run", "p.bin", "--replay", "r"), "needs the program as text"),
        (("run", "-e", TEXT, "--replay", "nowhere"), "there is no file nowhere"),
        (("run", "-e", TEXT, "--replay", "r", "--world", "nowhere"), "nowhere"),
        (("run", "-e", TEXT, "--replay", "r", "--robot", "own.toml"), "robots that tsc brings"),
        (("run", "-e", TEXT, "--replay", "r", "--robot", "liner"), "is of the robot tinibot, and"),
        (("upload", "-e", "SB|S", "--record", "r"), "--record is for one run that tsc follows"),
        (("upload", "-e", TEXT, "--detach", "--record", "r"), "--record is for one run"),
        (("upload", "-e", TEXT, "--no-run", "--record", "r"), "--record is for one run"),
        (("upload", "-e", TEXT, "--all", "--record", "r"), "--record is for one run"),
        (("upload", "-e", TEXT, "--virtual", "--record", "letter"), "tsc has not made it"),
    ],
)
def test_what_is_not_recorded_or_compared_says_why(
    tsc: Tsc, here: Path, words: tuple[str, ...], said: str
) -> None:
    assert tsc("compile", "-e", TEXT, "-o", "p.bin").code == 0
    Path("own.toml").write_text(Path(recordings.__file__).parents[1].joinpath(
        "robots/tinibot.toml").read_text(encoding="utf-8"), encoding="utf-8")  # fmt: skip
    Path("letter").write_bytes(b"a letter")
    Path("r").write_bytes(of_the_page((5, "SHOW 5")))
    tsc(*words).gives(2, said, out="")
    assert Path("r").read_bytes() == of_the_page((5, "SHOW 5"))


def test_what_a_comparison_does_not_take_is_refused(tsc: Tsc, tmp_path: Path) -> None:
    file = tmp_path / "run.jsonl"
    file.write_bytes(of_the_page((200, "SHOW 5")))
    for words in (
        ("--sensor", "DISTANCE=5"), ("--seed", "7"), ("--max-time", "3"), ("--max-steps", "9"),
        ("--machine", "python"), ("--show",), ("--pace", "0"), ("--pace", "fast"),
    ):  # fmt: skip
        for language, said in (("en", "does not go with --replay"), ("es", "no va con --replay")):
            done = tsc("run", "-e", TEXT, "--replay", file, *words, "--lang", language)
            assert (done.code, done.out) == (2, ""), words
            assert f"{words[0]} {said}" in done.err


def test_the_robot_of_a_comparison_is_that_of_the_recording(tsc: Tsc, tmp_path: Path) -> None:
    text, file = "SI|SHOW(LINE_L)", tmp_path / "run.jsonl"
    event = {"ms": 3, "event": "SHOW FALSE"}
    head = {"tiniscript_recording": 1, "program": f"{compile(text, 'liner').checksum:08x}"}

    def done_with(robot: object, *words: str) -> Done:
        rows = [head if robot is None else {**head, "robot": robot}, event]
        file.write_text("".join(json.dumps(row) + "\n" for row in rows), encoding="utf-8")
        return tsc("run", "-e", text, "--replay", file, *words)

    for words in ((), ("--robot", "liner")):
        done = done_with("liner", *words)
        assert (done.code, done.out) == (0, "Both did the same. Comparisons: 1.\n"), done.err
    assert done_with(None, "--robot", "liner").code == 0  # no robot in the file
    assert done_with(None).out.startswith("The recording is of another program.")  # for tinibot
    for robot in ("mine", "../liner", "", "a\x1b[31m\n" * 999):
        done_with(robot).gives(2, "that tsc brings: tinibot", out="")
        done = done_with(robot, "--robot", "liner", "--lang", "es").gives(2, "y --robot dice liner")
        assert "\x1b" not in done.err and len(done.err) < 1000
    for odd in (5, ["liner"], False):
        assert "is damaged, or no recording (line 1)" in done_with(odd).err


def recorded(
    file: Path, *events: tuple[str, str], began_s: float | None = None, end: str = ""
) -> tuple[Recorded, ...]:
    """Record these events of a robot; return what the file has then."""
    made = Recorder(str(file), CHECKSUM, "tinibot", began_s=began_s)
    for event in events:
        made.add(7, *event)
    if end:
        made.end(end)
    made.close()
    return read(file.read_bytes()).events


def test_a_recording_has_an_end_and_no_more(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file, show = tmp_path / "run.jsonl", ("SHOW", "1")
    for ends, wanted in (
        ((), ["SHOW 1", "STOPPED"]),
        ((("MISSED", "3"), ("SHOW", "2"), ("DONE", "")), ["SHOW 1", "MISSED"]),
        ((("TEXT", "hello"), ("STOPPED", "BUTTON"), ("DONE", "")), ["SHOW 1", "STOPPED"]),
    ):
        events = recorded(file, show, *ends, began_s=monotonic())
        assert [event.event for event in events] == wanted
    monkeypatch.setattr(recorder, "MOST", 3)
    events = recorded(file, *(("SHOW", str(k)) for k in range(9)), end="LOST")
    assert [event.event for event in events] == ["SHOW 0", "SHOW 1", "STOPPED"]
    assert events[0] == Recorded(0, "SHOW 0")  # it began with that
    began_s = monotonic()
    monkeypatch.setattr(recorder, "monotonic", lambda: 1e9)
    events = recorded(file, show, began_s=began_s)
    assert events == (Recorded(600_000, "STOPPED"),)  # as long as may be
    assert recorded(file) == (Recorded(0, "STOPPED"),)


@pytest.mark.parametrize(("event", "wanted"), [("", "STOPPED"), ("LOST", "LOST")])
def test_a_recording_ends_when_the_run_does(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, event: str, wanted: str
) -> None:
    """A robot that hangs after its first value and is stopped by hand has not done the same."""
    file, clock = tmp_path / "run.jsonl", iter((10.2, 70.0))
    monkeypatch.setattr(recorder, "monotonic", lambda: next(clock))
    events = recorded(file, ("SHOW", "5"), began_s=10.0, end=event)
    assert events == (Recorded(200, "SHOW 5"), Recorded(60_000, wanted))
    compared = replay(read(file.read_bytes()), TEXT.encode(), "tinibot", worlds.load("obstacles"))
    assert compared.what == ("same" if event else "virtual_more")


def test_after_ctrl_c_saving_is_no_time_of_the_run(
    tsc: Tsc, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file, now_s = tmp_path / "run.jsonl", [5.0]

    def ctrl_c(*_: object) -> int:
        now_s[0] += 2
        raise KeyboardInterrupt

    def saves(_: Saving) -> None:
        now_s[0] += 30

    def printer(*given: object) -> EventPrinter:
        now_s[0] += 3  # the robot runs while this is loaded, and its time counts from before
        return made(*given)  # type: ignore[arg-type]

    made = event_printer.printer_of
    monkeypatch.setattr(upload, "printer_of", printer)
    monkeypatch.setattr(upload, "monotonic", lambda: now_s[0])
    monkeypatch.setattr(recorder, "monotonic", lambda: now_s[0])
    monkeypatch.setattr(upload, "follow_run", ctrl_c)
    monkeypatch.setattr(Saving, "wait", saves)
    monkeypatch.setattr(CommandSimulator, "told_ms", None)  # as a real robot, it has no clock
    tsc("upload", "-e", "SI|F(9, 60)", "--virtual", "--record", file).gives(2, "confirmed")
    assert read(file.read_bytes()).events == (Recorded(5000, "STOPPED"),)


def test_a_place_without_room_says_so(tmp_path: Path) -> None:
    with pytest.raises(CommandError) as refused:
        Recorder(str(tmp_path / "no" / "run.jsonl"), CHECKSUM, "tinibot", began_s=monotonic())
    assert "with --record" in refused.value.sentence("en")
    if Path("/dev/full").exists():
        with pytest.raises(CommandError, match="unwritable_more"):
            Recorder("/dev/full", CHECKSUM, "tinibot", began_s=monotonic())
