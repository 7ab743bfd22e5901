"""Brings all catalogues in step with the English ones: `python -m tools.languages`.

The names in the package's `.toml` files are English texts of the catalogue `names`. What is new
gets an empty place, what is gone goes, and the translation of a text whose English has
changed is marked as fuzzy: it is not used until somebody has looked at it. With codes, `pt fr`, it
makes their folders. `--check` writes nothing, and says what is wrong and how much is translated.
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

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "compiler"))

from tiniscript.base.catalogue_file import Catalogue, Entry, load, written
from tiniscript.base.languages import FOLDER, SOURCE, languages, table
from tiniscript.base.words import WORDS
from tiniscript.diagnostics.rendering import examples
from tiniscript.recovery.concepts import plain

PSEUDO = "qps"  # by custom: no language has this code
ROBOT_SIGNS = 40
ACCENTS = str.maketrans("aeiouncAEIOU", "àéîõüñçÀÉÎÕÜ")


def sources() -> dict[str, Catalogue]:
    """Return the English catalogues by name; that of `names` is nowhere but in TOML files.

    Beside a message stands the wrong program of `diagnostics/examples.toml`.
    """
    found = {path.stem: load(path) for path in (FOLDER / SOURCE).glob("*.po")}
    programs = examples(SOURCE)
    for entry in found["messages"].entries.values():
        wrong = programs.get(entry.key.partition("/")[0], {}).get("wrong", "")
        entry.notes = [f"wrong: {row}" for row in wrong.strip().splitlines()] or entry.notes
    return dict(sorted({**found, "names": names()}.items()))


def names() -> Catalogue:
    """Return the catalogue of what is said in the package's TOML, each text once."""
    made = Catalogue(load(FOLDER / SOURCE / "command.po").head)
    for folder in ("robots", "virtual/worlds", "lessons", "diagnostics"):
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
    """Return a catalogue with the texts of the English one, and the translations that it has.

    Other languages lack what has no words.
    """
    head = own.head or re.sub(
        r"^(Language|X-Name): .*$", rf"\1: {language}", source.head, flags=re.M
    )
    made = Catalogue(head)
    entries = {
        at: each for at, each in source.entries.items() if language == SOURCE or not each.is_gap
    }
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

    That one has the same key, or the same English text under another key.
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
    return found


def _likeness(one: str, other: str) -> float:
    return SequenceMatcher(a=one, b=other).ratio()


def pseudo(source: Catalogue) -> Catalogue:
    """Return a catalogue whose texts are the English ones, a third longer and with accents."""
    head = re.sub(r"^(Language|X-Name): .*$", rf"\1: {PSEUDO}", source.head, flags=re.M)
    made = Catalogue(head)
    for at, entry in source.entries.items():
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
        for said in entry.said:
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
    if options.pseudo:
        (FOLDER / PSEUDO).mkdir(exist_ok=True)
        for name, source in sources().items():
            target = FOLDER / PSEUDO / f"{name}.po"
            target.write_text(written(pseudo(source)), encoding="utf-8")
        return 0
    wrong = 0
    for language in options.languages:
        done = every = 0
        for name, source in sources().items():
            target = FOLDER / language / f"{name}.po"
            own = load(target)
            made = in_step(source, own, language)
            if name == "robot":
                own.problems += check_robot(own)
            for line, problem in own.problems:
                print(f"{target.relative_to(ROOT)}:{line}: {problem}")
            wrong += len(own.problems)
            done += sum(entry.is_translated for entry in made.entries.values())
            every += len(made.entries)
            if not options.check and not own.problems and (language, name) != (SOURCE, "names"):
                target.parent.mkdir(exist_ok=True)
                target.write_text(written(made, language == SOURCE), encoding="utf-8")
        for row in check_lexicon(language):
            print(f"languages/{language}/lexicon.txt: no row of a lexicon: {row}")
            wrong += 1
        if language != SOURCE:
            print(f"{language}: {done} of {every} texts are translated")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
