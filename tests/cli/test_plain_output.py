"""Foreign text never moves the cursor of a terminal, hides text or begins a line."""

from __future__ import annotations

import csv
import io
import json
import re
from itertools import product
from pathlib import Path

import pytest

from tests.support.command import PROGRAM, Tsc
from tests.support.edited_robots import TEXTS
from tests.support.rows import each_row
from tests.support.sampling import sample_of
from tests.support.session_frames import DESCRIPTION
from tests.support.verbs import parsers, values_of, words_of
from tiniscript.base.source import printable
from tiniscript.cli.errors import CommandError
from tiniscript.cli.robot.event_printer import EventPrinter
from tiniscript.cli.spreadsheet import escape_formula
from tiniscript.cli.texts import MAX_VALUE_CHARACTERS, Sentence, text
from tiniscript.cli.texts.verbs import command_words
from tiniscript.link import known_ports, ports
from tiniscript.link.outcomes import TextEvent
from tiniscript.link.payloads import HelloReply
from tiniscript.link.requests import device_info_of
from tiniscript.link.sharing.protocol import make_payload
from tiniscript.robots import DEFAULT
from tiniscript.virtual import worlds

# ESC and a colour, a C1 control, a line of its own, backspaces, and marks that turn the direction
HOSTILE_TEXT = "\x1b[31mx\x9b2J\r\ntsc: done\x08\x7f\u202e\u2066\u200f\u2028"
UNSAFE_CHARACTER = re.compile(
    r"[\x00-\x09\x0b-\x1f\x7f-\x9f\u200e\u200f\u202a-\u202e\u2028\u2029\u2066-\u2069]"
)
PARSERS = parsers()
END_ARGUMENTS = {  # values that keep a verb from waiting
    "robot": ["--for", "0.1", "--hurry", "max"],
    "monitor_hold": ["--port", "/none"], "start": ["--port", "/none"],
    "set_trim": ["--port", "/none"],
    "monitor": ["--port", "/none"], "show_port": ["--port", "/none"],
    "set_name": ["X", "--port", "/none"],
    "doctor": ["--port", "/none"], "stop": ["--port", "/none"],
    "upload": ["-e", PROGRAM, "--port", "/none"], "live": ["F(1, 80)", "--port", "/none"],
    "firmware": ["--port", "/none"], "studio": ["--listen", "none"],
    "set_wifi": ["--port", "/none"], "class": ["--broker", "127.0.0.1:1"],
    "check_explain": ["--explain", "TS012"], "firmware_board": ["--board", "tinibot"],
    "help_completion": ["--completion", "bash"],
}  # fmt: skip
LANGUAGES = ("en", "es")  # a commit draws one for each row
CASES = [(verb, dest) for verb, parser in PARSERS.items() for dest in values_of(parser)]


def assert_plain(*texts: str) -> None:
    for printed_text in texts:
        match = UNSAFE_CHARACTER.search(printed_text)
        assert match is None, f"{match[0]!r} in {printed_text!r}"
        assert "tsc: done" not in printed_text.splitlines(), "a line that tsc has not said"


@pytest.fixture(autouse=True)
def in_own_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "here").mkdir()
    monkeypatch.chdir(tmp_path / "here")


@each_row("verb, dest", CASES)
def test_no_argument_of_any_verb_reaches_the_terminal_raw(
    tsc: Tsc, verb: str, dest: str, pytestconfig: pytest.Config
) -> None:
    option = values_of(PARSERS[verb])[dest]
    end_arguments = END_ARGUMENTS.get(verb, [])
    if dest in ("port", "ports", "listen") and end_arguments:
        end_arguments = end_arguments[:-2]
    if dest in ("name", "line", "texts", "program", "text"):
        end_arguments = [
            ending for ending in end_arguments if ending not in ("X", "-e", PROGRAM, "F(1, 80)")
        ]
    for language in sample_of(pytestconfig, f"{verb} {dest}", LANGUAGES):
        for unsafe_text in (
            HOSTILE_TEXT,
            f"DISTANCE={HOSTILE_TEXT}",
            f"{HOSTILE_TEXT}.toml",
            f"/{HOSTILE_TEXT}/x",
        ):
            words = [option, unsafe_text] if option else [unsafe_text]
            result = tsc(*words_of(verb), *words, *end_arguments, "--lang", language)
            assert_plain(result.out, result.err)


@pytest.mark.parametrize("words", [
    [HOSTILE_TEXT], [HOSTILE_TEXT, "x"], ["--lang", HOSTILE_TEXT],
    [f"--lang={HOSTILE_TEXT}", "check"], ["check", f"--{HOSTILE_TEXT}"],
    ["check", "-e", "W(1)", HOSTILE_TEXT], ["run", "-e", "W(1)", f"--show={HOSTILE_TEXT}"],
    ["help", HOSTILE_TEXT],
    ["run", "-e", "W(1)", "--sensor", "DISTANCE=1", "--sensor", f"DISTANCE={HOSTILE_TEXT}"],
])  # fmt: skip
def test_unknown_verbs_and_options_are_reported_in_plain_text(tsc: Tsc, words: list[str]) -> None:
    for language in ("en", "es"):
        result = tsc(*words, *([] if "--lang" in words[0] else ["--lang", language]))
        assert_plain(result.out, result.err)
        assert result.code == 2 or words[0] == "help"


def in_toml(text: str) -> str:
    return '"' + "".join(f"\\U{ord(letter):08x}" for letter in text) + '"'


def spoil_each(toml: str) -> list[str]:
    """Return a text for each of its strings, and for each of its keys, with that one spoiled."""
    values = [match.span() for match in re.finditer(r'"[^"\n]*"', toml)]
    keys = [match.span(1) for match in re.finditer(r"^([a-z_A-Z]+) *=", toml, re.MULTILINE)]
    return [toml[:a] + in_toml(HOSTILE_TEXT) + toml[b:] for a, b in values + keys]


@pytest.mark.parametrize("verb", ["check", "run", "firmware_wiring", "firmware_board", "robot"])
def test_no_string_of_a_profile_reaches_the_terminal_raw(
    tsc: Tsc, verb: str, pytestconfig: pytest.Config
) -> None:
    texts = spoil_each(TEXTS[DEFAULT])
    assert len(texts) > 30
    for number, toml in enumerate(texts):
        if verb in ("run", "robot") and number % 7:
            continue  # these verbs read the file like the others
        Path("evil.toml").write_text(toml, encoding="utf-8")
        words = [*command_words(verb).split(), *([] if verb == "firmware_board" else ["--robot"])]
        words.append("evil.toml")
        words += ["-e", "X = DISTANCE"] if verb in ("check", "run") else []
        for language in sample_of(pytestconfig, f"{verb} {number}", LANGUAGES):
            end_arguments = END_ARGUMENTS["robot"] if verb == "robot" else []
            result = tsc(*words, *end_arguments, "--lang", language)
            assert result.code != 2 or "evil.toml" in result.err
            assert_plain(result.out, result.err)


def test_no_string_of_a_world_reaches_the_terminal_raw(tsc: Tsc) -> None:
    texts = spoil_each((worlds.FOLDER / "obstacles.toml").read_text(encoding="utf-8"))
    assert len(texts) > 3
    for toml in texts:
        Path("evil.toml").write_text(toml, encoding="utf-8")
        for language in ("en", "es"):
            result = tsc(
                "robot", "--world", "evil.toml", *END_ARGUMENTS["robot"], "--lang", language
            )
            assert_plain(result.out, result.err)


def test_the_faulting_line_is_shown_in_plain_text(tsc: Tsc, tmp_path: Path) -> None:
    """The text of a program is data; a fault and a disassembly quote it."""
    program = tmp_path / "a.ts"
    program.write_text("X = 1/(TIME - TIME)  // \x1b[31m\u202e\x9b\tred", encoding="utf-8")
    assert tsc("compile", program).code == 0
    image = program.with_suffix(".bin")
    for verb, file in (("run", program), ("run", image), ("show", image), ("check", program)):
        result = tsc(verb, file)
        assert_plain(result.out, result.err)
        assert verb == "check" or "TIME" in result.out + result.err


def test_a_bug_is_reported_in_plain_text(tsc: Tsc, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:  # fmt: skip # noqa: E501
    from tiniscript.cli import main

    def raise_hostile_error(arguments: list[str], language: str) -> int:
        raise RuntimeError(f"the moon {HOSTILE_TEXT}")

    monkeypatch.setattr("tiniscript.cli.commands.check.run", raise_hostile_error)
    assert main(["check"]) == 2
    output = capsys.readouterr().err
    assert "RuntimeError: the moon" in output and "Traceback" not in output
    assert_plain(output)


def test_a_sentence_leaves_the_lines_of_other_sentences() -> None:
    sentence = Sentence("{a}|{b}").format(a="x\ny", b=Sentence("x\ny"))
    assert sentence == "x?y|x\ny"
    assert Sentence("{a}").format(a="x" * 10_000) == "x" * MAX_VALUE_CHARACTERS + "…"
    assert Sentence("{a:>3}").format(a=1) == "  1"
    assert isinstance(text("no_verb", "en"), Sentence)
    assert (
        CommandError(2, "no_verb", found=HOSTILE_TEXT, near=HOSTILE_TEXT)
        .sentence("es")
        .isprintable()
    )


def test_printable_characters_are_kept() -> None:
    for printable_text in ("", "Tini", "año ñandú", "机器人", "🤖", "a b", "-e 'SI|F(2, 80)'"):
        assert printable(printable_text) == printable_text
    assert printable("abc", 2) == "ab…"
    assert printable("a\x1b[31m") == "a?[31m"


def test_a_single_byte_takes_the_singular() -> None:
    for language, expected in (("en", "1 byte of code"), ("es", "1 byte de código")):
        values = {"checksum": "0", "name": " (1 bytes.ts)", "saved": "x"}
        one_byte_text = text("info_program", language).format(code=1, **values)
        assert expected in one_byte_text and "(1 bytes.ts)" in one_byte_text
        assert expected not in text("info_program", language).format(code=11, **values)


# -- a robot's messages ---------------------------------------------------------------------------

# the cursor, a title, a new line, a bell, the direction, nothing to see, half a character
CONTROL_SIGNS = ("\x1b[2J", "\x9b2J", "\x1b]0;x\x07", "\r\n", "\b\b", "\u202e", "\u2066", "\u200b",
                 "\ufeff", "\u2028", "\x85", "\x7f", "\udcff")  # fmt: skip
FORMULAS = ("=1+1", "+1", "-1+1", "@SUM(A1)", "a;=1+1", 'a;"=1+1"', "a,@x", "|=x", "\uff1d1+1")


def is_harmless(text: str) -> bool:
    return text.replace("\n", "").isprintable()


@each_row("sign", CONTROL_SIGNS)
def test_a_name_has_no_control_characters(sign: str) -> None:
    name = f"AB{sign}C".encode("utf-8", "surrogateescape")[:16]
    values = make_payload(HelloReply, {**DESCRIPTION, "name": name})
    shown_name = device_info_of(values).name
    assert is_harmless(shown_name) and shown_name.startswith("AB") and shown_name.endswith("C")
    known_ports.remember("/dev/x", f"AB{sign}C".encode("utf-8", "replace").decode())
    assert is_harmless(known_ports.remembered_ports().name_by_port["/dev/x"])


@each_row("sign", CONTROL_SIGNS)
def test_a_device_description_has_no_control_characters(
    sign: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    class Port:
        device, description = "/dev/x", f"Arduino{sign}Uno"

    monkeypatch.setattr("serial.tools.list_ports.comports", lambda: [Port()])
    [port] = ports.list_ports()
    assert is_harmless(port.description) and port.description.startswith("Arduino")


@each_row(
    "device, description, expected",
    [
        ("/dev/ttyS0", "n/a", "built into this computer"),
        ("/dev/ttyAMA10", "n/a", "built into this computer"),
        ("/dev/ttyS0", "PCI card", "PCI card"),
        ("/dev/ttyUSB0", "n/a", ""),
        ("/dev/ttySAC0", "n/a", ""),
    ],
)
def test_a_port_without_a_robot_is_described(
    device: str, description: str, expected: str, tsc: Tsc, monkeypatch: pytest.MonkeyPatch
) -> None:
    class Port:
        pass

    Port.device, Port.description = device, description  # type: ignore[attr-defined]
    monkeypatch.setattr("serial.tools.list_ports.comports", lambda: [Port()])
    (row,) = [line for line in tsc("doctor", "--ports").out.splitlines() if device in line]
    assert (expected in row) if expected else row == device
    (listed_port,) = json.loads(tsc("doctor", "--ports", "--json").out)
    assert listed_port["description"].startswith(expected)


def print_name(text: str, is_json: bool) -> tuple[str, str]:
    """Return the printed form of a robot's text, and its row."""
    lines: list[str] = []
    rows = io.StringIO()
    writer = csv.writer(rows, lineterminator="\n")
    add = lambda *cells: writer.writerow(cells)  # noqa: E731
    printer = EventPrinter(
        "en", is_json, add_row=add, print_line=lines.append, print_error=lines.append
    )
    printer.print_event(5, TextEvent(text.encode("utf-8", "surrogateescape")))
    return "\n".join(lines), rows.getvalue()


@each_row("sign", CONTROL_SIGNS)
def test_a_text_is_printed_without_control_characters(sign: str) -> None:
    for is_json in (False, True):
        output, row = print_name(f"AB{sign}C", is_json)
        assert is_harmless(output) and is_harmless(row)
        assert is_harmless(json.loads(output)["text"]) if is_json else "AB" in output


@each_row("separator, text", product((",", ";", "\t"), FORMULAS))
def test_no_cell_of_a_row_is_a_formula(text: str, separator: str) -> None:
    _, row = print_name(text, is_json=False)
    [cells] = csv.reader([row.strip("\n")], delimiter=separator)
    quoted_texts = [cell.strip(' "') for cell in cells]
    assert not [
        cell for cell in quoted_texts[-1:] + quoted_texts if cell[:1] in tuple("=+-@\uff1d")
    ]


def test_numbers_and_words_are_kept() -> None:
    for plain_text in ("F(1, -2) = 3", "F(2, -X)", "M(-X, +Y)", "a-b", "1 + 1", "x@y", "hello"):
        assert escape_formula(plain_text) == plain_text
