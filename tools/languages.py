"""Brings all catalogues in step with the English texts: `python -m tools.languages`.

These are in `languages/en/*.toml`, those of `names` in other `.toml` files of the package. What is
new gets an empty place, what is gone goes, and the translation of a text whose English has changed
is marked as fuzzy: it is not used until somebody has looked at it. With codes, `pt fr`, it makes
their folders. `--check` writes nothing, and says what is wrong and how much is translated.
`--pseudo` makes a language that shows where longer texts do not fit.
"""

from __future__ import annotations

import argparse
import re
import sys
from collections.abc import Iterator, Mapping
from difflib import SequenceMatcher
from pathlib import Path

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib


from tiniscript.base import catalogue_source
from tiniscript.base.catalogue_file import Catalogue, Entry, load, written
from tiniscript.base.languages import FOLDER, SOURCE, files, languages, table
from tiniscript.base.words import WORDS
from tiniscript.diagnostics.codes import CODES
from tiniscript.recovery.concepts import plain

PSEUDO = "qps"  # by custom: no language has this code
ROBOT_SIGNS = 40
ACCENTS = str.maketrans("aeiouncAEIOU", "àéîõüñçÀÉÎÕÜ")


def sources() -> dict[str, Catalogue]:
    """Return the English catalogues by name.

    Beside a message, and what to try, stands the wrong program of its code: beside the last text,
    which is the one without a special case.
    """
    found = {path.stem: catalogue_source.load(path) for path in (FOLDER / SOURCE).glob("*.toml")}
    lasts = {each.key: each for each in found["messages"].entries.values()}
    programs = {key: each.english.splitlines() for key, each in lasts.items()}
    for key, entry in lasts.items():
        code, _, part = key.partition("/")
        if code in CODES and part in ("message", "try"):
            entry.notes = [f"wrong: {row}" for row in programs.get(f"{code}/wrong", [])]
    return dict(sorted({**found, "names": names()}.items()))


def names() -> Catalogue:
    """Return the catalogue of what is said in other TOML files of the package, each text once."""
    made = Catalogue(catalogue_source.HEAD)
    for folder in ("robots", "virtual/worlds", "lessons"):
        for path in sorted((FOLDER.parent / folder).rglob("*.toml")):
            place = path.relative_to(FOLDER.parent).as_posix()
            for said in _said_in(tomllib.loads(path.read_text(encoding="utf-8"))):
                made.entries.setdefault((said, said), Entry(said, said, notes=[place]))
    return made


def _said_in(value: object) -> Iterator[str]:
    """Yield each text that stands in English in a TOML file, in a row `en` or a table `en`."""
    if isinstance(value, dict):
        for key, each in value.items():
            said = each.values() if isinstance(each, dict) else [each]
            yield from said if key == SOURCE else _said_in(each)
    elif isinstance(value, list):
        for each in value:
            yield from _said_in(each)


def in_step(source: Catalogue, own: Catalogue, language: str) -> Catalogue:
    """Return a catalogue with the English texts that have words, and its own translations."""
    head = own.head or re.sub(
        r"^(Language|X-Name): .*$", rf"\1: {language}", source.head, flags=re.M
    )
    made = Catalogue(head)
    entries = {at: each for at, each in source.entries.items() if not each.is_same}
    olds = _before(entries, own)
    for at, entry in entries.items():
        old = olds.get(at, entry)
        has_changed = (old.at, old.plural) != (at, entry.plural)
        is_fuzzy = any(old.said) and (old.is_fuzzy or has_changed)
        said = old.said if bool(old.plural) == bool(entry.plural) else []
        made.entries[at] = Entry(*at, entry.plural, said, entry.notes, is_fuzzy)
    return made


def _before(
    source: Mapping[tuple[str, str], Entry], own: Catalogue
) -> dict[tuple[str, str], Entry]:
    """Return what each text was before: itself, else what is gone and most like it.

    That one has the same key, or the same English text under another key. A text that is asked
    for at another key than before has what is there for these words.
    """
    found = {at: own.entries[at] for at in source if at in own.entries}
    for entry in own.entries.values():
        if entry.at in found or not any(entry.said):
            continue
        new = [at for at in source if at not in found]
        places = [at for at in new if at[0] == entry.key]
        places = places or [at for at in new if at[1] == entry.english]
        if places:
            found[max(places, key=lambda at: _likeness(at[1], entry.english))] = entry
    by_words = {each.english: each for each in own.entries.values() if any(each.said)}
    return {**{at: by_words[at[1]] for at in source if at[1] in by_words}, **found}


def _likeness(one: str, other: str) -> float:
    return SequenceMatcher(a=one, b=other).ratio()


def pseudo(source: Catalogue) -> Catalogue:
    """Return a catalogue whose texts are the English ones, a third longer and with accents."""
    head = re.sub(r"^(Language|X-Name): .*$", rf"\1: {PSEUDO}", source.head, flags=re.M)
    made = Catalogue(head)
    for at, entry in source.entries.items():
        if entry.is_same:
            continue
        forms = [_longer(each) for each in (entry.english, entry.plural) if each]
        made.entries[at] = Entry(*at, entry.plural, forms, entry.notes)
    return made


def _longer(text: str) -> str:
    """Return a text with accents outside of its gaps, and with more words in its last line."""
    parts = re.split(r"(\{[^{}]*\}|`[^`]*`)", text)
    parts[::2] = [each.translate(ACCENTS) for each in parts[::2]]
    more = "ñandú " * (len(text.rpartition("\n")[2]) // 3 // 6 + 1)
    return f"{''.join(parts)} {more}".rstrip()


def check_robot(own: Catalogue) -> Iterator[tuple[int, str]]:
    """What a robot cannot say in its few bytes."""
    for entry in own.entries.values():
        for said in entry.said or [entry.english]:
            if not said.isascii() or len(said) > ROBOT_SIGNS:
                yield entry.line, f"a robot says at most {ROBOT_SIGNS} signs, in ASCII: {said}"


def check_lexicon(language: str) -> Iterator[str]:
    """Rows of a lexicon without a meaning that the English one has, or with other than capitals."""
    known = {row.split()[0] for row in _rows(SOURCE)} | {"short"} | {*WORDS}
    for row in _rows(language):
        meaning, bar, words = row.partition("|")
        if not bar or not known.issuperset(meaning.split()[:1]) or plain(words) != words:
            yield row


def _rows(language: str) -> list[str]:
    rows = table(language, "lexicon.txt").split("\n")
    return [row for row in rows if row and not row.startswith("#")]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("languages", nargs="*", default=list(languages()))
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--pseudo", action="store_true", help=f"make the language {PSEUDO}")
    options = parser.parse_args()
    english = sources()
    if options.pseudo:
        (FOLDER / PSEUDO).mkdir(exist_ok=True)
        for name, source in english.items():
            target = FOLDER / PSEUDO / f"{name}.po"
            target.write_text(written(pseudo(source)), encoding="utf-8")
        return 0
    english["robot"].problems += check_robot(english["robot"])
    wrong = sum(tell(files(name, SOURCE)[0], source) for name, source in english.items())
    for language in options.languages:
        done = every = 0
        for name, source in english.items():
            if language == SOURCE or source.problems:
                continue
            target = files(name, language)[1]
            own = load(target)
            made = in_step(source, own, language)
            if name == "robot":
                own.problems += check_robot(own)
            wrong += tell(target, own)
            done += sum(entry.is_translated for entry in made.entries.values())
            every += len(made.entries)
            if not options.check and not own.problems:
                target.parent.mkdir(exist_ok=True)
                target.write_text(written(made), encoding="utf-8")
        for row in check_lexicon(language):
            print(f"languages/{language}/lexicon.txt: no row of a lexicon: {row}")
            wrong += 1
        if language != SOURCE:
            print(f"{language}: {done} of {every} texts are translated")
    return 1 if wrong else 0


def tell(path: Path, found: Catalogue) -> int:
    """Print what is wrong with a file, and return how much that is."""
    for line, problem in found.problems:
        print(f"{path.relative_to(FOLDER.parent)}:{line}: {problem}")
    return len(found.problems)


if __name__ == "__main__":
    sys.exit(main())
