"""The words of a kit that give way: a program names something of its own with them.

Knows tokens, and no grammar beyond where a name gets its meaning, so that a text with mistakes has
its own words, too.
"""

from __future__ import annotations

from collections.abc import Sequence

from tiniscript.base.kit import KIT_WORDS_SINCE, Kit
from tiniscript.base.source import Source
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Diagnostic
from tiniscript.syntax.free_names import numbered_names
from tiniscript.syntax.lexer import END, NEWLINE, WORD, Token, scan


def kit_for_text(text: str, kit: Kit) -> Kit:
    """Return the kit as a program has it: without the words that have given way there."""
    return kit_for_tokens(scan(text).tokens, kit)


def kit_for_tokens(tokens: Sequence[Token], kit: Kit) -> Kit:
    """Return the kit as a program with these tokens has it."""
    later_names = {reading.name for reading in kit.readings}.difference(kit.names)
    given_words = later_names.intersection(own_words(tokens))
    return kit._replace(given_words=frozenset(given_words)) if given_words else kit


def report_given_way(tokens: Sequence[Token], kit: Kit, source: Source) -> list[Diagnostic]:
    """Return a warning for each word that has given way."""
    return [
        Diagnostic(codes.GIVES_WAY, token.span, {
            "name": name,
            "since": KIT_WORDS_SINCE[name],
            "other": next(numbered_names(source.text, name)),
        })
        for name, token in own_words(tokens).items()
        if name in kit.given_words
    ]  # fmt: skip


def own_words(tokens: Sequence[Token]) -> dict[str, Token]:
    """Return the younger words that a program names something with where they first appear."""
    seen_words: set[str] = set()
    token_of_word = {}
    begins_instruction, is_in_def, depth = True, False, 0
    for k, token in enumerate(tokens):
        kind, text = token.kind, token.text
        if kind is WORD and text in KIT_WORDS_SINCE and text not in seen_words:
            seen_words.add(text)
            is_named = tokens[k - 1].text == "DEF" if k else False
            is_set = (
                begins_instruction
                and tokens[k + 1].kind == "="
                and not _value_uses(text, tokens, k + 2)
            )
            if is_named or is_set or is_in_def:
                token_of_word[text] = token
        if kind == "(":
            depth += 1
            is_in_def = is_in_def or (depth == 1 and k > 1 and tokens[k - 2].text == "DEF")
        elif kind == ")":
            depth, is_in_def = max(depth - 1, 0), False
        elif kind == ";":
            depth, is_in_def = 0, False  # a bracket that is open there is a mistake
        begins_instruction = kind in (";", "|") or (kind is NEWLINE and not depth)
    return token_of_word


def _value_uses(name: str, tokens: Sequence[Token], k: int) -> bool:
    """Return whether the value that begins at a token uses a name."""
    depth = 0
    while tokens[k].kind not in (END, ";") and (depth or tokens[k].kind is not NEWLINE):
        if tokens[k].text == name:
            return True
        depth = max(depth + (tokens[k].kind == "(") - (tokens[k].kind == ")"), 0)
        k += 1
    return False
