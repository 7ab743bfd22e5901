"""The command answers any input, on any stream, in any locale."""

from __future__ import annotations

import io
import json
import os
import shlex
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from tests.support.command import PROGRAM, TSC, Command, Tsc
from tiniscript.bytecode.image import unpack
from tiniscript.cli import help, main
from tiniscript.library import source_map
from tiniscript.link import known_ports
from tiniscript.link.sharing import registry
from tiniscript.virtual import directory

# -- arbitrary input -----------------------------------------------------------------------------


def hostile(count: int) -> dict[str, bytes]:
    """Return unusual inputs, of at most this many parts."""
    return {
        "empty": b"",
        "binary": bytes(range(256)) * 100,
        "nul": b"SI|F(2,80)\0",
        "latin-1": "SI|AÑO = 5".encode("latin-1"),
        "utf-16": "SI|F(2,80)".encode("utf-16"),
        "too large": b"W(1);" * 200_001,
        "ten megabytes": b"x" * 10_000_000,
        "parentheses": b"X = " + b"(" * count + b"1" + b")" * count,
        "open parentheses": b"X = " + b"(" * count,
        "functions": b"X = " + b"ABS(" * (count // 3) + b"1" + b")" * (count // 3),
        "minus": b"X = " + b"-" * count + b"TIME",
        "sum": b"X = 0" + b"+TIME" * count,
        "and": b"X = TRUE" + b" AND TRUE" * (count // 2),
        "nested": b"IF(TRUE);" * (count // 2),
        "nested and closed": b"IF(TRUE);" * (count // 5) + b"ENDIF;" * (count // 5),
        "defs": b"DEF A;" * (count // 2),
        "ends": b"ENDIF;" * (count // 2),
        "elses": b"IF(TRUE);" + b"ELSEIF(TRUE);" * (count // 3) + b"ENDIF",
        "quotes": b'"' * (5 * count),
        "letters": "é".encode() * (4 * count),
        "digits": b"X = " + b"9" * (9 * count),
        "name": b"X" * (9 * count) + b" = 1",
        "lines": b"\n" * (9 * count),
        "separators": b";" * (9 * count),
        "emoji": "🤖".encode() * 1000,
        "right to left": "\u202eF(2,80)".encode(),
        "bars": b"SI|" * (count // 10),
        "commas": b"F(" + b"1," * count + b"1)",
        "long condition": b"A=TRUE;IF(A" + b" AND A" * (count * 3 // 2) + b");S;ENDIF",
        "decided": b"A=1;C=A/1=1" + b" AND FALSE" * (count * 4 // 5) + b";SHOW(C)",
        "not": b"A=TRUE;IF(" + b"NOT " * (2 * count) + b"A);S;ENDIF",
        "unknown names": b";".join(b"QWERTYUIO%d=Z%d" % (k, k) for k in range(count * 2 // 5)),
        "units": b"F(20 DEG, 60);" * (count // 10),
        "questions": b"IF(TIME>1) " * (count // 10),
        "calls on one line": b"beep(1 440) " * (count // 12),
        "questions in words": b"F(5, 60) UNTIL(cerca);" * (count // 22),
        "a call without its DEF": b"DEF;S;END_DEF\n" + b"PASO\n" * (count // 5),
        "wide header": b"IF(" + b"+".join([b"1"] * 60) + b", 2);S;ENDIF",
    }


@pytest.mark.sampled("verb", "name", keep=9)
@pytest.mark.parametrize("name", sorted(hostile(0)))
@pytest.mark.parametrize("verb", ["check", "compile", "run", "show", "fmt"])
def test_any_input_gets_an_answer(tsc: Tsc, tmp_path: Path, verb: str, name: str) -> None:
    """Inputs are as large as `check` allows, and a tenth of that for the others."""
    program = tmp_path / "any.ts"
    extra_options = ["--max-steps", "1000"] if verb == "run" else []
    program.write_bytes(hostile(100_000 if verb == "check" else 10_000)[name])
    # Texts about programs are the same for all verbs, so one verb tests the other language.
    result = tsc(verb, program, "--lang", "en" if verb == "compile" else "es", *extra_options)
    assert result.code in (0, 1), result.err[-2000:]
    if name in ("too large", "ten megabytes", "binary", "nul", "latin-1", "utf-16"):
        assert result.code == 1


@pytest.mark.parametrize("verb", ["compile", "check", "run", "show", "fmt"])
def test_irregular_and_unreadable_files_are_refused(
    tsc: Tsc, tmp_path: Path, program: Path, monkeypatch: pytest.MonkeyPatch, verb: str
) -> None:
    folder = tmp_path / "folder"
    folder.mkdir()
    for name in (folder, tmp_path / "missing.ts", "a\0b", "a" * 5000, ""):
        assert tsc(verb, name).code == 2
    assert tsc(verb).code == 2
    assert tsc(verb, "-e", PROGRAM, "a.ts").code == 2

    def refuse(*_: object, **__: object) -> None:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(Path, "open", refuse)  # root may read everything, so no file would do
    tsc(verb, program).gives(2, "no permission to read")


def test_a_missing_verb_and_an_unknown_verb_are_refused(tsc: Tsc) -> None:
    assert tsc().code == 0
    assert tsc().out == tsc("--help").out == help.overview("en")
    assert tsc("--lang", "es", "--help").out == help.overview("es")
    assert tsc("--version").out.startswith("tsc (TiniScript) ")
    tsc("complie").gives(2, "compile")
    assert tsc("--lang", "es", "check", "-e", "W(1)").out == "-e: sin errores.\n"


def test_the_language_comes_from_the_locale(tsc: Tsc, monkeypatch: pytest.MonkeyPatch) -> None:
    for name, value, word in (
        ("LC_ALL", "es_PE.UTF-8", "errores"),
        ("LC_ALL", "en_US.UTF-8", "mistakes"),
        ("LC_ALL", "C", "mistakes"),
    ):
        monkeypatch.setenv(name, value)
        assert word in tsc("check", "-e", "S = 5;F = 6").err


@pytest.mark.parametrize(("closed_text", "program", "code"), [
    ("2>&-", "LOOP(3);S;END_LOOP;X = 1", 0), ("2>&-", "F(1", 1), ("<&-", "S", 0), (">&-", "S", 0),
    (">/dev/full", "S", 2),
])  # fmt: skip
def test_closed_and_full_streams_are_handled(closed_text: str, program: str, code: int) -> None:
    """Without any output, there is still an exit code, and the trace is complete."""
    if "full" in closed_text and not Path("/dev/full").exists():
        pytest.skip("this system has no full device")
    command = f"{shlex.join(TSC)} run -e {shlex.quote(program)} {closed_text}"
    completed = subprocess.run(command, shell=True, capture_output=True, text=True)
    assert bool(completed.stderr) == (code == 2)
    assert (
        "Traceback" not in completed.stderr
        and "ran into something unexpected" not in completed.stderr
    )
    assert completed.returncode == code
    if closed_text == "2>&-":
        assert completed.stdout == ("0 MOTORS 0 0\n" * 3 + "0 DONE\n" if code == 0 else "")


def test_ctrl_c_is_reported() -> None:
    loop = "LOOP(FOREVER);SHOW(1);END_LOOP"
    command = Command("run", "-e", loop, "--max-steps", "1000000000")
    command.until("SHOW 1")
    command.signal(signal.SIGINT)
    result = command.wait_for_result()
    assert result.code == 2 and result.err.endswith("\nStopped.\n")


def in_encoding(name: str, data: bytes = b"") -> io.TextIOWrapper:
    return io.TextIOWrapper(io.BytesIO(data), encoding=name)


@pytest.mark.parametrize(("stream", "options"), [("stderr", []), ("stdout", ["--json"])])
def test_output_without_unicode_is_readable(
    monkeypatch: pytest.MonkeyPatch, stream: str, options: list[str]
) -> None:
    """JSON is JSON there, too."""
    text_file = in_encoding("ascii")
    monkeypatch.setattr(sys, stream, text_file)
    assert main(["check", "--lang", "es", "-e", "año = 5", *options]) == 1
    text_file.flush()
    output = text_file.buffer.getvalue()  # type: ignore[attr-defined]
    if options:
        assert json.loads(output)[0]["severity"] == "mistake"
    else:
        assert b"l\\xednea 1:" in output


def test_binary_input_is_refused(tsc: Tsc, monkeypatch: pytest.MonkeyPatch) -> None:
    for encoding in ("ascii", "utf-8", "cp1252"):
        monkeypatch.setattr(sys, "stdin", in_encoding(encoding, b"F(\xff\x81\n"))
        result = tsc("live", "--virtual")
        assert (result.code, "[TS" in result.err) == (1, True), encoding


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="Windows has no such files")
@pytest.mark.parametrize("kind", ["pipe", "folder", "device", "circle", "huge"])
def test_any_content_of_cache_files_is_handled(kind: str) -> None:
    """No command waits for them or reads them forever: they are ignored."""
    port = "socket://127.0.0.1:4000"
    robot = directory._folder() / "4000.json"
    paths = [known_ports._path(), robot, registry._path(port), source_map._path(5)]
    for path in paths:
        path.parent.mkdir(parents=True, exist_ok=True, mode=0o700)
        path.parent.chmod(0o700)
        if kind == "pipe":
            os.mkfifo(path)
        elif kind == "folder":
            path.mkdir()
        elif kind == "huge":
            with path.open("wb") as file:
                file.truncate(1 << 40)
        else:
            path.symlink_to("/dev/zero" if kind == "device" else path)
    assert known_ports.remembered_ports() == known_ports.KnownPorts(None, {})
    assert directory.running_robots() == []
    assert registry.find_registration(port) is None
    assert registry.find_all() == []
    assert source_map.recall(5) is None


@pytest.mark.parametrize("number", ["0000801234", "99999", "00000", "٣٣٣٣", "-1", "4" * 5000])
def test_a_number_that_no_port_has_is_not_a_robot(number: str) -> None:
    assert not directory._is_listening(f"socket://127.0.0.1:{number}")


def test_a_damaged_or_unwritable_cache_does_no_harm(
    tsc: Tsc, program: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    image = program.with_suffix(".bin")
    tsc("compile", program)
    path = source_map._path(unpack(image.read_bytes()).checksum)
    huge = '{"version": 1, "name": "", "lines": [], "places": [[1e400, 1, 1, 1, 9]]}'
    damaged_texts = ("", "{}", "[]", '{"version": 1, "places": 5}', "nonsense", '{"version": 9}')
    for text in ("[" * 200_000, huge, *damaged_texts):
        path.write_text(text)
        assert tsc("show", image).code == 0
    blocked_path = program.with_name("blocked")
    blocked_path.write_text("")
    monkeypatch.setenv("XDG_CACHE_HOME", str(blocked_path))
    assert tsc("compile", program).code == 0
    result = tsc("show", image).gives(0)
    assert "line" not in result.out
