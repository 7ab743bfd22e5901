"""What to say where the count of arguments does not fit.

Knows what people probably mean: a decimal comma, or another number of values. The parser asks
for functions and headers, the checker for instructions.
"""

from __future__ import annotations

from collections.abc import Sequence

from tiniscript import problems
from tiniscript.problems import Problem
from tiniscript.source import Source, Span
from tiniscript.words import Word


def count_problem(source: Source, word: Word, arguments: Sequence[Span], span: Span) -> Problem:
    """Return the problem of `word` with these arguments; `span` is the place to point at."""
    wanted = len(word.arguments) or 1
    fixed = _with_points(source, arguments, wanted)
    if fixed is not None:
        return Problem(problems.DECIMAL_COMMA, span, {"right": fixed})
    has_table = bool(word.arguments)
    values = {
        "word": word.text,
        "usage": word.usage if has_table else f"{word.text}(c)",
        "fix": word.example if has_table else f"{word.text}(DISTANCE < 10)",
        "wanted": str(wanted),
        "found": str(len(arguments)),
    }
    return Problem(problems.ARGUMENT_COUNT, span, values)


def _with_points(source: Source, arguments: Sequence[Span], wanted: int) -> str | None:
    """`1,5, 80` where two are wanted: return `1.5, 80`. None where that does not help."""
    texts = [source[each] for each in arguments]
    merged: list[str] = []
    spare = len(texts) - wanted
    k = 0
    while k < len(texts):
        joins = (
            spare > 0
            and k + 1 < len(texts)
            and texts[k].lstrip("-").isdecimal()
            and texts[k + 1].isdecimal()
            and arguments[k + 1].start - arguments[k].end == 1
        )
        merged.append(f"{texts[k]}.{texts[k + 1]}" if joins else texts[k])
        spare -= joins
        k += 2 if joins else 1
    return ", ".join(merged) if spare == 0 and len(merged) < len(texts) else None
