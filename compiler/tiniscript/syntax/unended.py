"""Where a block without an end probably ends.

Knows the block and the lines of the text. Reports nothing.
"""

from __future__ import annotations

import re
from itertools import takewhile

from tiniscript.source import Source
from tiniscript.syntax.blocks import ENDS, Block
from tiniscript.syntax.ends import ARMS
from tiniscript.words import WORDS

_WORD = re.compile("[A-Za-z_]+")
_IF = re.compile(r"(?i)\s*(?:if|si)\b(?!\s+no\b)")
_UNREAD = re.compile(r"[{}]|[)\w]\s+\w")  # what shows that more than the end is missing
_FARTHEST = 400  # lines that are looked at
_LONGEST = 200  # characters behind a header that are looked at and said: a text may be one line


def where_it_ends(block: Block, source: Source) -> dict[str, str]:
    """Return the line that a block probably ends with, its text, or what else there is to say.

    Lines that stand further in than the header belong to it; where none does, all that follow.
    `only` is what stands behind the header on its line, `behind` and `all` where no line follows,
    and `head` a header with nothing behind it.
    """
    head = source.position(block.span.start)[0]
    last = source.position(len(source.text))[0]
    rows = [(k, source.line_text(k)) for k in range(head, min(last, head + _FARTHEST) + 1)]
    first, *rest = [(k, row) for k, row in rows if row.strip()] or [(head, "")]
    within = _within(first[1], rest)
    if block.word == "IF" and not within:  # the next IF beside it is no part of it
        beside = (i for i, (_, row) in enumerate(rest) if i and _IF.match(row))
        rest = rest[: next(beside, len(rest))]
    if block.name is not None:  # a DEF that calls itself: the call is the program's
        for i, (_, row) in enumerate(rest):
            if row.split("//")[0].strip(" \t;()").upper() == block.name.text:
                rest = rest[:i] or [(head, first[1])]
                break
    behind = _behind(block, source)
    on_line = behind.split("//")[0].strip(" \t\r;:{")
    if len(behind) == _LONGEST and block.name is None and not within:
        return {"line": "", "last": ""}
    if on_line and not within and block.name is None:  # `IF(c);S` may be all of it
        return _on_its_line(block, on_line, is_last=not rest)
    if not rest:
        is_empty = not on_line and block.name is None and not block.here
        return {"line": "", "last": "", "head": source[block.span] if is_empty else ""}
    line, text = (within or rest)[-1]
    return {"line": str(line), "last": text.strip()}


def open_above(block: Block, source: Source, end: int) -> tuple[int, str, str]:
    """Return the line of the header of the block that has no end before `end`, the offset of
    another block's end; and the line it probably ends with, and its text, if that is not the last
    one before `end`. By how far in the lines stand, or else it is `block`."""
    line = source.position(block.header.start)[0]
    head = source.position(block.span.start)[0]
    last = min(source.position(end)[0], head + _FARTHEST + 1)
    rest = [(k, row) for k in range(head + 1, last) if (row := source.line_text(k)).strip()]
    within = _within(source.line_text(head), rest)
    if _behind(block, source).strip(" \t\r;:{") or not within or len(within) == len(rest):
        return line, "", ""
    if _is_end(rest[len(within)][1], block.word):  # one further in has taken its end
        for i, (k, row) in enumerate(within):
            inner = _within(row, within[i + 1 :])
            closes = within[i + 1 + len(inner) :][:1]
            if inner and _begins(row, block.word) and not _closes(closes, row, block.word):
                return k, str(inner[-1][0]), inner[-1][1].strip()
        return line, "", ""
    return line, str(within[-1][0]), within[-1][1].strip()


def _behind(block: Block, source: Source) -> str:
    """Return what stands behind the header of a block on its line, as far as it is looked at."""
    return source.text[block.span.end : block.span.end + _LONGEST].split("\n", 1)[0]


def _first_word(row: str) -> str:
    found = _WORD.match(row.strip())
    return found[0].upper() if found else ""


def _begins(row: str, word: str) -> bool:
    return _first_word(row) in ((word, *ARMS) if word == "IF" else (word,))


def _is_end(row: str, word: str) -> bool:
    return ENDS.get(_first_word(row)) == word


def _closes(rows: list[tuple[int, str]], header: str, word: str) -> bool:
    """Whether the row that follows the body of a header is its end, or another arm of it."""
    is_arm = any(word == "IF" and _first_word(row) in ARMS for _, row in rows)
    return any(
        _indent(row) == _indent(header) and (is_arm or _is_end(row, word)) for _, row in rows
    )


def _within(header: str, rows: list[tuple[int, str]]) -> list[tuple[int, str]]:
    """Return those of the rows behind a header that stand further in than it."""
    return list(takewhile(lambda row: _indent(row[1]) > _indent(header), rows))


def _on_its_line(block: Block, text: str, is_last: bool) -> dict[str, str]:
    """Return what is said of a block that has `text` behind its header; `is_last`: and no more."""
    first = _WORD.match(text)
    known = WORDS.get(first[0].upper()) if first else None
    if known is None or not known.is_instruction or _UNREAD.search(text):
        return {"line": "", "last": ""}
    part = block.word if block.otherwise is None else "ELSE"
    if not is_last:
        return {"line": "", "last": "", "only": text, "part": part}
    return {"line": "", "last": "", "all" if ";" in text else "behind": text, "part": part}


def _indent(row: str) -> int:
    return len(row) - len(row.lstrip())
