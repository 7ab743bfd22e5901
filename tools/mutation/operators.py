"""Small changes of the C++ machine: every operator, constant and statement, one at a time.

Knows how C++ is laid out here (clang-format keeps blanks around binary operators), and nothing of
what the machine does.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

from tools.mutation.mutants import Break, blanked, broken, has_code, read

OPERATORS = {
    "<": "<=", "<=": "<", ">": ">=", ">=": ">", "==": "!=", "!=": "==", "&&": "||", "||": "&&",
    "+": "-", "-": "+", "*": "/", "/": "*", "%": "/", "&": "|", "|": "&", "^": "&", "<<": ">>",
    ">>": "<<", "+=": "-=", "-=": "+=", "^=": "|=", "%=": "/=", "&=": "|=", "|=": "&=",
    "*=": "/=", "/=": "*=", ">>=": "<<=", "<<=": ">>=",
}  # fmt: skip
OPERATOR = re.compile(r"(?<= )(?:[-+*/%&|^]=?|<<=?|>>=?|[<>]=?|[=!]=|&&|\|\|)(?= )")
STEP = re.compile(r"\+\+|--")
NOT = re.compile(r"!(?=[\w(])")
NUMBER = re.compile(r"(?<![\w.])(0x[0-9a-f]+|\d+)\b")
# a call, an assignment or a way out, alone on its line
STATEMENT = re.compile(
    r"^ +(?!return \w|const |else|case |using |[A-Za-z][\w:<>]* [*&]?\w+(?: =|;))[\w*].*;$", re.M
)


def small_changes(sources: Path) -> list[Break]:
    """Return a break for each small change."""
    texts = read(sources)
    found: list[Break] = []
    numbers: Counter[str] = Counter()
    for file, text in texts.items():
        if not has_code(file):
            continue
        for start, end, instead in changes(blanked(text)):
            each = broken("change", "", file, texts, start, end, instead)
            name = f"{file}: `{each.was}` is `{each.becomes}`"
            numbers[name] += 1
            if numbers[name] > 1:
                name += f" (no. {numbers[name]})"
            found.append(each._replace(name=name))
    return found


def changes(text: str) -> Iterator[tuple[int, int, str]]:
    """Yield where to put what."""
    for place in OPERATOR.finditer(text):
        yield place.start(), place.end(), OPERATORS[place[0]]
    for place in STEP.finditer(text):
        yield place.start(), place.end(), "--" if place[0] == "++" else "++"
    for place in NOT.finditer(text):
        yield place.start(), place.end(), ""
    for place in NUMBER.finditer(text):
        number = int(place[1], 0)
        yield place.start(), place.end(), str(number + 1)
        if number:
            yield place.start(), place.end(), str(number - 1)
    for place in STATEMENT.finditer(text):
        yield place.start() + len(place[0]) - len(place[0].lstrip()), place.end(), ";"
