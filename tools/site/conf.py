"""How Sphinx makes one half of the site; `tools/builds/site.py` says which, as `-D language`."""

from __future__ import annotations

import json
from pathlib import Path

from pygments.lexers.python import PythonLexer
from pygments.lexers.special import TextLexer
from sphinx.application import Sphinx
from sphinx.search.en import SearchEnglish
from sphinx.search.es import SearchSpanish

from tiniscript import __version__
from tiniscript.words import WORDS
from tools.site.lexer import TiniScriptLexer

project = "TiniScript"
author = "the TiniScript developers"
project_copyright = author
version = release = __version__
extensions = ["myst_parser"]
root_doc = "index"
myst_heading_anchors = 6
myst_links_external_new_tab = False
nitpicky = True
suppress_warnings = ["myst.header"]  # a page of a lesson begins where its author wants it to
html_theme = "furo"
html_title = "TiniScript"
html_static_path = ["static"]
html_css_files = ["site.css"]
html_copy_source = False
html_show_sphinx = False
html_permalinks_icon = "#"
html_theme_options = {"navigation_with_keys": False}
templates_path = ["templates"]
html_sidebars = {
    "**": [
        "sidebar/brand.html",
        "halves.html",
        "sidebar/search.html",
        "sidebar/scroll-start.html",
        "sidebar/navigation.html",
        "sidebar/scroll-end.html",
    ]
}
# Fences that show what a robot says or does: nothing in them is coloured.
PLAIN = ("output", "robot", "senses", "terminal", "link", "bytecode", "plain", "mistake", "warning",
         "line")  # fmt: skip


HALF = json.loads((Path(__file__).parent / "half.json").read_text(encoding="utf-8"))


def lead_to_the_other_half(
    app: Sphinx, name: str, template: str, context: dict[str, object], tree: object
) -> None:
    """Tell a page where it is in the other language, and where the studio is."""
    up = "../" * (name.count("/") + 1)
    there = name if name in HALF["both"] else "index"
    context["other_address"] = f"{up}{HALF['other']}/{there}.html"
    context["other_language"] = HALF["other"]
    context["other_name"] = HALF["other_name"]
    context["has_studio"] = HALF["has_studio"]
    context["studio_address"] = f"{up}studio/index.html"
    context["moved"] = HALF["moved"].get(name, {})


def find_words_of_the_language() -> None:
    """Have the search find IF, UNTIL and SI, too: words that it leaves out as too common."""
    ours = {word.lower() for word in WORDS}
    for language in (SearchEnglish, SearchSpanish):
        language.stopwords = frozenset(language.stopwords) - ours


def setup(app: Sphinx) -> None:
    find_words_of_the_language()
    app.connect("html-page-context", lead_to_the_other_half)
    app.add_lexer("tiniscript", TiniScriptLexer)
    app.add_lexer("verifier", PythonLexer)
    for name in PLAIN:
        app.add_lexer(name, TextLexer)
