"""Diagnostics become words: in the reader's language, for people and for editors.

Knows how the texts of the catalogue are filled, and how a line of a program is shown with the place
marked under it. Knows no single diagnostic. It prints nothing.

For each code, the catalogue has a title, which describes the diagnostic in general; a message,
which names one cause; one thing to try; and the text of `tsc check --explain`: more details, a
program for which this is the first diagnostic, and the mended program, if they are short. Messages
and things to try have gaps: `{found}` is a value itself, `{@unit}` one in the reader's language.
Terms in it are translated, the rest stays as it is: `F(time, power)` is `F(tiempo, potencia)`. A
value that begins with @ is a term, anywhere. Of several texts, `/message`, `/message/2`, the first
one whose gaps all have a value is used, otherwise the last one. No full stop comes right after a
gap or a piece of program: it would look like a part of it.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from itertools import count
from typing import Literal, NamedTuple

from tiniscript.base import languages
from tiniscript.base.source import Source, Span
from tiniscript.diagnostics.codes import CODES, Diagnostic

CATALOGUE = "messages"
LINE_COLUMNS = 100  # columns of a program's line; a longer one is cut to a window
MAX_COLUMNS_ON_LEFT = 40  # columns of that window before the place
ROW_CHARACTERS = 110  # a longer message has its suggestion in a row of its own
VALUE_CHARACTERS = 60  # characters of the program's text within a message
FIX_CHARACTERS = 200  # characters of a fix, which is cut only if a reader would not copy it
TAB = "    "

_LINE_GAPS = frozenset(("line", "row", "here", "first", "last", "out", "rest"))
_END_WORD = re.compile(r"\bEND(?:_|IF\b)")
_GAP = re.compile(r"\{(@?)(\w+)\}")
_TERM_WORD = re.compile(r"[A-Za-z_]+")
_RED, _YELLOW, _DIM, _PLAIN = "\033[1;31m", "\033[1;33m", "\033[2m", "\033[0m"


class Message(NamedTuple):
    """A diagnostic in words. Lines and columns count from 1, columns in characters.

    The end is exclusive. The range is never empty, except in a text that is.
    """

    code: str
    severity: Literal["mistake", "warning"]
    line: int
    column: int
    end_line: int
    end_column: int
    message: str
    fix: str


# Additions to the thing to try, which is copied as it is: what is then written where it is used,
# other possible meanings, and that it may be a note. The message describes its limits: what it
# leaves out, and which parts nobody wrote.
_SECONDARY_GAPS = ("carried", "rival", "note", "last_note")
_COPIED_GAPS = frozenset(("fix", "right", "whole", "made", "note", "after", "begun"))
_SUPPLEMENT_GAPS = ("lost", "sample", "samples")


def message(
    diagnostic: Diagnostic, source: Source, language: str, *, is_on_blocks: bool = False
) -> Message:
    """Return the message of a diagnostic and its place; users of blocks get a version for blocks,
    if there is one.
    """
    number = diagnostic.code.number
    start, end = _shown_range(source.text, diagnostic.span)
    line, column = source.position(start)
    end_line, end_column = line, column
    if end > start:
        end_line, last_column = source.position(end - 1)
        end_column = last_column + 1
    fix = _format_text(f"{number}/try", diagnostic.values, language, is_on_blocks)
    for gap in _SECONDARY_GAPS:
        if diagnostic.values.get(gap):
            values = {**diagnostic.values, "made": diagnostic.values.get("fix", ""), "fix": fix}
            fix = _format_text(f"label/{gap}", values, language)
    message_text = _format_text(f"{number}/message", diagnostic.values, language, is_on_blocks)
    for gap in _SUPPLEMENT_GAPS:
        if diagnostic.values.get(gap):
            sentence = message_text if message_text[-1:] in (".", "?", "!") else message_text + "."
            values = {**diagnostic.values, "said": sentence}
            message_text = _format_text(f"label/{gap}", values, language)
    return Message(
        number,
        "mistake" if diagnostic.is_mistake else "warning",
        line,
        column,
        end_line,
        end_column,
        message_text,
        fix,
    )


def as_json(messages: Iterable[Message]) -> list[dict[str, object]]:
    """Return messages as the data that `--json` prints."""
    return [message._asdict() for message in messages]


def as_text(message: Message, source: Source, language: str, color: bool = False) -> str:
    """Return a message with its line of the program above, as a terminal shows it."""
    is_warning = message.severity == "warning"
    mark, dim_code, plain_code = (
        (_YELLOW if is_warning else _RED, _DIM, _PLAIN) if color else ("", "", "")
    )
    rows = []
    if source.text:
        label = f"{_label('line', language)} {message.line}:  "
        line = source.line_text(message.line)
        end = message.end_column - 1 if message.end_line == message.line else len(line)
        line_shown, blank_count, caret_count = _line_window(line, message.column - 1, end)
        rows.append((label + line_shown).rstrip())
        rows.append(" " * (len(label) + blank_count) + mark + "^" * caret_count + plain_code)
    text = f"{_label('warns', language)} {message.message}" if is_warning else message.message
    code = f"   {dim_code}[{message.code}]{plain_code}"
    if not message.fix:
        return "\n".join((*rows, text + code))
    fix = f"{_label('try', language)}  {message.fix}"
    fits_in_row = len(text) + len(fix) + len(message.code) <= ROW_CHARACTERS
    rows += [f"{text}   {fix}{code}"] if fits_in_row else [text, fix + code]
    return "\n".join(rows)


def explain(code: str, language: str) -> str | None:
    """Return the longer explanation of a code (`TS017`, `ts017` or `017`), None for no code."""
    from textwrap import indent

    number = code.strip().upper()
    number = number if number.startswith("TS") else "TS" + number
    if number not in CODES:
        return None
    severity = _label("mistake" if CODES[number].is_mistake else "warning", language)
    parts = [
        f"{number} ({severity}): {_text(f'{number}/title', language)}",
        _text(f"{number}/more", language),
    ]
    for part in ("wrong", "right"):
        if program := languages.find_text(CATALOGUE, f"{number}/{part}", language):
            parts.append(_label(part, language) + "\n\n" + indent(program, "    "))
    return "\n\n".join(parts)


def titles(language: str) -> list[tuple[str, str]]:
    """Return every code with its diagnostic in general words."""
    return [(number, _text(f"{number}/title", language)) for number in sorted(CODES)]


# -- words --------------------------------------------------------------------------------------


def _text(key: str, language: str) -> str:
    return languages.text(CATALOGUE, key, language)


def _label(name: str, language: str) -> str:
    return _text(f"label/{name}", language)


def _term(word: str, language: str) -> str | None:
    return languages.find_text(CATALOGUE, f"term/{word}", language)


def _templates(key: str, language: str) -> Iterator[str]:
    """Yield the alternative texts."""
    yield _text(key, language)
    for number in count(2):
        text = languages.find_text(CATALOGUE, f"{key}/{number}", language)
        if text is None:
            return
        yield text


def found_names(diagnostic: Diagnostic) -> bool:
    """Return whether a message quotes the text that it is about."""
    key = f"{diagnostic.code.number}/message"
    template = _first_usable_template(key, diagnostic.values, languages.SOURCE_LANGUAGE)
    return ("", "found") in _GAP.findall(template)


def _first_usable_template(
    key: str, values: Mapping[str, str], language: str, is_on_blocks: bool = False
) -> str:
    """Return the first text whose gaps all have a value, else the last one."""
    templates = [*_templates(key, language)]
    usable = [
        template
        for template in templates
        if all(values.get(name) for _, name in _GAP.findall(template))
    ]
    if is_on_blocks:
        usable = [each for each in usable if not _needs_text(each, values)] or usable
    return usable[0] if usable else templates[-1] if templates else ""


def _needs_text(template: str, values: Mapping[str, str]) -> bool:
    """Return whether a text names a line, or the end of a block: blocks have none of them."""
    names = [name for _, name in _GAP.findall(template)]
    has_line = any(name in _LINE_GAPS and values[name].isdigit() for name in names)
    return has_line or any(
        _END_WORD.search(part) for part in (template, *(values[name] for name in names))
    )


def _format_text(
    key: str, values: Mapping[str, str], language: str, is_on_blocks: bool = False
) -> str:
    template = _first_usable_template(key, values, language, is_on_blocks)

    def fill_gap(match: re.Match[str]) -> str:
        most_characters = FIX_CHARACTERS if match[2] in _COPIED_GAPS else VALUE_CHARACTERS
        if match[2] == "said":
            return values["said"]  # a message, which is short as it is
        return _value_text(values.get(match[2], ""), match[1] == "@", language, most_characters)

    return _GAP.sub(fill_gap, template)


def _value_text(value: str, should_translate: bool, language: str, most_characters: int) -> str:
    """Return a value as a message can hold it: translated, short, in one row, printable."""
    term = (
        _term(value.removeprefix("@"), language) if should_translate or value[:1] == "@" else None
    )
    if term is not None:
        return term
    if should_translate:
        value = _TERM_WORD.sub(lambda match: _term(match[0], language) or match[0], value)
    value = " ".join(value[: most_characters * 4].split())
    if len(value) > most_characters:
        value = value[:most_characters] + "…"
    return "".join(_cell(character)[0] for character in value)


# -- places -------------------------------------------------------------------------------------


def _shown_range(text: str, span: Span) -> tuple[int, int]:
    """Return the start and the end of the text to point at, which is never empty if there is any
    text.

    Line ends at the end are left out; an empty place becomes the character there or, at the end
    of a line, the last one before that can be seen.
    """
    start = min(max(span.start, 0), len(text))
    end = min(max(span.end, start), len(text))
    if start < end:
        return start, start + max(1, len(text[start:end].rstrip("\r\n")))
    if start < len(text) and text[start] not in "\r\n":
        return start, start + 1
    end = len(text[:start].rstrip())
    return (end - 1, end) if end else (0, min(1, len(text)))


def _line_window(line: str, start: int, end: int) -> tuple[str, int, int]:
    """Return the visible part of a line, the columns before the carets, and their number.

    `start` and `end` count characters of the line from 0.
    """
    offset = max(0, start - LINE_COLUMNS)
    cells = [_cell(character) for character in line[offset : start + LINE_COLUMNS]]
    start_cell = start - offset
    left, right = 0, len(cells)
    if len(cells) < len(line) or sum(width for _, width in cells) > LINE_COLUMNS:
        left, used_columns = start_cell, 0
        while left and used_columns + cells[left - 1][1] <= MAX_COLUMNS_ON_LEFT:
            left -= 1
            used_columns += cells[left][1]
        right = start_cell
        while right < len(cells) and used_columns + cells[right][1] <= LINE_COLUMNS:
            used_columns += cells[right][1]
            right += 1
    ellipsis_before = "…" if offset + left > 0 else ""
    ellipsis_after = "…" if offset + right < len(line) else ""
    line_shown = ellipsis_before + "".join(text for text, _ in cells[left:right]) + ellipsis_after
    blank_count = len(ellipsis_before) + sum(width for _, width in cells[left:start_cell])
    caret_count = sum(
        width for _, width in cells[start_cell : min(max(end - offset, start_cell), right)]
    )
    return line_shown, blank_count, max(1, caret_count)


def _cell(character: str) -> tuple[str, int]:
    """Return the visible form of a character, and its columns on a terminal."""
    if " " <= character <= "~":
        return character, 1
    if character == "\t":
        return TAB, len(TAB)
    from unicodedata import category, east_asian_width

    kind = category(character)
    width = 2 if east_asian_width(character) in "WF" else 1
    if kind == "Zs":
        return " " * width, width
    if not character.isprintable():
        code = ord(character)
        return chr(0x2400 + code) if code < 32 else "␡" if code == 127 else "\ufffd", 1
    return character, 0 if kind in ("Mn", "Me") else width
