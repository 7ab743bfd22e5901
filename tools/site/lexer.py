"""Colours TiniScript on the site's pages, for Pygments.

Knows the tables of words and units. A fence that shows a program with something wrong is coloured
like one that is right.
"""

from __future__ import annotations

from typing import ClassVar

from pygments.lexer import RegexLexer, words
from pygments.token import Comment, Keyword, Name, Number, Operator, Punctuation, String, Text

from tiniscript.base.words import WORDS

_GRAMMAR = ("block", "arm", "end", "break", "operator", "alias")


def _with_role(*roles: str) -> tuple[str, ...]:
    return tuple(word.text for word in WORDS.values() if word.role.name in roles)


class TiniScriptLexer(RegexLexer):  # type: ignore[misc] # Pygments has no types
    """A program, or a line of one."""

    name = "TiniScript"
    aliases: ClassVar[list[str]] = ["tiniscript"]
    flags = 2  # re.IGNORECASE
    tokens: ClassVar[dict[str, list[tuple[object, ...]]]] = {
        "root": [
            (r"\s+", Text),
            (r"//.*?$", Comment.Single),
            (r"~[0-9A-F]{8}", String),
            (r"\d+(?:\.\d+)?", Number),
            (words(_with_role("setup"), suffix=r"\b"), Keyword.Namespace),
            (words(_with_role(*_GRAMMAR), suffix=r"\b"), Keyword),
            (words(tuple(WORDS), suffix=r"\b"), Name.Builtin),
            (r"[A-Z_]\w*", Name),
            (r"[-+*/%<>=!&|]+", Operator),
            (r"[();,:]", Punctuation),
            (r".", Text),
        ]
    }
