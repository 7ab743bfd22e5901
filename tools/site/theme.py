"""Replaces the English texts of the site's theme by those of the catalogue."""

from __future__ import annotations

import html
import re
from pathlib import Path

from tiniscript.base.languages import find_text

# A whole text between two tags, or a label.
THEME_TEXT = re.compile(r'(>\s*|(?:aria-label|title)=")([^<>"]*?)(\s*<|")')


def translate(folder: Path, language: str) -> None:
    """Translate the theme's texts on the pages in a folder."""

    def translate_match(match: re.Match[str]) -> str:
        message = find_text("documents", f"theme/{html.unescape(match[2])}", language)
        return f"{match[1]}{html.escape(message)}{match[3]}" if message else match[0]

    for path in folder.rglob("*.html"):
        text = path.read_text(encoding="utf-8")
        path.write_text(THEME_TEXT.sub(translate_match, text), encoding="utf-8")
