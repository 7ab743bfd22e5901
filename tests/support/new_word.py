"""Words that the language could have: they stand for instructions, three of them with values.

LAMP stands for none and has a role of its own, and so do TOOT, which is like BEEP, and CHEEP, which
goes on at once.
"""

from __future__ import annotations

import shutil
from pathlib import Path

from tiniscript.base.languages import FOLDER
from tiniscript.base.words import HERTZ, POWER, ROLES, SECONDS, Argument, Role, Word

HORN = Word("HORN", ROLES["fixed"], expansion="BEEP(0.5, 440)")
WORD_TEXTS = {"en": "honks", "es": "toca la bocina"}
TIMES = Argument("n", "", 1000, 9000, "3")
WIGGLE = Word("WIGGLE", ROLES["fixed"], (TIMES,), "LOOP(N);L(0.2, 60);R(0.2, 60);END_LOOP")
# Values of its own kind, one of which is needed twice, so that it goes into a variable.
SHAKE = Word(
    "SHAKE", ROLES["fixed"], (Argument("beats", "beats", 1000, 20_000, "4"), POWER),
    "SHAKE_POWER = POWER;LOOP(BEATS);L(0.2, SHAKE_POWER);R(0.2, SHAKE_POWER);END_LOOP",
)  # fmt: skip
DANCE = Word("DANCE", ROLES["fixed"], (SECONDS, TIMES), "BEEP(SECONDS, 440);HORN;WIGGLE(N)")
LAMP = Word("LAMP", Role("lamp", is_instruction=True), (POWER._replace(sample="50"),))
TOOT = Word("TOOT", Role("toot", is_instruction=True, takes_time=True), (SECONDS, HERTZ))
CHEEP = Word("CHEEP", Role("cheep", is_instruction=True), (SECONDS, HERTZ))


def with_texts(folder: Path) -> Path:
    """Return a copy of the languages that describe the word."""
    shutil.copytree(FOLDER, folder, ignore=shutil.ignore_patterns("*.texts"))
    for language, text in WORD_TEXTS.items():
        with (folder / language / "studio.toml").open("a", encoding="utf-8") as file:
            for word in (HORN, SHAKE, LAMP):
                file.write(f'"block/{word.text}" = "{{{word.text}}} {text}"\n')
    return folder
