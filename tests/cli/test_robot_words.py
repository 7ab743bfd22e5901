"""What a robot says reaches terminal, rows and JSON without signs that act there."""

from __future__ import annotations

import csv
import io
import json

import pytest

from tests.link.test_session import DESCRIPTION
from tiniscript.cli.robot.event_printer import EventPrinter
from tiniscript.cli.spreadsheet import no_formula
from tiniscript.link import known_ports, ports
from tiniscript.link.outcomes import TextEvent
from tiniscript.link.payloads import HelloReply
from tiniscript.link.requests import described
from tiniscript.link.sharing.protocol import filled

# the cursor, a title, a new line, a bell, the direction, nothing to see, half a character
ACTING = ("\x1b[2J", "\x9b2J", "\x1b]0;x\x07", "\r\n", "\b\b", "\u202e", "\u2066", "\u200b",
          "\ufeff", "\u2028", "\x85", "\x7f", "\udcff")  # fmt: skip
FORMULAS = ("=1+1", "+1", "-1+1", "@SUM(A1)", "a;=1+1", 'a;"=1+1"', "a,@x", "|=x", "\uff1d1+1")


def is_harmless(text: str) -> bool:
    return text.replace("\n", "").isprintable()


@pytest.mark.parametrize("sign", ACTING)
def test_a_name_has_no_signs_that_act(sign: str) -> None:
    name = f"AB{sign}C".encode("utf-8", "surrogateescape")[:16]
    values = filled(HelloReply, {**DESCRIPTION, "name": name})
    found = described(values).name
    assert is_harmless(found) and found.startswith("AB") and found.endswith("C")
    known_ports.remember("/dev/x", f"AB{sign}C".encode("utf-8", "replace").decode())
    assert is_harmless(known_ports.known().names["/dev/x"])


@pytest.mark.parametrize("sign", ACTING)
def test_a_device_describes_itself_without_them(sign: str, monkeypatch: pytest.MonkeyPatch) -> None:
    class Port:
        device, description = "/dev/x", f"Arduino{sign}Uno"

    monkeypatch.setattr("serial.tools.list_ports.comports", lambda: [Port()])
    [found] = ports.listed()
    assert is_harmless(found.description) and found.description.startswith("Arduino")


def told(text: str, is_json: bool) -> tuple[str, str]:
    """Return what is printed of a robot's text, and its row."""
    said: list[str] = []
    rows = io.StringIO()
    writer = csv.writer(rows, lineterminator="\n")
    add = lambda *cells: writer.writerow(cells)  # noqa: E731
    printer = EventPrinter("en", is_json, rows=add, out=said.append, err=said.append)
    printer.tell(5, TextEvent(text.encode("utf-8", "surrogateescape")))
    return "\n".join(said), rows.getvalue()


@pytest.mark.parametrize("sign", ACTING)
def test_a_text_is_printed_without_them(sign: str) -> None:
    for is_json in (False, True):
        said, row = told(f"AB{sign}C", is_json)
        assert is_harmless(said) and is_harmless(row)
        assert is_harmless(json.loads(said)["text"]) if is_json else "AB" in said


@pytest.mark.parametrize("text", FORMULAS)
@pytest.mark.parametrize("separator", [",", ";", "\t"])
def test_no_cell_of_a_row_is_a_formula(text: str, separator: str) -> None:
    _, row = told(text, is_json=False)
    [cells] = csv.reader([row.strip("\n")], delimiter=separator)
    quoted = [cell.strip(' "') for cell in cells]
    assert not [cell for cell in quoted[-1:] + quoted if cell[:1] in tuple("=+-@\uff1d")]


def test_numbers_and_words_stay() -> None:
    for text in ("F(1, -2) = 3", "F(2, -X)", "M(-X, +Y)", "a-b", "1 + 1", "x@y", "hello"):
        assert no_formula(text) == text
