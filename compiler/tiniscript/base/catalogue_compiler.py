"""Makes the `.mo` of catalogues, with Python alone.

A `.mo` has each text under its key, and of several with one key the second under `key/2`. What is
not translated, or wrong, or a translation of what the English text was before, is in English there.
"""

from __future__ import annotations

import struct
from collections import Counter
from pathlib import Path

from tiniscript.base import catalogue_source
from tiniscript.base.catalogue_file import Catalogue, Entry, load

MAGIC, HEADER = 0x950412DE, 28  # of a .mo


def merged(source: Path, own: Path) -> tuple[str, dict[str, list[str]]]:
    """Return the head of a catalogue, and the forms of each text by key.

    Where there is no English source, the English texts are those that are translated.
    """
    translated = load(own)
    english = catalogue_source.load(source) if source.is_file() else translated
    if english.problems and not english.entries:
        raise ValueError(f"{source}: {english.problems[0][1]}")
    texts: dict[str, list[str]] = {}
    numbers = Counter[str]()
    for (key, _), entry in english.entries.items():
        numbers[key] += 1
        number = f"/{numbers[key]}" if numbers[key] > 1 else ""
        texts[key + number] = _forms(entry, translated)
    return translated.head or english.head, texts


def _forms(source: Entry, own: Catalogue) -> list[str]:
    entry = own.entries.get((source.like or source.key, source.english))
    if entry and entry.plural == source.plural and entry.is_translated:
        return entry.said
    if not source.plural:
        return [source.english]
    return [source.english, *[source.plural] * max(1, own.plurals - 1)]


def machine_object(head: str, texts: dict[str, list[str]]) -> bytes:
    """Return a `.mo`: the offsets of keys, those of texts, and all of these, each with a 0."""
    rows = {"": [head], **texts}
    keys = [
        (b"\0".join([key.encode()] * min(2, len(forms))), "\0".join(forms).encode())
        for key, forms in sorted(rows.items(), key=lambda row: row[0].encode())
    ]
    at = HEADER + 16 * len(keys)
    offsets: list[int] = []
    for part in (0, 1):
        for row in keys:
            offsets += (len(row[part]), at)
            at += len(row[part]) + 1
    count = len(keys)
    numbers = (MAGIC, 0, count, HEADER, HEADER + 8 * count, 0, 0, *offsets)
    data = b"".join(row[part] + b"\0" for part in (0, 1) for row in keys)
    return struct.pack(f"<{len(numbers)}I", *numbers) + data


def compiled(source: Path, own: Path) -> bytes:
    """Return the `.mo` of a catalogue."""
    return machine_object(*merged(source, own))
