"""Small changes of a file in JavaScript: every operator, number and statement, one at a time.

Knows how JavaScript is laid out here (blanks around binary operators, single quotes, a statement
on a line), and nothing of what the file does. What is in strings, patterns and comments stays.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

OPERATORS = {
    "<": "<=", "<=": "<", ">": ">=", ">=": ">", "===": "!==", "!==": "===", "&&": "||", "||": "&&",
    "??": "&&", "+": "-", "-": "+", "*": "/", "/": "*", "%": "/", "+=": "-=", "-=": "+=",
    "??=": "=", "||=": "&&=",
}  # fmt: skip
OPERATOR = re.compile(r"(?<= )(?:===|!==|\?\?=|\|\|=|&&|\|\||\?\?|[<>]=?|[-+]=|[-+*/%])(?= )")
NOT = re.compile(r"!(?=[\w(])")
NUMBER = re.compile(r"(?<![\w.#$])(\d[\d_]*)(?![\w.])")
# a call, an assignment or a way out, alone on its line
STATEMENT = re.compile(
    r"^ +(?!return \w|const |let |else|case |import |export |#\w+;|#\w+ = |get |set |async )"
    r"[#\w].*;$",
    re.M,
)
# Strings, templates with what is in them, comments, and patterns behind what no value ends.
STILL = re.compile(
    r"'(?:[^'\\\n]|\\.)*'|\"(?:[^\"\\\n]|\\.)*\"|`(?:[^`\\]|\\.)*`|//[^\n]*|/\*.*?\*/"
    r"|(?<=[(,=:!&|?] )/(?:[^/\\\n\[]|\\.|\[(?:[^\]\\\n]|\\.)*\])+/\w*"
    r"|(?<=[(!])/(?:[^/\\\n\[]|\\.|\[(?:[^\]\\\n]|\\.)*\])+/\w*",
    re.S,
)


def javascript_changes(text: str) -> Iterator[tuple[int, int, str]]:
    """Yield where to put what."""
    plain = STILL.sub(lambda found: re.sub(r"[^\n]", "\0", found[0]), text)
    for place in OPERATOR.finditer(plain):
        yield place.start(), place.end(), OPERATORS[place[0]]
    for place in NOT.finditer(plain):
        yield place.start(), place.end(), ""
    for place in NUMBER.finditer(plain):
        yield place.start(), place.end(), str(int(place[1].replace("_", "")) + 1)
    for place in STATEMENT.finditer(plain):
        yield place.start() + len(place[0]) - len(place[0].lstrip()), place.end(), ";"
