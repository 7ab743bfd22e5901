"""The languages: a folder each, with the texts that a translator fills.

A catalogue, `es/command.toml`, has its texts by the keys of the English one, `en/command.toml`. A
language exists as soon as its folder does, and texts that it lacks appear in English. At run time,
tsc reads files made from these, such as `es/command.texts`: `setup.py` makes them for a package; in
a clone they are remade when a source is newer. The English texts of the catalogue `names` are in
other `.toml` files of the package. Knows no text.
"""

from __future__ import annotations

import marshal
from collections.abc import Callable, Iterable
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar

if TYPE_CHECKING:
    from tiniscript.base.catalogue_source import Catalogue

FOLDER = Path(__file__).parent.parent / "languages"
SOURCE_LANGUAGE = "en"  # the language of the originals, and the fallback for missing translations
ABOUT_FILE, SEEN_FILE = (
    "language.toml",
    "seen.txt",
)  # a language's description of itself
NAMES_CATALOGUE = "names"  # the catalogue whose keys are the English texts
CACHE_ENDING = ".texts"  # ending of files generated from sources
MARSHAL_VERSION = 2  # the version of `marshal`'s format; every Python reads it

Forms = dict[str, str]  # plural forms of a text, by their names in Unicode's CLDR
Texts = dict[str, "str | Forms"]
T = TypeVar("T")


class Language(NamedTuple):
    """The description of a language. `form_digits` gives the plural form of each number below 200
    as a digit, an index of `forms`; from 100 on they repeat every hundred.
    """

    name: str
    english_name: str
    forms: tuple[str, ...]
    form_digits: str


class WrongTexts(Exception):
    """The English texts of a clone are wrong: there is no language to say that in."""


class ByLanguage(dict[str, T]):
    """A name or names by language: in other languages the English ones, or those of the first
    language, as translated by the catalogue `names`.
    """

    def __missing__(self, language: str) -> T:
        return _translate_name(self.get(SOURCE_LANGUAGE) or next(iter(self.values())), language)

    def __repr__(self) -> str:
        return f"ByLanguage({super().__repr__()})"


def _translate_name(name: T, language: str) -> T:
    if isinstance(name, dict):
        return {key: _translate_name(value, language) for key, value in name.items()}  # type: ignore[return-value]
    return find_text("names", name, language) or name  # type: ignore[arg-type, return-value]


@cache
def languages() -> tuple[str, ...]:
    """Return the codes of all languages, the one that is translated first."""
    codes = (path.name for path in FOLDER.iterdir() if path.is_dir() and path.name[0] != "_")
    return tuple(sorted(codes, key=lambda code: (code != SOURCE_LANGUAGE, code)))


def find_language(locale_name: str) -> str:
    """Return the language of a localesuch as `es_PE.UTF-8` or Windows' `Spanish_Peru`; the default
    is English."""
    code = locale_name.lower().replace("-", "_").partition(".")[0].partition("@")[0]
    for candidate in (code, code.partition("_")[0]):
        if candidate in languages():
            return candidate
    language_name = code.partition("_")[0]
    code_by_name = (
        {language_info(language).english_name.lower(): language for language in languages()}
        if language_name
        else {}
    )
    return code_by_name.get(language_name, SOURCE_LANGUAGE)


def read_language_file(language: str, name: str) -> str:
    """Return a file of a language's folder, which may lack it."""
    path = FOLDER / language / name
    return path.read_text(encoding="utf-8-sig") if path.is_file() else ""


def language_info(language: str) -> Language:
    """Return the description of a language."""
    return _load_language(language if language in languages() else SOURCE_LANGUAGE)


@cache
def _load_language(language: str) -> Language:
    path = FOLDER / language / ABOUT_FILE
    return Language(
        *_load_cached(path.with_suffix(CACHE_ENDING), [path], lambda: _catalogue_texts(language))
    )


def _catalogue_texts(language: str) -> tuple[Any, ...]:
    from tiniscript.base.translations import read_language

    info = read_language(FOLDER / language / ABOUT_FILE)
    return info.name, info.english_name, info.forms, info.form_digits


def find_text(name: str, key: str, language: str) -> str | None:
    """Return a text of a catalogue, None if it has no such key, or one that counts."""
    text = catalogue(name, language).get(key)
    return text if isinstance(text, str) else None


def text(name: str, key: str, language: str) -> str:
    """Return a text of a catalogue."""
    found_text = find_text(name, key, language)
    if found_text is not None:
        return found_text
    raise KeyError(key)


def plain_text_keys(name: str) -> list[str]:
    """Return the keys of a catalogue's texts, without those that count."""
    return [
        key for key, value in catalogue(name, SOURCE_LANGUAGE).items() if isinstance(value, str)
    ]


def translated_languages(name: str, key: str) -> list[str]:
    """Return the languages in which a text is there, the one that is translated first."""
    english = text(name, key, SOURCE_LANGUAGE)
    return [
        language
        for language in languages()
        if language == SOURCE_LANGUAGE or text(name, key, language) != english
    ]


def plural_text(name: str, key: str, count: int, language: str) -> str:
    """Return the form of a text with a plural that goes with a number."""
    forms = catalogue(name, language)[key]
    assert isinstance(forms, dict), key
    info = language_info(language)
    number = count if count < 100 else 100 + count % 100
    return forms.get(info.forms[int(info.form_digits[number])]) or forms["other"]


@cache
def catalogue(name: str, language: str) -> Texts:
    """Return the texts of a catalogue by key; of an unknown language they are English."""
    language = language if language in languages() else SOURCE_LANGUAGE
    translation_path, cache_path = (
        source_files(name, language)[1],
        FOLDER / language / (name + CACHE_ENDING),
    )
    if not translation_path.is_file() and (is_clone() or not cache_path.is_file()):
        # The language has no translation, or a page has not fetched it.
        if language != SOURCE_LANGUAGE:
            return catalogue(name, SOURCE_LANGUAGE)
        if not is_clone():
            return {}
    companion_files = (
        translation_path.with_name(file_name) for file_name in (SEEN_FILE, ABOUT_FILE)
    )
    loaded_texts: Texts = _load_cached(
        cache_path, [*source_files(name, language), *companion_files], lambda: texts(name, language)
    )
    return loaded_texts


def texts(name: str, language: str) -> Texts:
    """Return the texts of a catalogue as its sources have them."""
    from tiniscript.base.translations import texts_of

    return texts_of(merged_catalogue(name, language))


def merged_catalogue(name: str, language: str) -> Catalogue:
    """Return the English texts of a catalogue with a language's translations of them."""
    from tiniscript.base.catalogue_source import load_catalogue
    from tiniscript.base.translations import (
        TranslationFile,
        catalogue_of_names,
        merge_translations,
        read_language,
        read_seen,
        read_translation_file,
    )

    source, path = source_files(name, language)
    translation_file = (
        read_translation_file(path) if language != SOURCE_LANGUAGE else TranslationFile()
    )
    english = (
        load_catalogue(source) if name != NAMES_CATALOGUE else catalogue_of_names(translation_file)
    )
    for line, problem in english.problems:
        raise WrongTexts(f"{source}:{line}: {problem}")
    seen_hashes, _ = read_seen(path.with_name(SEEN_FILE))
    return merge_translations(
        english, name, translation_file, seen_hashes, read_language(path.with_name(ABOUT_FILE))
    )


def _load_cached(path: Path, sources: Iterable[Path], make: Callable[[], Any]) -> Any:
    """Return the content of a cache file if no source is newer; otherwise make and store it."""
    if _is_fresh(path, sources):
        with suppress(ValueError, EOFError, TypeError, OSError):  # half a file
            return marshal.loads(path.read_bytes())
    from tiniscript.base.files import replace

    value = make()
    with suppress(OSError, ValueError):  # the folder is read-only, or the disk is full
        replace(path, marshal.dumps(value, MARSHAL_VERSION))
    return value


def forget_languages() -> None:
    """Read all languages again when they are next asked for: their folder is another one now."""
    for cached_function in (languages, catalogue, _load_language):
        cached_function.cache_clear()


def cache_files() -> dict[str, bytes]:
    """Return all catalogues as a package has them, by their paths in FOLDER."""
    names = sorted({path.stem for path in FOLDER.glob("*/*.toml") if path.name != ABOUT_FILE})
    value_by_name: dict[str, Any] = {}
    for language in languages():
        value_by_name |= {f"{language}/{name}": texts(name, language) for name in names}
        value_by_name[f"{language}/{ABOUT_FILE.removesuffix('.toml')}"] = _catalogue_texts(language)
    return {
        name + CACHE_ENDING: marshal.dumps(value, MARSHAL_VERSION)
        for name, value in value_by_name.items()
    }


def is_clone() -> bool:
    """Return whether the sources are there: a package has none."""
    return (FOLDER / SOURCE_LANGUAGE / ABOUT_FILE).is_file()


def source_files(name: str, language: str) -> tuple[Path, Path]:
    """Return the English source of a catalogue, and its translation in a language."""
    return FOLDER / SOURCE_LANGUAGE / f"{name}.toml", FOLDER / language / f"{name}.toml"


def _is_fresh(path: Path, sources: Iterable[Path]) -> bool:
    """Return whether a file is there, and no source is newer: a package has none at all."""
    return path.is_file() and _modification_time_ns(path) >= max(
        map(_modification_time_ns, sources)
    )


def _modification_time_ns(path: Path) -> int:
    try:
        return path.stat().st_mtime_ns
    except OSError:
        return 0
