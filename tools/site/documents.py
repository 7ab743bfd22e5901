"""Which documents the site has, in which language, under which name, and beside which others.

Knows the repository's documents by their English files. In another language a document has the
name that `documents.txt` in the folder of the language gives it, else that of the English file with
the code of the language; it is there as soon as its file is. `test_site.py` fails where a document
of the repository is in no row.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from functools import cache
from pathlib import Path, PurePosixPath
from typing import NamedTuple

from tiniscript.base.languages import SOURCE, about, languages, table

LIST = "docs/README.md"  # of all others, made from here
FRONT = "README.md"  # of each half of the site
PARTS = ("teach", "write", "wiring", "pupils", "teachers", "trust", "build")
ENDING = re.compile(r"(?:\.en)?(\.\w+)$")


class Document(NamedTuple):
    """`sources` are its files in the repository, by language; `name` is that of its page."""

    name: str
    part: str
    sources: dict[str, str]


def name_in(language: str, english: str) -> str:
    """Return what the file of a document is called in a language, whether it is there or not."""
    if language == SOURCE:
        return english
    return _names(language).get(english) or ENDING.sub(rf".{language}\1", english)


@cache
def _names(language: str) -> dict[str, str]:
    rows = (row.split() for row in table(language, "documents.txt").splitlines())
    return {row[0]: row[1] for row in rows if row and row[0] != "#"}


def sources(root: Path, english: str) -> dict[str, str]:
    """Return the files of a document by language, English first."""
    found = {language: name_in(language, english) for language in languages()}
    return {
        language: name
        for language, name in found.items()
        if language == SOURCE or (root / name).is_file()
    }


def links(language: str, english: str, others: Iterable[str]) -> list[str]:
    """Return the links on a document to itself in other languages."""
    return [
        f"[{about(each).name}]({PurePosixPath(name_in(each, english)).name})"
        for each in others
        if each != language
    ]


def _rows(root: Path, part: str, *files: str, folder: str = "") -> list[Document]:
    """Return documents whose pages are called as their English files."""
    return [
        Document(
            folder + ENDING.sub("", PurePosixPath(each).name).lower(), part, sources(root, each)
        )
        for each in files
    ]


def _files(root: Path, pattern: str) -> list[str]:
    return sorted(path.relative_to(root).as_posix() for path in root.glob(pattern))


def _lessons(root: Path) -> list[Document]:
    return [
        Document(f"lessons/{Path(file).parent.name}_{reader}", f"{reader}s", sources(root, file))
        for folder in _files(root, "compiler/tiniscript/lessons/[0-9]*")
        for reader in ("pupil", "teacher")
        for file in [f"{folder}/{reader}.en.md"]
    ]


def documents(root: Path) -> list[Document]:
    """Return the documents of a clone, in the order in which the site shows them."""
    return [
        *_rows(root, "teach", "docs/en/monday.md", "docs/en/bring-up.md", "docs/en/lessons.md",
               "docs/en/materials.md", "docs/en/measure.md", "docs/en/modules.md"),
        *_rows(root, "write", "docs/en/language.md", "docs/en/robots.md", "docs/en/studio.md",
               "docs/en/command.md"),
        *_rows(root, "teach", "docs/en/class.md"),
        *_rows(root, "write", "docs/en/worlds.md"),
        Document("library", "write", sources(root, "docs/en/api.md")),
        *_rows(root, "wiring", *_files(root, "docs/wiring/*.en.md"), folder="wiring/"),
        *_lessons(root),
        Document("index", "trust", sources(root, FRONT)),
        *_rows(root, "trust", "docs/en/comparison.md", "docs/en/guarantees.md", "docs/en/figures.md",
               "docs/en/computer.md", "SECURITY.md", "CODE_OF_CONDUCT.md"),
        *_rows(root, "build", "CONTRIBUTING.md", "docs/develop/first-change.md", "docs/develop/translating.md",
               "docs/develop/architecture.md", "bytecode_spec.md", "docs/develop/conformance.md", "docs/develop/link.md",
               "docs/develop/owners.md", "docs/develop/network.md", "docs/develop/text.md", "docs/develop/store.md",
               "docs/develop/esp32.md", "docs/en/versions.md", "CHANGELOG.md"),
        Document("documents", "build", {SOURCE: LIST}),
    ]  # fmt: skip
