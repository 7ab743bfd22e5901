"""Reads and writes catalogues of gettext (`.po`), and says what is wrong with one.

An entry is one text: its key is the context, and what is translated is the English text. A text
without a context is its own key. Several texts may have one key: which one is meant is told by the
English text, wherever it stands. Knows no language. A mistake in an entry costs that entry alone.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from pathlib import Path

from tiniscript.base import catalogue_source as source
from tiniscript.base.catalogue_source import gaps

ESCAPES = {"n": "\n", "t": "\t", "r": "\r", '"': '"', "\\": "\\"}
BRACES = "python-brace-format"  # gettext's flag for a text with gaps like {file}
_ROW = re.compile(r'(msgctxt|msgid|msgid_plural|msgstr|msgstr\[(\d)\])?\s*"((?:[^"\\]|\\.)*)"\s*')
_PLURALS = re.compile(r"nplurals\s*=\s*(\d+)")


@dataclass
class Entry:
    """A text. `said` has its translation, of a text with a plural each form; empty is none yet.

    `notes` are the comments for translators. A fuzzy entry is of an English text that has changed;
    `is_same`: no translator is asked for it, since no language says it in another way, or since its
    words stand under the key `like`, too.
    """

    key: str = ""
    english: str = ""
    plural: str = ""
    said: list[str] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    is_fuzzy: bool = False
    is_same: bool = False
    like: str = ""
    line: int = 0

    @property
    def at(self) -> tuple[str, str]:
        return self.key, self.english

    @property
    def is_translated(self) -> bool:
        return all(self.said) and bool(self.said) and not self.is_fuzzy


@dataclass
class Catalogue:
    """The entries of a file by key and English text, its head, and what is wrong: a line and a
    sentence each."""

    head: str = ""
    entries: dict[tuple[str, str], Entry] = field(default_factory=dict)
    problems: list[tuple[int, str]] = field(default_factory=list)

    @property
    def plurals(self) -> int:
        found = _PLURALS.search(self.head)
        return int(found[1]) if found else 0


def load(path: Path) -> Catalogue:
    """Read a file; one that is not there has no entries."""
    return (
        read(path.read_text(encoding="utf-8-sig", errors="replace"))
        if path.is_file()
        else Catalogue()
    )


def read(text: str) -> Catalogue:
    """Read a catalogue. What cannot be read is a problem, and left out."""
    found = Catalogue()
    entry, parts, part = Entry(), dict[str, str](), ""

    def end() -> None:
        nonlocal entry, parts, part
        if parts:
            entry.english = parts.get("msgid", "")
            entry.key = parts.get("msgctxt", entry.english)
            entry.plural = parts.get("msgid_plural", "")
            entry.said = [parts[each] for each in sorted(parts) if each.startswith("msgstr")]
            _take(found, entry)
        entry, parts, part = Entry(), {}, ""

    for number, row in enumerate(text.split("\n"), 1):
        row = row.strip()
        if not row:
            end()
        elif row[0] == "#":
            if any(each.startswith("msgstr") for each in parts):
                end()
            if row[:2] == "#.":
                entry.notes.append(row[2:].strip())
            entry.is_fuzzy |= row[:2] == "#," and "fuzzy" in row
        elif match := _ROW.fullmatch(row):
            if match[1] in ("msgctxt", "msgid") and any(
                each.startswith("msgstr") for each in parts
            ):
                end()
            part = match[1] or part
            entry.line = entry.line or number
            if match[1] and match[1] in parts:
                found.problems.append((number, f"{part} is there twice"))
            parts[part] = parts.get(part, "") * (not match[1]) + _unescaped(match[3])
        else:
            found.problems.append((number, f"this is no row of a catalogue: {row[:40]}"))
    end()
    for each in list(found.entries.values()):
        for problem in _problems(each, found.plurals):
            found.problems.append((each.line, f"{each.key}: {problem}"))
            each.said = []
    return found


def _take(found: Catalogue, entry: Entry) -> None:
    if not entry.key and not entry.english:
        found.head = "".join(entry.said)
    elif entry.at in found.entries:
        found.problems.append((entry.line, f"{entry.key} is there twice"))
    else:
        found.entries[entry.at] = entry


def _problems(entry: Entry, plurals: int) -> list[str]:
    """Return what is wrong with the translation of an entry."""
    if not any(entry.said):
        return []
    wanted = plurals if entry.plural else 1
    if len(entry.said) != wanted or not all(entry.said):
        return [f"it has {sum(map(bool, entry.said))} forms, and needs {wanted}"]
    known = gaps(entry.english) | gaps(entry.plural)
    found = []
    for said in entry.said:
        try:
            own = gaps(said)
        except ValueError:
            return ["a brace { or } has no other half"]
        found += [f"{{{gap}}} is missing" for gap in sorted(gaps(entry.english) - own)]
        found += [f"{{{gap}}} is no gap of the English text" for gap in sorted(own - known)]
    return found


def _unescaped(text: str) -> str:
    return re.sub(r"\\(.)", lambda match: ESCAPES.get(match[1], match[1]), text)


def joined(english: source.Catalogue, path: Path) -> source.Catalogue:
    """Return English texts with those of a file."""
    own = load(path)
    for entry in english.entries.values() or map(_name, own.entries):
        english.entries[entry.at] = entry
        old = own.entries.get((entry.like or entry.key, entry.english))
        if old and old.is_translated and old.plural == entry.plural:
            names = entry.forms if entry.plural else [""]
            entry.said, entry.seen = dict(zip(names, old.said, strict=True)), entry.hash
    return english


def _name(at: tuple[str, str]) -> source.Entry:
    return source.Entry(*at)


def head(path: Path) -> tuple[str, str, str]:
    """Return what a language says of itself: a rule, its name, and its English name."""
    said = dict(row.split(": ", 1) for row in load(path).head.splitlines())
    rule = re.sub(r".*plural=(.*);", r"\1", said["Plural-Forms"])
    return rule, said["X-Name"], said["Language-Team"]
