"""A document of the repository becomes a page of the site: its links lead to pages.

Knows Markdown as far as its links go. A link to a document that the site has leads to its page, in
the other language's page if it is there; one to another file of the repository to a copy of it.
"""

from __future__ import annotations

import os
import re
import shutil
from dataclasses import dataclass, field
from html import escape
from pathlib import Path, PurePosixPath
from typing import NamedTuple

from tiniscript.lessons import catalogue
from tiniscript.lessons.catalogue import fill_numbers
from tools import CannotMake
from tools.site.documents import Document

_FENCED = re.compile(r"(^ *```.*?^ *```$)", re.DOTALL | re.MULTILINE)
_LINK = re.compile(r"(!?)\[((?:[^\[\]]|\[[^\]]*\])*)\]\(([^)\s#]*)(#[^)\s]*)?\)")
FILES_FOLDER = "files"  # the folder of the copies, next to those of the languages


class SitePage(NamedTuple):
    """A page: its language, and its name without an ending."""

    language: str
    name: str

    @property
    def address(self) -> str:
        return f"{self.language}/{self.name}.html"


@dataclass
class Shelf:
    """The places of a clone's documents on the site, and of other linked files.

    `built_texts` are texts in addition to the files of the clone, by the names that they would have
    there.
    """

    root: Path
    places: dict[str, SitePage]
    pages_of_source: dict[
        str, dict[str, SitePage]
    ]  # places of a document by source, then by language
    built_texts: dict[str, str] = field(default_factory=dict)
    linked_files: set[str] = field(default_factory=set)
    pictures: set[str] = field(default_factory=set)

    def text(self, name: str) -> str:
        return self.built_texts.get(name) or (self.root / name).read_text(encoding="utf-8")

    def has(self, name: str) -> bool:
        return name in self.built_texts or (self.root / name).is_file()

    def copy(self, name: str, target: Path) -> None:
        target.parent.mkdir(parents=True, exist_ok=True)
        if name in self.built_texts:
            target.write_text(self.built_texts[name], encoding="utf-8")
        else:
            shutil.copyfile(self.root / name, target)


def shelf(
    root: Path, documents: list[Document], built_texts: dict[str, str] | None = None
) -> Shelf:
    """Return the shelf of a clone's documents."""
    places: dict[str, SitePage] = {}
    pages_of_source: dict[str, dict[str, SitePage]] = {}
    for document in documents:
        place_of_language = {
            language: SitePage(language, document.name) for language in document.sources
        }
        for language, source in document.sources.items():
            places[source], pages_of_source[source] = place_of_language[language], place_of_language
    return Shelf(root, places, pages_of_source, built_texts or {})


def page(source: str, shelf: Shelf, place: SitePage | None = None) -> str:
    """Return the Markdown of a document's page; note the files that it leads to.

    `place` is where it is, if not where its source is. Raises CannotMake if a link leads to no
    file.
    """
    parts: list[str] = []
    path = shelf.root / source
    place_ = place or shelf.places[source]
    text = shelf.text(source)
    if (path.parent / "lesson.toml").is_file():
        text = fill_numbers(text, source, catalogue.load(path.parent))
    for number, part in enumerate(_FENCED.split(text)):
        is_code = number % 2 == 1
        parts.append(
            part
            if is_code
            else _LINK.sub(lambda link: _resolved_link(link, source, place_, shelf), part)
        )
    return "".join(parts)


def _resolved_link(link: re.Match[str], source: str, place: SitePage, shelf: Shelf) -> str:
    """Return a link of a document as the page has it."""
    picture_mark, text, path, anchor = (
        link.group(1),
        link.group(2),
        link.group(3),
        link.group(4) or "",
    )
    if not path or ":" in path:
        return link.group(0)
    target = Path(os.path.normpath(PurePosixPath(source).parent / path)).as_posix()
    pages_of_target = shelf.pages_of_source.get(target, {})
    is_itself = place in pages_of_target.values()  # the page itself in another language
    target_place = (
        shelf.places.get(target)
        if is_itself
        else pages_of_target.get(place.language, shelf.places.get(target))
    )
    if target_place is not None and target_place.language == place.language:
        return f"[{text}]({relative_address(place.name, target_place.name)}.md{anchor})"
    if target_place is not None:
        return _outside_link(text, relative_address(place.address, target_place.address) + anchor)
    if not shelf.has(target):
        raise CannotMake(f"{source}: {path}")
    if picture_mark:
        shelf.pictures.add(target)
        return f"![{text}](/{FILES_FOLDER}/{target})"
    shelf.linked_files.add(target)
    return _outside_link(text, relative_address(place.address, f"{FILES_FOLDER}/{target}"))


def _outside_link(text: str, address: str) -> str:
    """Return a link that Sphinx leaves as it is: it leads out of this part of the site."""
    return f'<a href="{escape(address)}">{text}</a>'


def relative_address(source_page: str, target_page: str) -> str:
    """Return the relative address of one page on another, both named from the same folder."""
    return Path(os.path.relpath(target_page, start=PurePosixPath(source_page).parent)).as_posix()
