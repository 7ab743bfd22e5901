"""Documents that are not committed: they are made for the site and for a USB stick.

Knows which documents a person reads in the repository: of each robot the English page of its
wiring, and the drawings that some document shows. The command's pages, and wiring in other
languages, are the output of `tsc help` and `tsc firmware --wiring`.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import partial

from tiniscript.base.languages import SOURCE_LANGUAGE
from tools import ROOT
from tools.generate.command_pages import DOCUMENTED, page
from tools.generate.documents import table
from tools.generate.wiring_pages import wiring_pages
from tools.site.documents import name_in

COMMAND = "python -m tools.generate"
DocumentMakers = dict[str, Callable[[], str]]


def makers_of_kept() -> DocumentMakers:
    """Return the makers of these stored documents, by name in a clone."""
    makers = wiring_pages(COMMAND, is_kept=True)
    pages = {
        name: make for name, make in makers.items() if name.startswith(f"docs/{SOURCE_LANGUAGE}/")
    }
    shown_drawings = _shown_drawings() | {
        drawing for make in pages.values() for drawing in _drawings(make())
    }
    return pages | {name: make for name, make in makers.items() if name in shown_drawings}


def build_all() -> dict[str, str]:
    """Return the documents of a site, by the names that they would have in a clone."""
    file_makers = {
        name_in(language, "docs/en/command.md"): partial(page, language, COMMAND, table)
        for language in DOCUMENTED
    }
    return {name: make() for name, make in (file_makers | wiring_pages(COMMAND)).items()}


def _shown_drawings() -> set[str]:
    """Return the drawings that the documents of a clone show, but for pages of wiring."""
    return {
        drawing
        for path in ROOT.glob("docs/*/*.md")
        for drawing in _drawings(path.read_text(encoding="utf-8"))
    }


def _drawings(text: str) -> list[str]:
    return [f"docs/{name}" for name in re.findall(r"\.\./(pictures/wiring/[\w.]+)\)", text)]
