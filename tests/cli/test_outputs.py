"""No command overwrites its input: every output of every verb, by every name."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.support import edited_robots
from tests.support.command import PROGRAM, TSC, CommandResult, Tsc
from tests.support.verbs import parsers, values_of, words_of
from tests.support.waiting import HANG_LIMIT_S
from tiniscript.cli import paths
from tiniscript.cli.texts.options import options_of
from tiniscript.robots import DEFAULT
from tiniscript.virtual import worlds

PACKAGE_FOLDER = Path(sys.modules["tiniscript"].__file__ or "").parent
PROFILE = edited_robots.TEXTS[DEFAULT]
WORLD = (worlds.FOLDER / "obstacles.toml").read_text(encoding="utf-8")
TEXTS = {"program": PROGRAM, "robot": PROFILE, "world": WORLD, "memory": "m" * 1024}
PARSERS = parsers()

# each output of each verb, against everything that this verb reads, and against its other outputs
PAIRS = [
    (verb, output, other_output)
    for verb, parser in PARSERS.items()
    for output in values_of(parser)
    for other_output in values_of(parser)
    if output in paths.WRITE_OPTIONS
    and other_output != output
    and {other_output} & {*paths.READ_OPTIONS, *paths.WRITE_OPTIONS}
    if not (verb == "monitor" and output == "plot")
]
# Arguments of a verb before its files.
ACTIONS = {"lesson": ("check", "1"), "class": ("upload",)}


def arguments(verb: str, files: dict[str, Path]) -> list[str]:
    """Return the words of a command with these files for its options."""
    options = values_of(PARSERS[verb])
    words = [*words_of(verb), *ACTIONS.get(verb, ())]
    if "program" in options and "program" not in files:
        words += ["-e", PROGRAM]
    for dest, path in files.items():
        words += [options[dest], str(path)] if options[dest] else [str(path)]
    return (
        [*words, "--virtual"]
        if {"plot"} & set(files) and verb not in ("robot", "lesson")
        else words
    )


def test_every_option_with_a_value_is_classified_as_file_or_not() -> None:
    """Every new option must be classified; a name of a file in one verb is one in all."""
    read_files = {("compile", "map", "program"), ("compile", "output", "program")}
    assert read_files | {("show_port", "output", "robot")} <= set(PAIRS)
    for verb, parser in PARSERS.items():
        kinds = {option.name: option.kind for option in options_of(verb)}
        for dest in values_of(parser):
            kind = kinds[dest]
            assert kind is not None, f"{verb}: {dest}"
            assert (kind.reads, kind.writes) == (
                paths.READ_OPTIONS.get(dest, ""), paths.WRITE_OPTIONS.get(dest, ("", ""))[1]
            ), f"{verb}: {dest}"  # fmt: skip
            is_file = kind.name in ("program", "robot", "world", "port", "file")
            assert is_file == bool(kind.reads or kind.writes), f"{verb}: {dest}"


def test_every_file_that_the_command_writes_comes_from_such_an_option() -> None:
    """A new option that writes a file must be added to `WRITES`, and then get a line here."""
    places = {
        "outputs.write_output(target,": "output",  # of compile
        "outputs.write_output(options.output,": "output",
        "outputs.write(Path(options.output),": "output",
        "outputs.write(Path(options.map),": "map",
        "outputs.write(path,": "export",  # of keys
        "outputs.write(Path(options.csv),": "csv",
        "outputs.write(Path(options.plot),": "plot",
        "outputs.write(Path(options.report),": "report",
        "outputs.write(Path(options.record),": "record",  # of run, for the whole recording
        "outputs.write(Path(self.options.memory),": "memory",
        "outputs.write(program_input.path,": "program",  # fmt, in place; check --fix of one program
        "outputs.write(Path(program_input.name),": "programs",  # check --fix, in place
        'path.open("a"': "csv",  # rows, and lines of a recording
        'path.open("w"': "record",
    }
    known_options = set()
    for file in sorted((PACKAGE_FOLDER / "cli").rglob("*.py")):
        for line in file.read_text(encoding="utf-8").splitlines():
            words = ("outputs.write(", "outputs.write_output(", '.open("w', '.open("a',
                     "write_text(", "write_bytes(")  # fmt: skip
            is_file = "outputs.write_output(None," not in line  # None means standard output
            if is_file and any(word in line for word in words):
                known_names = [place for place in places if place in line]
                assert known_names, f"{file.name}: {line.strip()}"
                known_options |= set(known_names)
    assert known_options == set(places)
    assert {places[name] for name in known_options} == {*paths.WRITE_OPTIONS, "program", "programs"}


@pytest.mark.sampled("spelling")
@pytest.mark.parametrize("spelling", ["same", "dot", "link", "hard"])
@pytest.mark.parametrize(("verb", "output", "other_output"), PAIRS)
def test_no_output_overwrites_another_file_of_its_command(
    tsc: Tsc, working_folder: Path, verb: str, output: str, other_output: str,
    spelling: str,
) -> None:  # fmt: skip
    text = TEXTS.get(other_output, "what was there")
    precious = working_folder / "precious.ts"
    precious.write_text(text, encoding="utf-8")
    path = {"same": precious, "dot": Path("./precious.ts")}.get(
        spelling, working_folder / "other name"
    )
    if spelling == "link":
        path.symlink_to(precious)
    elif spelling == "hard":
        os.link(precious, path)
    files_before = sorted(os.listdir(working_folder))  # noqa: PTH208
    for language in ("en", "es"):
        tsc(*arguments(verb, {other_output: precious, output: path}), "--lang", language).gives(
            2, str(path), precious.name, paths.WRITE_OPTIONS[output][0]
        )
    assert precious.read_text(encoding="utf-8") == text
    assert sorted(os.listdir(working_folder)) == files_before  # noqa: PTH208 - nothing was made either


def test_the_default_image_path_is_also_an_output(tsc: Tsc, tmp_path: Path) -> None:
    program = tmp_path / "a.ts"
    program.write_text(PROGRAM)
    image_file = tmp_path / "a.bin"
    assert tsc("compile", program, "--map", image_file).code == 2
    profile = tmp_path / "a.bin"
    profile.write_text(PROFILE, encoding="utf-8")
    tsc("compile", program, "--robot", profile).gives(2, "-o would overwrite")
    assert profile.read_text(encoding="utf-8") == PROFILE


def test_two_paths_of_one_missing_file_are_recognized(tsc: Tsc, working_folder: Path) -> None:
    """Capitals do not count: on many systems they do not once the files are there."""
    (working_folder / "folder").mkdir()
    (working_folder / "link").symlink_to("x")
    (working_folder / "loop").symlink_to("loop")
    for second_path in ("x", "./x", "X", "folder/../x", "link"):
        result = tsc("compile", "-e", PROGRAM, "-o", "x", "--map", second_path)
        assert result.code == 2 and "the same file" in result.err, second_path
        assert not (working_folder / "x").exists()
    assert tsc("compile", "-e", PROGRAM, "-o", "link", "--map", "x").code == 2
    assert tsc("compile", "-e", PROGRAM, "-o", "loop").code == 2
    for _ in range(2):  # in the second pass the files exist
        assert tsc("compile", "-e", PROGRAM, "-o", "x", "--map", "y").code == 0


@pytest.mark.parametrize("words", [
    "compile - -o a.ts < a.ts", "compile /dev/stdin -o a.ts < a.ts",
    "compile a.ts -o /dev/stdout >> a.ts", "compile a.ts -o /dev/fd/3 3>> a.ts",
    "live --virtual --plot a.ts < a.ts",
])  # fmt: skip
def test_a_file_after_a_standard_stream_is_a_file(tmp_path: Path, words: str) -> None:
    (tmp_path / "a.ts").write_text(PROGRAM)
    command = ["sh", "-c", f"{' '.join(TSC)} {words}"]
    completed = subprocess.run(
        command, cwd=tmp_path, capture_output=True, text=True, timeout=HANG_LIMIT_S
    )
    assert CommandResult(completed.returncode, completed.stdout, completed.stderr).code == 2
    assert (tmp_path / "a.ts").read_text() == PROGRAM


def test_devices_and_pipes_may_be_written(tsc: Tsc, tmp_path: Path) -> None:
    program, pipe, null = tmp_path / "a.ts", tmp_path / "p", "/dev/null"
    program.write_text(PROGRAM)
    assert tsc("compile", program, "-o", null, "--map", null).code == 0
    assert tsc("compile", null, "-o", null).code == 0
    assert Path(null).is_char_device()
    os.mkfifo(pipe)
    with subprocess.Popen(["cat", pipe], stdout=subprocess.PIPE) as reader:
        result = tsc("compile", program, "-o", pipe)
        if result.code:
            reader.kill()  # otherwise it would wait for a reader of the pipe
        assert result.code == 0
        assert reader.communicate(timeout=HANG_LIMIT_S)[0].startswith(b"TS\x02")
    assert pipe.is_fifo()
    if Path("/dev/full").exists():
        tsc("compile", program, "-o", "/dev/full").gives(2, "-o")


def test_a_file_with_the_name_of_a_shipped_robot_is_not_read(
    tsc: Tsc, working_folder: Path
) -> None:
    for _ in range(2):
        assert tsc("firmware", "--board", "tinibot", "-o", "tinibot").code == 0


OUTPUTS = [
    (verb, output)
    for verb, parser in PARSERS.items()
    for output in values_of(parser)
    if output in paths.WRITE_OPTIONS and not (verb == "monitor" and output == "plot")
]


@pytest.mark.parametrize(("verb", "output"), OUTPUTS)
def test_unwritable_outputs_are_reported_before_anything_is_done(
    tsc: Tsc, working_folder: Path, monkeypatch: pytest.MonkeyPatch, verb: str, output: str
) -> None:
    """No robot drives for a picture that has no place."""
    monkeypatch.setattr("tiniscript.cli.inputs.robot", lambda *_: pytest.fail("something is done"))
    files = {"robot": Path("tinibot")} if verb == "firmware_board" else {}
    for path in (working_folder, working_folder / "none" / "x", Path("a\0b"), Path("x" * 5000)):
        words = arguments(verb, {**files, output: path})
        tsc(*words).gives(2, paths.WRITE_OPTIONS[output][0])
    assert list(working_folder.iterdir()) == []


def test_a_write_protected_file_is_refused(
    tsc: Tsc, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    output = tmp_path / "x.bin"
    output.write_bytes(b"mine")
    real_call = os.access
    monkeypatch.setattr(  # root may write everything, so no file would do
        os, "access", lambda path, mode: Path(path) != output and real_call(path, mode)
    )
    assert tsc("compile", "-e", PROGRAM, "-o", output).code == 2
    assert output.read_bytes() == b"mine"
