"""Reads texts in TOML: the English ones, `en/*.toml`, from which all languages are translated, and
those of a language, `es/*.toml`, which has the same keys.

A row is a text by its key. A list has several texts with one key, of which a message uses the first
one whose gaps all have values; `one`, `few`, `many`, `other` and so on are the forms of a text with
a plural. In English, `same` marks a program, which is the same in every language. A text under
several keys is translated once, at the first of them; `own` marks one that means something else
there. In these files, the name of a table is the note that translators read beside each of its
texts, unless the key begins with it; rows above all tables need no note. A mistake in a row costs
that row alone.
"""

from __future__ import annotations

import re
import sys
from dataclasses import dataclass, field
from hashlib import sha256
from pathlib import Path
from string import Formatter
from typing import Any

# The names of plural categories in Unicode's CLDR.
PLURALS = ("zero", "one", "two", "few", "many", "other")
UNKNOWN_HASH, HASH_DIGITS = "-", 8  # instead of a hash; of one
_GAP = re.compile(r"\{@?\w+\}")
_ROW_START = re.compile(r"""\s*("(?:[^"\\]|\\.)*"|'[^']*'|[\w-]+)\s*(\.\s*[\w-]+\s*)*=""")
_TABLE_HEADER = re.compile(r"\s*\[.*\]\s*(#.*)?")
_QUOTES = re.compile(r'"""|\'\'\'')
_TOML_PLACE = re.compile(r" \(at (line \d+, column \d+|end of document)\)$")

Forms = dict[str, str]  # plural forms of a text, by name; one without plurals has one, under ""
Problem = tuple[int, str]  # a line of a file, and a sentence


@dataclass
class Entry:
    """An English text, and its translation into a language.

    `translation` has its forms, or is empty, and `seen_hash` is the hash of the text that it
    translates, or UNKNOWN. A stale translation is of an earlier English text. `notes` are for
    translators. `is_same`: it needs no translator, because it is the same in every language, or
    because the key `same_text_key` has the same words.
    """

    key: str
    english: str
    plural: str = ""
    translation: Forms = field(default_factory=dict)
    seen_hash: str = ""
    notes: list[str] = field(default_factory=list)
    is_same: bool = False
    same_text_key: str = ""
    line: int = 0

    @property
    def identity(self) -> tuple[str, str]:
        return self.key, self.english

    @property
    def hash(self) -> str:
        """Return the hash that represents the English text in a `seen` file."""
        return sha256("\0".join(self.forms.values()).encode()).hexdigest()[:HASH_DIGITS]

    @property
    def is_stale(self) -> bool:
        return self.seen_hash not in ("", UNKNOWN_HASH, self.hash)

    @property
    def is_translated(self) -> bool:
        return bool(self.translation) and not self.is_stale

    @property
    def forms(self) -> Forms:
        return {"one": self.english, "other": self.plural} if self.plural else {"": self.english}


@dataclass
class Catalogue:
    """The texts of a file by key and English text, and its problems."""

    entries: dict[tuple[str, str], Entry] = field(default_factory=dict)
    problems: list[Problem] = field(default_factory=list)

    def groups(self) -> dict[str, list[Entry]]:
        """Return the texts of each key, in their order."""
        groups: dict[str, list[Entry]] = {}
        for entry in self.entries.values():
            groups.setdefault(entry.key, []).append(entry)
        return groups


@dataclass
class Row:
    """A key of a file with its value, which is None if it cannot be read.

    `text_above` are the rows of notes and tables before it.
    """

    key: str
    value: Any
    line: int
    text: str
    text_above: str = ""
    table: str = ""

    def merge_forms(self, other: Row) -> bool:
        """Take other forms of the same text from another row, `KEY.one` and `KEY.other`."""
        own_forms, other_forms = self.value, other.value
        if (
            not isinstance(own_forms, dict)
            or not isinstance(other_forms, dict)
            or own_forms.keys() & other_forms.keys()
        ):
            return False
        self.value = {**own_forms, **other_forms}
        self.text += other.text_above + other.text
        return True


def decode_file(path: Path) -> tuple[str, list[Problem]]:
    """Return the text of a file, and its problems if it cannot be read or is not UTF-8."""
    try:
        data = path.read_bytes()
    except OSError as error:
        return "", [(1, f"this cannot be read: {error.strerror or error}")]
    if b"\0" in data:
        return "", [(1, "this is no UTF-8 text: save the file as UTF-8")]
    text = data.decode("utf-8-sig", errors="replace").replace("\r\n", "\n")
    try:
        data.decode("utf-8")
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        return text, [(line, "this is no UTF-8: save the file as UTF-8")]
    return text, []


def parse_rows(text: str) -> tuple[list[Row], str, list[Problem]]:
    """Return the rows of a TOML file, the text below them, and its TOML errors."""
    row_by_key: dict[str, Row] = {}
    repeated_rows: list[Row] = []  # a key that is there twice
    problems: list[Problem] = []
    text_above, table = "", ""
    lines = re.findall(r".*\n|.+", text)
    start = 0
    while start < len(lines):
        is_row = _ROW_START.match(lines[start]) is not None
        end = _row_end(lines, start) if is_row else start + 1
        value, parse_error = _parse_block(block := "".join(lines[start:end]))
        # The next row begins at the next line that looks like one, even if a value is open.
        if parse_error:
            problems.append((start + 1, f"this is no TOML: {parse_error[1]}"))
            end = next(
                (k for k in range(start + 1, len(lines)) if _is_row_start(lines[k])), len(lines)
            )
            value, block = (
                {_row_key(lines[start]): None} if is_row else {},
                "".join(lines[start:end]),
            )
        if is_row:
            row = Row(*next(iter(value.items())), start + 1, block, text_above, table)
            if (
                earlier_row := row_by_key.setdefault(row.key, row)
            ) is not row and not earlier_row.merge_forms(row):
                repeated_rows.append(row)
            text_above = ""
        else:
            text_above += block
            table = next(iter(value), table)
        start = end
    if not problems and not repeated_rows:
        problems = [(line, f"this is no TOML: {reason}") for line, reason in _toml_problems(text)]
    return (
        sorted([*row_by_key.values(), *repeated_rows], key=lambda row: row.line),
        text_above,
        problems,
    )


def _is_row_start(line: str) -> bool:
    """Return whether a row or a table begins with this line."""
    return _ROW_START.match(line) is not None or _TABLE_HEADER.fullmatch(line.rstrip()) is not None


def _row_end(lines: list[str], start: int) -> int:
    """Return the end of a row, which may be a text or a list of several lines."""
    quotes = ""
    if not _parse_block(lines[start])[1]:
        return start + 1
    for k in range(start, len(lines)):
        if (
            k > start
            and not quotes
            and (_is_row_start(lines[k]) or lines[k].strip()[:1] in ("", "#"))
        ):
            if _is_row_start(lines[k]) or not _parse_block("".join(lines[start:k]))[1]:
                return k
        for delimiter in _QUOTES.findall(lines[k]):
            quotes = "" if quotes == delimiter else quotes or delimiter
    return len(lines)


def _parse_block(block: str) -> tuple[dict[str, Any], tuple[int, str] | None]:
    """Parse a block of TOML; on an error, return its line within the block and the reason."""
    if sys.version_info >= (3, 11):
        import tomllib
    else:
        import tomli as tomllib

    try:
        return tomllib.loads(block), None
    except ValueError as error:
        line_match = re.search(r"at line (\d+)", str(error))
        return {}, (int(line_match[1]) - 1 if line_match else 0, _TOML_PLACE.sub("", str(error)))


def _toml_problems(text: str) -> list[Problem]:
    """Return the TOML errors of a file whose rows are each valid."""
    _, parse_error = _parse_block(text)
    return [(parse_error[0] + 1, parse_error[1])] if parse_error else []


def _row_key(line: str) -> str:
    match = _ROW_START.match(line)
    return match[1].strip("\"'") if match else ""


def load_catalogue(path: Path) -> Catalogue:
    """Read the English texts of a file. Problems in the file are reported as `problem`s."""
    catalogue = Catalogue()
    text, catalogue.problems = decode_file(path)
    catalogue_rows, _, problems = parse_rows(text)
    catalogue.problems += problems
    keys, entry_by_text = set[str](), dict[tuple[str, str], Entry]()
    for row in catalogue_rows:
        notes = [row.table] * (bool(row.table) and not row.key.startswith(row.table))
        entries = []
        for value in row.value if isinstance(row.value, list) else [row.value]:
            forms = value if isinstance(value, dict) else {"": value}
            entries.append(
                entry := Entry(row.key, *_text_and_plural(forms), notes=notes, line=row.line)
            )
            entry.is_same = "same" in forms or _GAP.fullmatch(entry.english) is not None
            if not entry.is_same and "own" not in forms:
                earlier_entry = entry_by_text.setdefault((entry.english, entry.plural), entry)
                if earlier_entry is not entry:
                    entry.is_same, entry.same_text_key = True, earlier_entry.key
                    earlier_entry.notes = list(dict.fromkeys([*earlier_entry.notes, *notes]))
        if row.key in keys:
            catalogue.problems.append((row.line, f"{row.key}: it is there twice"))
        elif row.value is not None and (problem := _find_problem(entries)):
            catalogue.problems.append((row.line, f"{row.key}: {problem}"))
        keys.add(row.key)
        for entry in entries:
            catalogue.entries.setdefault(entry.identity, entry)
    return catalogue


def _text_and_plural(forms: dict[str, object]) -> tuple[str, str]:
    """Return a text and its plural, empty without one."""
    match forms:
        case {"one": str(one), "other": str(other), **more} if not more:
            return one, other
        case {"": str(text), **more} | {"own": str(text), **more} | {"same": str(text), **more}:
            return "" if more else text, ""
    return "", ""


def _find_problem(entries: list[Entry]) -> str:
    """Return the problem with the texts of a key, or ""."""
    texts = [entry.english for entry in entries]
    if not all(texts) or not texts:
        return "it has no text"
    if len(set(texts)) < len(texts):
        return "it has a text twice"
    try:
        for entry in entries:
            if entry.plural or not entry.is_same:
                gap_names(entry.english), gap_names(entry.plural)
    except ValueError:
        return "a brace { or } has no other half"
    return ""


def gap_names(text: str) -> set[str]:
    """Return the names of the gaps, with the text after a colon: the format of the value."""
    return {
        name + (":" + format_spec if format_spec else "")
        for _, name, format_spec, _ in Formatter().parse(text)
        if name is not None
    }
