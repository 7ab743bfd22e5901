"""A word that the language could have: it stands for an instruction with fixed values."""

from __future__ import annotations

from tiniscript.base.words import Word

HORN = Word("HORN", "fixed", stands_for="BEEP(0.5, 440)", says=("honks", "toca la bocina"))
