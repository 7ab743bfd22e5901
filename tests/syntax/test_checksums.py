"""The checksums of lines: the bytes they cover, their place, and their messages."""

from __future__ import annotations

from zlib import crc32

import pytest

from tiniscript import Compilation, compile_text, robots
from tiniscript.base.source import Source
from tiniscript.library.compiling import compile_source
from tiniscript.syntax.checksums import checksum_of, with_checksum
from tiniscript.syntax.formatter import format_source

TINIBOT = robots.load("tinibot")
LINE = "SI|F(2, 80)"
LINE_WITH_CHECKSUM = f"{LINE}~B77E7BD9"


def compile_program(text: str) -> Compilation:
    return compile_text(text, TINIBOT.kit)


def messages(text: str) -> list[tuple[str, str]]:
    """Return the code of each diagnostic, and the text that it points at."""
    return [
        (diagnostic.code.number, text[slice(*diagnostic.span)])
        for diagnostic in compile_program(text).diagnostics
    ]


def test_the_checksum_is_the_crc_32_of_the_line() -> None:
    assert with_checksum(LINE) == LINE_WITH_CHECKSUM
    assert checksum_of("// ñ") == crc32("// ñ".encode())


@pytest.mark.parametrize(
    "text",
    [
        LINE_WITH_CHECKSUM,
        LINE_WITH_CHECKSUM.lower().replace("si|f", "SI|F"),  # digits in any case
        LINE_WITH_CHECKSUM + "\n",
        LINE_WITH_CHECKSUM + "\r\n",
        LINE_WITH_CHECKSUM + "\r",
        LINE_WITH_CHECKSUM + " \t\u00a0\ufeff\n",
        "\ufeff" + LINE_WITH_CHECKSUM,
        "\n" + LINE_WITH_CHECKSUM,
    ],
)
def test_a_line_with_its_checksum_means_the_same(text: str) -> None:
    assert messages(text) == []
    assert compile_program(text).image == compile_program(LINE).image


def test_a_byte_order_mark_of_a_file_does_not_count() -> None:
    assert compile_source(b"\xef\xbb\xbf" + LINE_WITH_CHECKSUM.encode(), TINIBOT, "", True).is_right


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_any_subset_of_lines_may_have_checksums(end: str) -> None:
    lines = ["LOOP(2)", "  F(1, 50)  ", "END_LOOP // twice", "", "S"]
    expected = compile_program("\n".join(lines)).image
    for line_mask in range(2 ** len(lines)):
        rows = [with_checksum(row) if line_mask >> k & 1 else row for k, row in enumerate(lines)]
        assert compile_program(end.join(rows)).image == expected, rows
        assert messages(end.join([*rows[:-1], "R~00000000"])) != []


@pytest.mark.parametrize("index", range(len(LINE)))
def test_a_changed_line_is_a_mistake(index: int) -> None:
    changed_text = LINE[:index] + chr(ord(LINE[index]) ^ 1) + LINE[index + 1 :]
    assert ("TS058", "~B77E7BD9") in messages(f"{changed_text}~B77E7BD9")
    assert not compile_program(f"{changed_text}~B77E7BD9").image


def test_spaces_before_the_checksum_sign_count() -> None:
    assert messages(f"{LINE} ~B77E7BD9") == [("TS058", "~B77E7BD9")]
    assert messages(with_checksum(f"{LINE} ")) == []


def test_a_comment_line_may_have_a_checksum() -> None:
    """Therefore a line in which two signs became `//` does not pass for a comment."""
    assert messages(with_checksum("// a square")) == []
    assert messages("// a square~00000000") == [("TS058", "~00000000")]
    assert messages(with_checksum("S // stop")) == []


@pytest.mark.parametrize(
    ("text", "place"),
    [
        ("S~", "~"),
        ("S~1234567", "~1234567"),
        ("S~123456789", "~123456789"),
        ("S~12345678 // stop", "~12345678"),
        ("S~12345678;S", "~12345678"),
        ("~S", "~"),
        ("S;~00000000~00000000x", "~00000000"),
    ],
)
def test_a_sign_that_is_not_a_checksum_is_a_mistake(text: str, place: str) -> None:
    assert ("TS059", place) in messages(text)


def test_a_checksum_sign_inside_a_comment_is_ordinary() -> None:
    assert messages("S // ~5 cm, ~12345678 or so") == []
    assert messages("S // ~5 cm ~12345678") == []  # the first one counts


def test_formatting_removes_checksums() -> None:
    rows = [with_checksum("s // stop"), "// ~5", with_checksum("f(1,50)")]
    text = format_source(Source("\n".join(rows)))
    assert text == "S;  // stop\n// ~5\nF(1, 50);\n"
