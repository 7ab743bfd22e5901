"""Words that the language could have: they stand for instructions, two of them with values."""

from __future__ import annotations

import shutil
from pathlib import Path

from tiniscript.base.languages import FOLDER
from tiniscript.base.words import ROLES, SECONDS, Argument, Word

HORN = Word("HORN", ROLES["fixed"], stands_for="BEEP(0.5, 440)")
SAID = {"en": "honks", "es": "toca la bocina"}
TIMES = Argument("n", "", 1000, 9000, "3")
WIGGLE = Word("WIGGLE", ROLES["fixed"], (TIMES,), "LOOP(N);L(0.2, 60);R(0.2, 60);END_LOOP")
DANCE = Word("DANCE", ROLES["fixed"], (SECONDS, TIMES), "BEEP(SECONDS, 440);HORN;WIGGLE(N)")


def with_texts(folder: Path) -> Path:
    """Return a copy of the languages that say what the word does."""
    shutil.copytree(FOLDER, folder, ignore=shutil.ignore_patterns("*.texts"))
    for language, said in SAID.items():
        with (folder / language / "studio.toml").open("a", encoding="utf-8") as file:
            file.write(f'"block/{HORN.text}" = "{{{HORN.text}}} {said}"\n')
    return folder
