"""The languages: a folder each, with the catalogues that a translator fills.

A catalogue, `es/command.po`, has its texts by key, which is their context; the English ones are in
`en/command.toml`. A language is there as soon as its folder is, and what it lacks is said in
English, text by text. Catalogues are read as `.mo`: `setup.py` makes them for a package, and in a
clone they are made where a source is newer. The English texts of the catalogue `names` are in other
`.toml` files of the package. Knows no text.
"""

from __future__ import annotations

from contextlib import suppress
from functools import cache
from gettext import GNUTranslations
from io import BytesIO
from pathlib import Path
from typing import TypeVar

FOLDER = Path(__file__).parent.parent / "languages"
SOURCE = "en"  # what is translated, and said where there is no translation


T = TypeVar("T")


class ByLanguage(dict[str, T]):
    """A name, or names, in each language that a file says: elsewhere what is said in English, else
    in the first language, as the catalogue `names` translates it."""

    def __missing__(self, language: str) -> T:
        return _named(self.get(SOURCE) or next(iter(self.values())), language)

    def __repr__(self) -> str:
        return f"ByLanguage({super().__repr__()})"


def _named(name: T, language: str) -> T:
    if isinstance(name, dict):
        return {key: _named(each, language) for key, each in name.items()}  # type: ignore[return-value]
    return found("names", name, language) or name  # type: ignore[arg-type, return-value]


@cache
def languages() -> tuple[str, ...]:
    """Return the codes of all languages, the one that is translated first."""
    found = (path.name for path in FOLDER.iterdir() if path.is_dir() and path.name[0] != "_")
    return tuple(sorted(found, key=lambda code: (code != SOURCE, code)))


def find(name: str) -> str:
    """Return the language of a locale, `es_PE.UTF-8` or Windows' `Spanish_Peru`, else English."""
    code = name.lower().replace("-", "_").partition(".")[0].partition("@")[0]
    for each in (code, code.partition("_")[0]):
        if each in languages():
            return each
    team = code.partition("_")[0]
    by_team = {about("language-team", each).lower(): each for each in languages()} if team else {}
    return by_team.get(team, SOURCE)


def table(language: str, name: str) -> str:
    """Return a file of a language's folder, which may lack it."""
    path = FOLDER / language / name
    return path.read_text(encoding="utf-8-sig") if path.is_file() else ""


def about(field: str, language: str) -> str:
    """Return what the head of a language's catalogue says, such as its name."""
    return catalogue("command", language).info().get(field, "")


def found(name: str, key: str, language: str) -> str | None:
    """Return a text of a catalogue, None where it has no such key."""
    said = catalogue(name, language).gettext(key)
    return None if said is key else said


def text(name: str, key: str, language: str) -> str:
    """Return a text of a catalogue."""
    said = found(name, key, language)
    if said is None:
        raise KeyError(key)
    return said


def keys(name: str) -> list[str]:
    """Return the keys of a catalogue, which gettext itself tells nobody."""
    return [key for key in vars(catalogue(name, SOURCE))["_catalog"] if isinstance(key, str)]


def told_in(name: str, key: str) -> list[str]:
    """Return the languages in which a text is there, the one that is translated first."""
    english = text(name, key, SOURCE)
    return [each for each in languages() if each == SOURCE or text(name, key, each) != english]


def counted(name: str, key: str, count: int, language: str) -> str:
    """Return the form of a text with a plural that goes with a number."""
    return catalogue(name, language).ngettext(key, key, count)


@cache
def catalogue(name: str, language: str) -> GNUTranslations:
    """Return a catalogue of a language; of an unknown one it is English."""
    language = language if language in languages() else SOURCE
    made = FOLDER / language / f"{name}.mo"
    if _is_fresh(made, files(name, language)):
        with made.open("rb") as file:
            return GNUTranslations(file)
    if language != SOURCE and not any(map(Path.is_file, files(name, language))):
        return catalogue(name, SOURCE)  # a page has not fetched it
    from tiniscript.base.catalogue_compiler import compiled
    from tiniscript.base.files import replace

    data = compiled(*files(name, language))
    with suppress(OSError):  # a folder that nobody may write to
        replace(made, data)
    return GNUTranslations(BytesIO(data))


def machine_objects() -> dict[str, bytes]:
    """Return all catalogues as a package has them, by their paths in FOLDER."""
    from tiniscript.base.catalogue_compiler import compiled

    names = sorted({path.stem for path in FOLDER.glob("*/*") if path.suffix in (".toml", ".po")})
    pairs = [(name, language) for language in languages() for name in names]
    return {f"{language}/{name}.mo": compiled(*files(name, language)) for name, language in pairs}


def files(name: str, language: str) -> tuple[Path, Path]:
    """Return the English source of a catalogue, and what a language has of it."""
    return FOLDER / SOURCE / f"{name}.toml", FOLDER / language / f"{name}.po"


def _is_fresh(made: Path, sources: tuple[Path, Path]) -> bool:
    """Return whether a file is there, and no source is newer: a package has none at all."""
    return made.is_file() and _time(made) >= max(map(_time, sources))


def _time(path: Path) -> int:
    try:
        return path.stat().st_mtime_ns
    except OSError:
        return 0
