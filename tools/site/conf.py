"""The Sphinx configuration of a language of the site; `tools/builds/site.py` sets `-D language`."""

from __future__ import annotations

import gc
import json
from importlib import import_module
from pathlib import Path
from typing import Any

from pygments.lexers.python import PythonLexer
from pygments.lexers.special import TextLexer
from sphinx.application import Sphinx
from sphinx.search import languages as searches

from tiniscript import __version__
from tiniscript.base.words import WORDS
from tools.site.lexer import TiniScriptLexer

gc.disable()  # a fifth of the time, for 160 MB that are there

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
        "languages.html",
        "sidebar/search.html",
        "sidebar/scroll-start.html",
        "sidebar/navigation.html",
        "sidebar/scroll-end.html",
    ]
}
# Fences with a robot's output or actions, which are not coloured.
PLAIN_FENCES = (
    "output",
    "robot",
    "senses",
    "terminal",
    "link",
    "bytecode",
    "plain",
    "mistake",
    "warning",
    "line",
    "mermaid",
)


SITE_DATA = json.loads((Path(__file__).parent / "settings.json").read_text(encoding="utf-8"))


def add_language_links(
    app: Sphinx, name: str, template: str, context: dict[str, object], tree: object
) -> None:
    """Give a page its links to the other languages, and to the studio."""
    way_to_root = "../" * (name.count("/") + 1)
    languages_there = SITE_DATA["pages"].get(name, [])
    context["others"] = [
        (
            language,
            language_name,
            f"{way_to_root}{language}/{name if language in languages_there else 'index'}.html",
        )
        for language, language_name in SITE_DATA["others"].items()
    ]
    context["has_studio"] = SITE_DATA["has_studio"]
    context["studio_address"] = f"{way_to_root}studio/index.html"


def find_words_of_the_language() -> None:
    """Make the search find IF, UNTIL and SI, which it omits as too common."""
    own_words = {word.lower() for word in WORDS}
    for class_or_name in searches.values():  # a class, or where it is
        search: Any = class_or_name
        if isinstance(class_or_name, str):
            module, _, name = class_or_name.rpartition(".")
            search = getattr(import_module(module), name)
        search.stopwords = frozenset(search.stopwords) - own_words


def setup(app: Sphinx) -> None:
    find_words_of_the_language()
    app.connect("html-page-context", add_language_links)
    app.add_lexer("tiniscript", TiniScriptLexer)
    app.add_lexer("verifier", PythonLexer)
    for name in PLAIN_FENCES:
        app.add_lexer(name, TextLexer)
