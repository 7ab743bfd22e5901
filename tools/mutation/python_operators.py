"""Small changes of a file in Python: every operator, word and number, one at a time.

Knows the tokens of Python, and nothing of what the file does. What is in strings stays.
"""

from __future__ import annotations

import io
import tokenize
from collections.abc import Iterator
from itertools import accumulate

OPERATORS = {
    "<": "<=", "<=": "<", ">": ">=", ">=": ">", "==": "!=", "!=": "==", "+": "-", "-": "+",
    "*": "//", "//": "*", "%": "*", "&": "|", "|": "&", "^": "&", "<<": ">>", ">>": "<<",
    "+=": "-=", "-=": "+=", "&=": "|=", "|=": "&=",
}  # fmt: skip
WORDS = {"and": "or", "or": "and", "True": "False", "False": "True", "break": "pass",
         "continue": "pass", "not": ""}  # fmt: skip
IMPORTS = ("import", "from")
LINES = (tokenize.NEWLINE, tokenize.INDENT, tokenize.DEDENT)


def python_changes(text: str) -> Iterator[tuple[int, int, str]]:
    """Yield where to put what. Types are left alone: nothing runs there."""
    begins = [0, *accumulate(len(line) for line in text.splitlines(keepends=True))]
    tokens = [each for each in tokenize.generate_tokens(io.StringIO(text).readline)
              if each.type not in (tokenize.COMMENT, tokenize.NL)]  # fmt: skip
    is_skipped = False  # an import, an annotation, or the head of a function
    for before, token in zip([None, *tokens], tokens, strict=False):
        if token.type in LINES:
            is_skipped = False
            continue
        line = token.line.lstrip()
        is_begin = before is None or before.type in LINES
        if is_begin:
            is_skipped = line.startswith((*IMPORTS, "def ", "class ", "@"))
        start, end = (begins[row - 1] + column for row, column in (token.start, token.end))
        if is_skipped:
            continue
        if token.type == tokenize.OP and token.string in OPERATORS:
            is_union = token.string == "|" and ":" in line.split("|")[0]
            if not is_union and not _is_sign(before):
                yield start, end, OPERATORS[token.string]
        elif token.type == tokenize.NAME and token.string in WORDS:
            if token.string == "not" and before is not None and before.string == "is":
                yield start, end, ""
            elif not (token.string == "not" and token.line[token.end[1] :].startswith(" in")):
                yield start, end, WORDS[token.string]
        elif token.type == tokenize.NUMBER and token.string.isdecimal():
            yield start, end, str(int(token.string) + 1)


def _is_sign(before: tokenize.TokenInfo | None) -> bool:
    """Whether an operator behind this token has one operand: `-1`, `*rest`, `**values`."""
    if before is None or before.type in LINES:
        return True
    return before.type == tokenize.OP and before.string not in (")", "]", "}")
