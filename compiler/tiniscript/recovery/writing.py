"""Text of tokens again: as it was written, with its changes, or laid out anew; and of a place."""

from __future__ import annotations

import re
from collections.abc import Sequence

from tiniscript.base.source import Source, Span
from tiniscript.recovery.meanings import (
    Lexeme,
    lexemes,
    lexicon_meaning,
    make_token,
    plain,
    words_of,
)
from tiniscript.syntax.formatter import instruction_text
from tiniscript.syntax.lexer import NUMBER, WORD, Token

# The lexicon's names of dictated signs.
SIGN_OF_NAME = {"open": "(", "close": ")", "comma": ",", "semicolon": ";", "bar": "|"}
_SPOKEN_SIGN = re.compile(rf"\b{words_of('sign').replace('_', ' ')}\b")
_NAMED_LETTER = re.compile(rf"(?i)\b{words_of('spelt').replace('_', ' ')}(?=\s*\()")
MAX_BLOCK_CHARACTERS = 160  # characters of one that a message shows
PLAIN_SIGNS = str.maketrans("“”„‘’", '"""\'\'')
# Full-width signs of Chinese keyboards.
PLAIN_SIGNS |= {wide: wide - 0xFEE0 for wide in range(0xFF01, 0xFF5F)}
_INSTRUCTION = re.compile(r"[^;|{}]*")
_NOTE_START = re.compile(r"(?i)(?<!\bSI)(?<!\bSB)//")


def format_line(tokens: Sequence[Lexeme]) -> str:
    """Return a line as the formatter would write it."""
    line_tokens = [Token(token.kind, token.text, 0, 0) for token in tokens]
    return instruction_text(line_tokens) if line_tokens else ""


def as_written(tokens: Sequence[Lexeme]) -> str:
    """Return a line as it was written, with its own spaces if nothing was changed."""
    line, previous_token = "", make_token("(")
    for token in tokens:
        space = token.space
        if space is None:
            is_closed_up = token.text in (",", ")", ";", "(") or previous_token.text in (
                "(",
                "-",
                "|",
            )
            space = "" if is_closed_up else " "
        elif not space and {token.kind, previous_token.kind} <= {WORD, NUMBER}:
            space = " "
        if previous_token.text == "(" and previous_token.source is None:
            space = ""
        line += space + _source_text(token)
        previous_token = token
    return line


def _source_text(token: Lexeme) -> str:
    if token.source is None:
        return token.text
    if token.source.isascii() or token.kind is not WORD:
        return token.source
    plain_source = plain(token.source)
    return (
        token.text if token.source.isupper() or plain_source != token.text else plain_source.lower()
    )


def split_note(line: str) -> tuple[str, str]:
    """Return a line without its comment, and that with the space at the end of the line."""
    note = _NOTE_START.search(line) if "//" in line else None
    body = line[: note.start() if note else None].rstrip(" \t")
    return body, line[len(body) :]


def tokens_of(line: str) -> list[Lexeme]:
    """Return the tokens of a line without its comment."""
    return lexemes(split_note(line)[0])


def in_one_line(text: str) -> str:
    """Return the instructions of a text, laid out; or nothing if they are too long for a
    message."""
    parts = (format_line(tokens_of(line)).strip("; ") for line in text.split("\n"))
    joined_text = "; ".join(part for part in parts if part)
    return joined_text if len(joined_text) <= MAX_BLOCK_CHARACTERS else ""


def shorten(text: str) -> str:
    """Return text that fits into a message."""
    text = " ".join(text.split())
    return text if len(text) <= 40 else text[:37] + "..."


def instruction_at(span: Span, source: Source) -> Span:
    """Return the instruction around a place: between the separators of its line."""
    line_number, column = source.position(span.start)
    body = split_note(source.line_text(line_number))[0]
    match = next(
        match for match in _INSTRUCTION.finditer(body) if match.end() >= min(column - 1, len(body))
    )
    start = span.start - column + 1 + match.end() - len(match[0].lstrip())
    return Span(start, start + len(match[0].strip()))


def with_signs(line: str) -> str:
    """Return a line that was dictated with its signs: `F open bracket 2 comma 80 close bracket`.

    Words for brackets that are not opened and closed have another meaning.
    """
    plain_line = plain(line)
    if len(plain_line) != len(line):
        return line
    sign_matches = [*_SPOKEN_SIGN.finditer(plain_line)]
    sign_names = [_meaning(match[0], "sign") for match in sign_matches]
    has_bare_bracket = "bracket" in sign_names
    sign_names = _close_brackets(sign_names)
    has_setup = sign_names[:1] == ["bar"] and plain_line[: sign_matches[0].start()].strip() in (
        "SI",
        "SB",
    )
    names = " ".join(sign_names).split()
    open_count, closed_count = names.count("open"), names.count("close")
    if not closed_count <= open_count <= closed_count + has_bare_bracket or not (
        open_count or has_setup
    ):
        return line
    for match, sign_parts in zip(
        sign_matches[::-1], [part.split() for part in sign_names[::-1]], strict=True
    ):
        text_before, text_after = line[: match.start()].rstrip(), line[match.end() :].lstrip()
        sign = "".join(SIGN_OF_NAME[part] for part in sign_parts)
        line = f"{text_before}{sign}{' ' * (sign[-1] in ',;' and bool(text_after))}{text_after}"
    line += ")" * (line.count("(") - line.count(")"))
    return _NAMED_LETTER.sub(
        lambda match: lexicon_meaning(plain(match[0]).replace(" ", "_"), "spelt")[0], line
    )


def _meaning(words: str, kind: str) -> str:
    return lexicon_meaning(words.replace(" ", "_"), kind)[0]


def has_ambiguous_sign(line: str) -> bool:
    """Return whether a dictated line has text that may be another sign: `ve` is a letter and a
    word.
    """
    sign_names = [
        lexicon_meaning(match[0].replace(" ", "_"), "sign")[0]
        for match in _SPOKEN_SIGN.finditer(plain(line))
    ]
    return (
        "bracket" in sign_names
        or _NAMED_LETTER.search(_SPOKEN_SIGN.sub("(", plain(line))) is not None
    )


def spoken_signs(text: str) -> list[str]:
    """Return the names of signs in a text that is dictated with them, each once."""
    body = split_note(text)[0]
    if "\n" in text or with_signs(body) == body:
        return []
    return [
        *dict.fromkeys(
            body[slice(*match.span())].lower() for match in _SPOKEN_SIGN.finditer(plain(body))
        )
    ]


def _close_brackets(sign_names: Sequence[str]) -> list[str]:
    """Return signs in which brackets that the words do not mark as opening or closing alternate.

    One that is open at the end of its instruction is closed there.
    """
    closed_names: list[str] = []
    is_open = False
    for name in sign_names:
        name = ("close" if is_open else "open") if name == "bracket" else name
        is_unclosed = is_open and name == "semicolon" and "bracket" in sign_names
        closed_names.append("close semicolon" if is_unclosed else name)
        is_open = name == "open" or (is_open and name not in ("close", "semicolon"))
    return closed_names
