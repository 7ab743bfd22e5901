"""Brings all languages in step with the English texts: `python -m tools.languages`.

These are in `languages/en/*.toml`, those of `names` in other `.toml` files of the package. A
translation follows its English text to another key, and texts without an English one are removed.
With codes, `pt fr`, it creates their folders. `--check` writes nothing, and lists problems and
stale translations. `--seen pt` notes of which English texts the new translations are, and with keys
after it, `--seen pt no_verb "TS005/*"`, of stale ones, too, which somebody has looked at. `--po pt`
writes `pt.po` for translators' tools, and `--po pt.po` reads it. `--pseudo` makes a language that
shows where longer texts do not fit.
"""

from __future__ import annotations

import argparse
import re
import sys
from collections.abc import Iterable, Iterator

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib


from tiniscript.base import catalogue_source
from tiniscript.base.catalogue_source import UNKNOWN_HASH, Catalogue, Entry, Problem
from tiniscript.base.languages import (
    ABOUT_FILE,
    FOLDER,
    NAMES_CATALOGUE,
    SOURCE_LANGUAGE,
    languages,
    read_language_file,
    source_files,
)
from tiniscript.base.translations import read_language
from tiniscript.base.words import WORDS
from tiniscript.diagnostics.codes import CODES
from tiniscript.recovery.meanings import plain
from tools.translation_files import Translation, about_text, print_problems

PSEUDO = "qps"  # conventional code for a pseudo-language
ROBOT_SIGNS = 40
# Kinds of a lexicon without English words: the commands are short for English ones.
KINDS_WITHOUT_ENGLISH = ("short", "initial", "turtle")
ACCENTS = str.maketrans("aeiouncAEIOU", "àéîõüñçÀÉÎÕÜ")


def sources() -> dict[str, Catalogue]:
    """Return the English catalogues by name.

    A message, and the text of what to try, show the wrong program of their code, next to the last
    text, which is the one without a special case.
    """
    paths = [path for path in (FOLDER / SOURCE_LANGUAGE).glob("*.toml") if path.name != ABOUT_FILE]
    catalogues = {path.stem: catalogue_source.load_catalogue(path) for path in paths}
    last_entries = {
        entry.key: entry for entry in catalogues.get("messages", Catalogue()).entries.values()
    }
    programs = {key: entry.english.splitlines() for key, entry in last_entries.items()}
    for key, entry in last_entries.items():
        code, _, part = key.partition("/")
        if code in CODES and part in ("message", "try"):
            entry.notes = [f"wrong: {row}" for row in programs.get(f"{code}/wrong", [])]
    return dict(sorted({**catalogues, NAMES_CATALOGUE: names()}.items()))


def names() -> Catalogue:
    """Return the catalogue of the texts in other TOML files of the package, each text once."""
    catalogue = Catalogue()
    for folder in ("robots", "virtual/worlds", "lessons"):
        for path in sorted((FOLDER.parent / folder).rglob("*.toml")):
            file_name = path.relative_to(FOLDER.parent).as_posix()
            for english_text in _english_texts(tomllib.loads(path.read_text(encoding="utf-8"))):
                catalogue.entries.setdefault(
                    (english_text, english_text),
                    Entry(english_text, english_text, notes=[file_name]),
                )
    return catalogue


def _english_texts(value: object) -> Iterator[str]:
    """Yield each text that stands in English in a TOML file, in a row `en` or a table `en`."""
    if isinstance(value, dict):
        for key, inner_value in value.items():
            text = inner_value.values() if isinstance(inner_value, dict) else [inner_value]
            yield from text if key == SOURCE_LANGUAGE else _english_texts(inner_value)
    elif isinstance(value, list):
        for inner_value in value:
            yield from _english_texts(inner_value)


def pseudo(source: Catalogue) -> Catalogue:
    """Return the English texts with translations that are a third longer and have accents."""
    catalogue = Catalogue()
    for text_key, entry in source.entries.items():
        forms = {name: _lengthen(form) for name, form in entry.forms.items()}
        forms = entry.forms if entry.is_same and not entry.same_text_key else forms
        catalogue.entries[text_key] = Entry(
            *text_key, entry.plural, forms, entry.hash, is_same=entry.is_same
        )
    return catalogue


def _lengthen(text: str) -> str:
    """Return a text with accents outside of its gaps, and with more words in its last line."""
    parts = re.split(r"(\{[^{}]*\}|`[^`]*`)", text)
    parts[::2] = [part.translate(ACCENTS) for part in parts[::2]]
    padding = "ñandú " * (len(text.rpartition("\n")[2]) // 3 // 6 + 1)
    return f"{''.join(parts)} {padding}".rstrip()


def make_pseudo(english: dict[str, Catalogue]) -> None:
    """Write the language PSEUDO."""
    folder = FOLDER / PSEUDO
    folder.mkdir(exist_ok=True)
    for path in folder.glob("*.*"):
        path.unlink()
    itself = about_text(PSEUDO, PSEUDO, ("one", "other"), "n != 1")
    (folder / ABOUT_FILE).write_text(itself, encoding="utf-8")
    translation = Translation(PSEUDO, english)
    for name, source in english.items():
        translation.put_all(name, pseudo(source))
    translation.write()


def check_robot(robot_catalogue: Catalogue) -> Iterator[Problem]:
    """Yield the texts that a robot cannot store in its few bytes."""
    for entry in robot_catalogue.entries.values():
        for form in (entry.translation or entry.forms).values():
            if not form.isascii() or len(form) > ROBOT_SIGNS:
                yield entry.line, f"a robot says at most {ROBOT_SIGNS} signs, in ASCII: {form}"


def check_lexicon(language: str) -> Iterator[str]:
    """Rows of a lexicon without a meaning that the English one has, or with other than capitals."""
    known_words = (
        {row.split()[0] for row in _rows(SOURCE_LANGUAGE)} | {*KINDS_WITHOUT_ENGLISH} | {*WORDS}
    )
    for row in _rows(language):
        meaning, separator, words = row.partition("|")
        if (
            not separator
            or not known_words.issuperset(meaning.split()[:1])
            or plain(words) != words
        ):
            yield row


def _rows(language: str) -> list[str]:
    rows = read_language_file(language, "lexicon.txt").split("\n")
    return [row for row in rows if row and not row.startswith("#")]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("languages", nargs="*", default=list(languages()))
    action = parser.add_mutually_exclusive_group()
    action.add_argument("--check", action="store_true")
    action.add_argument("--seen", nargs="+", metavar=("LANGUAGE", "KEY"))
    action.add_argument("--po", metavar="LANGUAGE|FILE")
    action.add_argument("--pseudo", action="store_true", help=f"make the language {PSEUDO}")
    options = parser.parse_args()
    english = sources()
    if robot := english.get("robot"):
        robot.problems += check_robot(robot)
    if options.pseudo:
        make_pseudo(english)
        return 0
    problem_count = sum(
        print_problems(source_files(name, SOURCE_LANGUAGE)[0], catalogue.problems)
        for name, catalogue in english.items()
    )
    problem_count += print_problems(
        FOLDER / SOURCE_LANGUAGE / ABOUT_FILE,
        read_language(FOLDER / SOURCE_LANGUAGE / ABOUT_FILE).problems,
    )
    if problem_count:
        return 1
    if options.po:
        from tools import translators

        return translators.exchange(options.po, english)
    codes = options.seen[:1] if options.seen else options.languages
    for language in codes:
        if not re.fullmatch(r"[a-z]{2,3}(_[a-z0-9]+)*", language):
            print(f"{language}: this is no code of a language, such as fr or pt_br")
            return 1
        if (options.check or options.seen) and language not in languages():
            print(f"{language}: no such language. Try:  python -m tools.languages {language}")
            return 1
        if language != SOURCE_LANGUAGE:
            problem_count += update_language(
                language, english, options.check, options.seen and options.seen[1:]
            )
        for row in check_lexicon(language):
            print(f"languages/{language}/lexicon.txt: no row of a lexicon: {row}")
            problem_count += 1
    return 1 if problem_count else 0


def update_language(
    language: str, english: dict[str, Catalogue], is_check: bool, seen_patterns: list[str] | None
) -> int:
    """Update a language, and print its problems; return their number.

    `seen_patterns` are patterns of keys whose stale translations were reviewed; without them, no
    text is recorded as seen.
    """
    folder = FOLDER / language
    if not folder.is_dir() and not is_check:
        folder.mkdir()
        (folder / ABOUT_FILE).write_text(_heading(language), encoding="utf-8")
    translation = Translation(language, english)
    problem_count = 0
    if not is_check:
        for gone_key in translation.follow_moved_texts():
            print(f"languages/{language}/{gone_key}: its English text is gone, and so it goes")
        for unused_text in (
            translation.note_seen(seen_patterns) if seen_patterns is not None else []
        ):
            print(f"{language}: there is no translation with the key {unused_text}")
            problem_count += 1
        translation.write()
    return problem_count + report(translation)


def _heading(language: str) -> str:
    """Return the heading of a new language, which is nearly empty without Babel."""
    try:
        from tools.translators import language_facts
    except ImportError:
        return about_text(language, language, ("one", "other"), "n != 1")
    return about_text(*language_facts(language))


def missing_rows(entries: Iterable[Entry]) -> Iterator[tuple[int, str]]:
    """Yield the texts without a translation, with the line after which each belongs."""
    line = 1
    for entry in entries:
        if entry.translation:
            line = entry.line
        else:
            yield line, f"{entry.key} is missing: {entry.english}"


def report(translation: Translation) -> int:
    """Print the problems of a language, and its completeness; return the number of errors."""
    problem_count = sum(print_problems(path, problems) for path, problems in translation.problems())
    for path in sorted(translation.folder.glob("*.toml")):
        if path.name != ABOUT_FILE and path.stem not in translation.english:
            problem_count += print_problems(
                path, [(1, f"there is no {SOURCE_LANGUAGE}/{path.name}")]
            )
    entries: list[Entry] = []
    missing_count = stale_count = 0
    for name in translation.english:
        catalogue = translation.merge(name)
        path = translation.path(name)
        problem_count += print_problems(path, [*check_robot(catalogue)] if name == "robot" else [])
        expected_entries = [
            entry for entry in catalogue.entries.values() if entry.seen_hash or not entry.is_same
        ]
        entries += expected_entries
        stale_entries = [entry for entry in expected_entries if entry.is_stale]
        change_text = "its English text has changed, and so it is said in English"
        stale_count += print_problems(
            path,
            [
                (entry.line, f"{entry.key}: {change_text}: {entry.english}")
                for entry in stale_entries
            ],
        )
        if translation.language.is_complete:
            missing_count += print_problems(path, [*missing_rows(expected_entries)])
    new_entries = [entry for entry in entries if entry.seen_hash == UNKNOWN_HASH]
    if new_entries:
        print(f"{translation.code}: {len(new_entries)} texts are new. "
              "Note of which English texts they are:  "
              f"python -m tools.languages --seen {translation.code}")  # fmt: skip
    if stale_count:
        print(f"{translation.code}: {stale_count} texts are stale. "
              "Note of which English texts they are now:  "
              f"python -m tools.languages --seen {translation.code} KEY ...")  # fmt: skip
    translatable_entries = [entry for entry in entries if not entry.is_same]
    translated_count = sum(entry.is_translated for entry in translatable_entries)
    print(
        f"{translation.code}: "
        f"{translated_count} of {len(translatable_entries)} texts are translated"
    )
    return problem_count + (
        missing_count + stale_count + len(new_entries) if translation.language.is_complete else 0
    )


if __name__ == "__main__":
    sys.exit(main())
