"""Text of tokens again: as it was written, with its changes, or laid out anew; and of a place."""

from __future__ import annotations

import re
from collections.abc import Sequence

from tiniscript.base.source import Source, Span
from tiniscript.recovery.meanings import Lexeme, lexemes, lexicon_meaning, made, plain, words_of
from tiniscript.syntax.formatter import instruction_text
from tiniscript.syntax.lexer import NUMBER, WORD, Token

# What the lexicon calls the signs that somebody says.
SIGN_OF_NAME = {"open": "(", "close": ")", "comma": ",", "semicolon": ";", "bar": "|"}
_SPOKEN_SIGN = re.compile(rf"\b{words_of('sign').replace('_', ' ')}\b")
_NAMED_LETTER = re.compile(rf"(?i)\b{words_of('spelt').replace('_', ' ')}(?=\s*\()")
MOST_BLOCK_CHARACTERS = 160  # characters of one that a message shows
PLAIN_SIGNS = str.maketrans("“”„‘’", '"""\'\'')
PLAIN_SIGNS |= {wide: wide - 0xFEE0 for wide in range(0xFF01, 0xFF5F)}  # of Chinese keyboards
_INSTRUCTION = re.compile(r"[^;|{}]*")
_NOTE_START = re.compile(r"(?i)(?<!\bSI)(?<!\bSB)//")


def laid_out(tokens: Sequence[Lexeme]) -> str:
    """Return a line as the formatter would write it."""
    line = [Token(token.kind, token.text, 0, 0) for token in tokens]
    return instruction_text(line) if line else ""


def as_written(tokens: Sequence[Lexeme]) -> str:
    """Return a line as it was written, with its own spaces where nothing was changed."""
    line, before = "", made("(")
    for token in tokens:
        space = token.space
        if space is None:
            is_closed_up = token.text in (",", ")", ";", "(") or before.text in ("(", "-", "|")
            space = "" if is_closed_up else " "
        elif not space and {token.kind, before.kind} <= {WORD, NUMBER}:
            space = " "
        if before.text == "(" and before.source is None:
            space = ""
        line += space + _source(token)
        before = token
    return line


def _source(token: Lexeme) -> str:
    if token.source is None:
        return token.text
    if token.source.isascii() or token.kind is not WORD:
        return token.source
    as_it_was = plain(token.source)
    return token.text if token.source.isupper() or as_it_was != token.text else as_it_was.lower()


def without_note(line: str) -> tuple[str, str]:
    """Return a line without its comment, and that with the space at the end of the line."""
    note = _NOTE_START.search(line) if "//" in line else None
    body = line[: note.start() if note else None].rstrip(" \t")
    return body, line[len(body) :]


def tokens_of(line: str) -> list[Lexeme]:
    """Return the tokens of a line without its comment."""
    return lexemes(without_note(line)[0])


def in_one_line(text: str) -> str:
    """Return the instructions of a text, laid out; nothing where they are long for a message."""
    parts = (laid_out(tokens_of(line)).strip("; ") for line in text.split("\n"))
    joined_text = "; ".join(part for part in parts if part)
    return joined_text if len(joined_text) <= MOST_BLOCK_CHARACTERS else ""


def shortened(text: str) -> str:
    """Return text that fits into a message."""
    text = " ".join(text.split())
    return text if len(text) <= 40 else text[:37] + "..."


def instruction_at(span: Span, source: Source) -> Span:
    """Return the instruction around a place: between the separators of its line."""
    row, column = source.position(span.start)
    body = without_note(source.line_text(row))[0]
    own = next(it for it in _INSTRUCTION.finditer(body) if it.end() >= min(column - 1, len(body)))
    begin = span.start - column + 1 + own.end() - len(own[0].lstrip())
    return Span(begin, begin + len(own[0].strip()))


def with_signs(line: str) -> str:
    """Return a line that was dictated with its signs: `F open bracket 2 comma 80 close bracket`.

    One whose brackets nobody opens and closes in words says something else by them.
    """
    text = plain(line)
    if len(text) != len(line):
        return line
    sign_matches = [*_SPOKEN_SIGN.finditer(text)]
    sign_names = [_meaning(match[0], "sign") for match in sign_matches]
    is_bare = "bracket" in sign_names
    sign_names = _with_closed(sign_names)
    is_begun = sign_names[:1] == ["bar"] and text[: sign_matches[0].start()].strip() in ("SI", "SB")
    names = " ".join(sign_names).split()
    open_count, closed_count = names.count("open"), names.count("close")
    if not closed_count <= open_count <= closed_count + is_bare or not (open_count or is_begun):
        return line
    for match, names in zip(
        sign_matches[::-1], [name.split() for name in sign_names[::-1]], strict=True
    ):
        before, after = line[: match.start()].rstrip(), line[match.end() :].lstrip()
        sign = "".join(SIGN_OF_NAME[name] for name in names)
        line = f"{before}{sign}{' ' * (sign[-1] in ',;' and bool(after))}{after}"
    line += ")" * (line.count("(") - line.count(")"))
    return _NAMED_LETTER.sub(
        lambda it: lexicon_meaning(plain(it[0]).replace(" ", "_"), "spelt")[0], line
    )


def _meaning(words: str, kind: str) -> str:
    return lexicon_meaning(words.replace(" ", "_"), kind)[0]


def is_guessed(line: str) -> bool:
    """Whether a dictated line has what may mean another sign: `ve` is a letter and a word."""
    kinds = [
        lexicon_meaning(it[0].replace(" ", "_"), "sign")[0]
        for it in _SPOKEN_SIGN.finditer(plain(line))
    ]
    return (
        "bracket" in kinds or _NAMED_LETTER.search(_SPOKEN_SIGN.sub("(", plain(line))) is not None
    )


def spoken_signs(text: str) -> list[str]:
    """Return the names of signs in a text that is dictated with them, each once."""
    body = without_note(text)[0]
    if "\n" in text or with_signs(body) == body:
        return []
    return [
        *dict.fromkeys(body[slice(*it.span())].lower() for it in _SPOKEN_SIGN.finditer(plain(body)))
    ]


def _with_closed(sign_names: Sequence[str]) -> list[str]:
    """Return signs in which a bracket that nobody says opens or closes does so in turn.

    One that is open at the end of its instruction is closed there.
    """
    result: list[str] = []
    is_open = False
    for name in sign_names:
        name = ("close" if is_open else "open") if name == "bracket" else name
        is_left = is_open and name == "semicolon" and "bracket" in sign_names
        result.append("close semicolon" if is_left else name)
        is_open = name == "open" or (is_open and name not in ("close", "semicolon"))
    return result
