"""Reads the English texts, `en/*.toml`, from which all languages are translated.

A row is a text by its key. A list has several texts with one key, of which a message says the first
whose gaps all have values; `one` and `other` are a text with a plural; `same` is a program, which
no language says in another way. A text under several keys is translated once, at the first of them:
`own` is one that means something else there. The name of a table is the note that translators read
beside each of its texts, but where the key begins with it; rows above all tables need none.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator
from pathlib import Path

from tiniscript.base.catalogue_file import Catalogue, Entry, gaps

_GAP = re.compile(r"\{@?\w+\}")
_FORMS = {"one", "other", "own", "same"}
HEAD = """\
Project-Id-Version: TiniScript
Language: en
Language-Team: English
X-Name: English
MIME-Version: 1.0
Content-Type: text/plain; charset=UTF-8
Content-Transfer-Encoding: 8bit
Plural-Forms: nplurals=2; plural=(n != 1);
"""


def load(path: Path) -> Catalogue:
    """Read a file. What is wrong in it is a problem."""
    if sys.version_info >= (3, 11):
        import tomllib
    else:
        import tomli as tomllib

    found = Catalogue(HEAD)
    text = path.read_text(encoding="utf-8-sig", errors="replace")
    try:
        tables = tomllib.loads(text)
    except ValueError as error:
        at = re.search(r"at line (\d+)", str(error))
        found.problems.append((int(at[1]) if at else text.count("\n"), f"this is no TOML: {error}"))
        return found
    heads = (re.sub(r"(\.own|\.same)? = .*", "", row) for row in text.split("\n"))
    lines = {head.strip("\"'"): number for number, head in enumerate(heads, 1)}
    keys, firsts = set[str](), dict[tuple[str, str], Entry]()
    for key, value, notes in _rows(tables):
        line = lines.get(key, 1)
        entries = []
        for each in value if isinstance(value, list) else [value]:
            form = each if isinstance(each, dict) else {"": each}
            entries.append(entry := Entry(key, *_text(form), [], notes, line=line))
            entry.is_same = "same" in form or _GAP.fullmatch(entry.english) is not None
            if not entry.is_same and "own" not in form:
                first = firsts.setdefault((entry.english, entry.plural), entry)
                if first is not entry:
                    entry.is_same, entry.like = True, first.key
                    first.notes = list(dict.fromkeys([*first.notes, *notes]))
        if why := "it is there twice" if key in keys else _problem(entries):
            found.problems.append((line, f"{key}: {why}"))
        keys.add(key)
        for entry in entries:
            found.entries.setdefault(entry.at, entry)
    return found


def _rows(tables: dict[str, object]) -> Iterator[tuple[str, object, list[str]]]:
    """Yield each key, what stands behind it, and the notes for translators."""
    for name, value in tables.items():
        if isinstance(value, dict) and not _FORMS & value.keys():
            for key, each in value.items():
                yield key, each, [name] * (not key.startswith(name))
        else:
            yield name, value, []


def _text(form: dict[str, object]) -> tuple[str, str]:
    """Return a text and its plural, empty without one."""
    match form:
        case {"one": str(one), "other": str(other), **more} if not more:
            return one, other
        case {"": str(said), **more} | {"own": str(said), **more} | {"same": str(said), **more}:
            return "" if more else said, ""
    return "", ""


def _problem(entries: list[Entry]) -> str:
    """Return what is wrong with the texts of a key, or nothing."""
    texts = [each.english for each in entries]
    if not all(texts) or not texts:
        return "it has no text"
    if len(set(texts)) < len(texts):
        return "it has a text twice"
    try:
        for entry in entries:
            if entry.plural or not entry.is_same:
                gaps(entry.english), gaps(entry.plural)
    except ValueError:
        return "a brace { or } has no other half"
    return ""
