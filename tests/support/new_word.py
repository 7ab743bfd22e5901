"""A word that the language could have: it stands for an instruction with fixed values."""

from __future__ import annotations

import shutil
from pathlib import Path

from tiniscript.base.languages import FOLDER
from tiniscript.base.words import ROLES, Word

HORN = Word("HORN", ROLES["fixed"], stands_for="BEEP(0.5, 440)")
SAID = {"en": "honks", "es": "toca la bocina"}


def with_texts(folder: Path) -> Path:
    """Return a copy of the languages that say what the word does."""
    shutil.copytree(FOLDER, folder, ignore=shutil.ignore_patterns("*.texts"))
    for language, said in SAID.items():
        with (folder / language / "studio.toml").open("a", encoding="utf-8") as file:
            file.write(f'"block/{HORN.text}" = "{{{HORN.text}}} {said}"\n')
    return folder
