"""Lists the documents of the site: their languages, their names, and their neighbours.

Knows the repository's documents by their English files. In another language a document of
`docs/en` is in the folder of that language, under the same name; a file elsewhere has the code of
the language in its name. It is there as soon as its file is. `test_site.py` fails where a document
of the repository is in no row.
"""

from __future__ import annotations

import os
import re
from collections.abc import Collection, Iterable
from pathlib import Path, PurePosixPath
from typing import NamedTuple

from tiniscript.base.languages import SOURCE_LANGUAGE, language_info, languages

INDEX_PAGE = "docs/README.md"  # generated page about all others
PAGES = "docs/en/"
FRONT_PAGE = "README.md"  # first page in each language of the site
PARTS = ("teach", "write", "wiring", "pupils", "teachers", "trust", "build")
FILE_ENDING = re.compile(r"(?:\.en)?(\.\w+)$")


class Document(NamedTuple):
    """`sources` are its files in the repository, by language; `name` is that of its page."""

    name: str
    part: str
    sources: dict[str, str]


def name_in(language: str, english: str) -> str:
    """Return a document's file name in a language, whether it exists or not."""
    if language == SOURCE_LANGUAGE:
        return english
    if english.startswith(PAGES):
        return f"docs/{language}/{english.removeprefix(PAGES)}"
    return FILE_ENDING.sub(rf".{language}\1", english)


def language_of(name: str) -> str:
    """Return the language that a document is in, by the name of its file."""
    folder, code = PurePosixPath(name).parts[1:2], name.split(".")[-2:-1]
    return next((part for part in (*folder, *code) if part in languages()), SOURCE_LANGUAGE)


def sources(root: Path, english: str) -> dict[str, str]:
    """Return the files of a document by language, English first."""
    name_of_language = {language: name_in(language, english) for language in languages()}
    return {
        language: name
        for language, name in name_of_language.items()
        if language == SOURCE_LANGUAGE or (root / name).is_file()
    }


def links(language: str, english: str, other_languages: Iterable[str]) -> list[str]:
    """Return the links on a document to itself in other languages."""
    own_folder = PurePosixPath(name_in(language, english)).parent
    return [
        f"[{language_info(other).name}]({_relative_path(name_in(other, english), own_folder)})"
        for other in other_languages
        if other != language
    ]


def _relative_path(name: str, folder: PurePosixPath) -> str:
    return Path(os.path.relpath(name, folder)).as_posix()


def _documents_of_files(root: Path, part: str, *files: str, folder: str = "") -> list[Document]:
    """Return documents whose pages have the names of their English files."""
    return [
        Document(
            folder + FILE_ENDING.sub("", PurePosixPath(file).name).lower(),
            part,
            sources(root, file),
        )
        for file in files
    ]


def _guide_documents(root: Path, part: str, *names: str) -> list[Document]:
    return _documents_of_files(root, part, *(f"{PAGES}{name}.md" for name in names))


def _developer_documents(root: Path, *names: str) -> list[Document]:
    """Return pages for developers, which are in English alone."""
    return _documents_of_files(root, "build", *(f"docs/develop/{name}.md" for name in names))


def _matching_files(root: Path, pattern: str) -> list[str]:
    return sorted(path.relative_to(root).as_posix() for path in root.glob(pattern))


def _lesson_documents(root: Path) -> list[Document]:
    return [
        Document(f"lessons/{Path(file).parent.name}_{reader}", f"{reader}s", sources(root, file))
        for folder in _matching_files(root, "compiler/tiniscript/lessons/[0-9]*")
        for reader in ("pupil", "teacher")
        for file in [f"{folder}/{reader}.en.md"]
    ]


def documents(root: Path, built: Collection[str] = ()) -> list[Document]:
    """Return the documents of a clone, in the order in which the site shows them.

    `built` has the names of those that exist in addition to its files.
    """
    documents_in_clone = [
        *_guide_documents(
            root, "teach", "monday", "bring-up", "lessons", "materials", "measure", "modules"
        ),
        *_guide_documents(root, "write", "language", "robots", "studio", "command"),
        *_guide_documents(root, "teach", "class"),
        *_guide_documents(root, "write", "worlds"),
        Document("library", "write", sources(root, f"{PAGES}api.md")),
        *_documents_of_files(
            root, "wiring", *_matching_files(root, f"{PAGES}wiring/*.md"), folder="wiring/"
        ),
        *_lesson_documents(root),
        Document("index", "trust", sources(root, FRONT_PAGE)),
        *_guide_documents(root, "trust", "comparison", "guarantees", "figures", "computer"),
        *_documents_of_files(root, "trust", "SECURITY.md", "CODE_OF_CONDUCT.md"),
        *_documents_of_files(root, "build", "CONTRIBUTING.md"),
        *_developer_documents(root, "first-change", "translating", "architecture", "decisions"),
        *_documents_of_files(root, "build", "bytecode_spec.md"),
        *_developer_documents(
            root, "conformance", "link", "owners", "network", "text", "store", "runs", "esp32"
        ),
        *_guide_documents(root, "build", "versions"),
        *_documents_of_files(root, "build", "CHANGELOG.md"),
        Document("documents", "build", {SOURCE_LANGUAGE: INDEX_PAGE}),
    ]
    readable_documents = [
        document
        for document in documents_in_clone
        if document.sources[SOURCE_LANGUAGE] in built
        or (root / document.sources[SOURCE_LANGUAGE]).is_file()
    ]
    return [
        document._replace(sources=_with_built(built, document.sources))
        for document in readable_documents
    ]


def _with_built(built: Collection[str], sources: dict[str, str]) -> dict[str, str]:
    names = {language: name_in(language, sources[SOURCE_LANGUAGE]) for language in languages()}
    return {value: name for value, name in names.items() if value in sources or name in built}
