"""Brings all catalogues in step with the English ones: `python -m tools.languages`.

What is new gets an empty place, what is gone goes, and the translation of a text whose English has
changed is marked as fuzzy: it is not used until somebody has looked at it. With codes, `pt fr`, it
makes their folders. `--check` writes nothing, and says what is wrong and how much is translated.
"""

from __future__ import annotations

import argparse
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "compiler"))

from tiniscript.languages import FOLDER, SOURCE, languages
from tiniscript.languages.catalogue_file import Catalogue, Entry, load, written


def in_step(source: Catalogue, own: Catalogue, language: str) -> Catalogue:
    """Return a catalogue with the texts of the English one, and the translations that it has."""
    head = own.head or re.sub(
        r"^(Language|X-Name): .*$", rf"\1: {language}", source.head, flags=re.M
    )
    made = Catalogue(head)
    for key, entry in source.entries.items():
        old = own.entries.get(key, entry)
        has_changed = (old.english, old.plural) != (entry.english, entry.plural)
        is_fuzzy = any(old.said) and (old.is_fuzzy or has_changed)
        said = old.said if bool(old.plural) == bool(entry.plural) else []
        made.entries[key] = Entry(key, entry.english, entry.plural, said, entry.notes, is_fuzzy)
    return made


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("languages", nargs="*", default=list(languages()))
    parser.add_argument("--check", action="store_true")
    options = parser.parse_args()
    wrong = 0
    for language in options.languages:
        done = every = 0
        for path in sorted((FOLDER / SOURCE).glob("*.po")):
            target = FOLDER / language / path.name
            own = load(target)
            made = in_step(load(path), own, language)
            for line, problem in own.problems:
                print(f"{target.relative_to(ROOT)}:{line}: {problem}")
            wrong += len(own.problems)
            done += sum(entry.is_translated for entry in made.entries.values())
            every += len(made.entries)
            if not options.check and not own.problems:
                target.parent.mkdir(exist_ok=True)
                target.write_text(written(made), encoding="utf-8")
        if language != SOURCE:
            print(f"{language}: {done} of {every} texts are translated")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
