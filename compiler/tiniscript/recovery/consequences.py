"""What is not told, since it follows from something else that is told.

`_FOLLOW` says it of codes, `_RULES` of what two diagnostics have in common. Knows no row.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

from tiniscript.base.source import Source
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Code, Diagnostic
from tiniscript.recovery.writing import instruction_at

_OF_ENDS = (codes.NEVER_ENDS, codes.NOT_OPEN, codes.CALLS_ITSELF)
# What follows from a code, wherever it is told.
_FOLLOW: dict[Code, tuple[Code, ...]] = {
    codes.CASES: (codes.BRACES, codes.BREAK_OUTSIDE),
    codes.BRACES: _OF_ENDS, codes.DOTS: _OF_ENDS,
    codes.NEVER_ENDS: (codes.TASK_NOT_TOP, codes.DEF_NOT_TOP),
}  # fmt: skip
_OF_ITS_WORD = (codes.UNKNOWN_WORD, codes.WHICH_WAY)  # whose units say nothing more
_OF_NAMES = (codes.UNKNOWN_NAME, codes.USED_BEFORE_SET)
_MANY = 30  # of which it is looked at: each goes through its row


def without_consequences(told: Sequence[Diagnostic], source: Source) -> list[Diagnostic]:
    gone = {code for each in told for code in _FOLLOW.get(each.code, ())}
    follow = {id(each) for rule in _RULES for each in rule(told, source)}
    return [each for each in told if each.code not in gone and id(each) not in follow]


def _ends_of_a_misspelt_loop(told: Sequence[Diagnostic], _: Source) -> Iterator[Diagnostic]:
    """Ends of blocks, where one END_LOOP is left for what is nearly LOOP."""
    rights = [each.values["right"] for each in told if each.code is codes.NOT_OPEN]
    if rights == ["LOOP"] and any(it.values.get("near", "")[:4] == "LOOP" for it in told):
        yield from (each for each in told if each.code in _OF_ENDS)


def _ends_of_an_unread_if(told: Sequence[Diagnostic], _: Source) -> Iterator[Diagnostic]:
    is_unread = any(it.code is codes.SPANISH_IF or it.values.get("right") == "ELSE" for it in told)
    for each in told if is_unread else ():
        if each.code is codes.NOT_OPEN and each.values["right"] == "IF":
            yield each


def _uses_of_a_reserved_word(told: Sequence[Diagnostic], _: Source) -> Iterator[Diagnostic]:
    """What another name for a word of the language mends, too."""
    reserved = [each for each in told if each.code is codes.RESERVED]
    words = {each.values["word"] for each in reserved}
    edits = [each.repair.edits[1:] for each in reserved if each.repair]
    renamed = {edit.span for its in edits for edit in its}
    for each in told:
        is_of_word = each.code is codes.NO_VALUE and each.values.get("word") in words
        if is_of_word or each.span in renamed:
            yield each


def _uses_of_a_list(told: Sequence[Diagnostic], _: Source) -> Iterator[Diagnostic]:
    """That a name has no number which holds a list: it needs several names."""
    lists = {each.values.get("found", "").upper() for each in told if each.code is codes.LISTS}
    for each in told if lists else ():
        if each.code in _OF_NAMES and each.values.get("found", "").upper() in lists:
            yield each


def _units_of_an_unknown_word(told: Sequence[Diagnostic], source: Source) -> Iterator[Diagnostic]:
    unknown = [each.span.start for each in told if each.code in _OF_ITS_WORD]
    units = [each for each in told if each.code is codes.UNIT_PLACE]
    for each in units[:_MANY] if unknown else ():
        start, end = instruction_at(each.span, source)
        if any(start <= place < end for place in unknown):
            yield each


def _ends_of_a_question_behind(told: Sequence[Diagnostic], source: Source) -> Iterator[Diagnostic]:
    """That a move without end needs an UNTIL: `F(FOREVER, 60) WHILE(DISTANCE > 9)`."""
    asked = [each.span.start for each in told if each.code is codes.QUESTION_BEHIND]
    for each in told:
        start = each.span.start
        behind = (source.text[start:place] for place in asked if start < place)
        if each.code is codes.FOREVER_NEEDS_UNTIL and any(not {*it} & {*";\r\n"} for it in behind):
            yield each


_RULES: tuple[Callable[[Sequence[Diagnostic], Source], Iterator[Diagnostic]], ...] = (
    _ends_of_a_misspelt_loop, _ends_of_an_unread_if, _uses_of_a_reserved_word,
    _uses_of_a_list, _units_of_an_unknown_word, _ends_of_a_question_behind,
)  # fmt: skip
