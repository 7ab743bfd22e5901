"""Diagnostics that are omitted because they follow from others.

`_CONSEQUENCES` lists them by code, `_RULES` by what two diagnostics have in common. Knows no row.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

from tiniscript.base.source import Source
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Code, Diagnostic
from tiniscript.recovery.writing import instruction_at

_END_CODES = (codes.NEVER_ENDS, codes.NOT_OPEN, codes.CALLS_ITSELF)
# Problems that follow from a code, at any place.
_CONSEQUENCES: dict[Code, tuple[Code, ...]] = {
    codes.CASES: (codes.BRACES, codes.BREAK_OUTSIDE),
    codes.BRACES: _END_CODES, codes.DOTS: _END_CODES,
    codes.NEVER_ENDS: (codes.TASK_NOT_TOP, codes.DEF_NOT_TOP),
}  # fmt: skip
# Codes of words whose units add nothing.
_WORD_CODES = (codes.UNKNOWN_WORD, codes.TURN_WITHOUT_DIRECTION)
_NAME_CODES = (codes.UNKNOWN_NAME, codes.USED_BEFORE_SET)
_UNTAUGHT_CODES = (codes.UNKNOWN_WORD, codes.UNTAUGHT)
_MAX_UNITS = 30  # most units that are examined, because each goes through its row


def without_consequences(diagnostics: Sequence[Diagnostic], source: Source) -> list[Diagnostic]:
    explained_codes = {
        code for diagnostic in diagnostics for code in _CONSEQUENCES.get(diagnostic.code, ())
    }
    consequence_ids = {
        id(diagnostic) for rule in _RULES for diagnostic in rule(diagnostics, source)
    }
    return [
        diagnostic
        for diagnostic in diagnostics
        if diagnostic.code not in explained_codes and id(diagnostic) not in consequence_ids
    ]


def _ends_of_a_misspelt_loop(diagnostics: Sequence[Diagnostic], _: Source) -> Iterator[Diagnostic]:
    """Ends of blocks, of which one END_LOOP belongs to a word similar to LOOP."""
    missing_headers = [
        diagnostic.values["right"]
        for diagnostic in diagnostics
        if diagnostic.code is codes.NOT_OPEN
    ]
    if missing_headers == ["LOOP"] and any(
        diagnostic.values.get("near", "")[:4] == "LOOP" for diagnostic in diagnostics
    ):
        yield from (diagnostic for diagnostic in diagnostics if diagnostic.code in _END_CODES)


def _ends_of_an_unread_if(diagnostics: Sequence[Diagnostic], _: Source) -> Iterator[Diagnostic]:
    is_unread = any(
        diagnostic.code is codes.SPANISH_IF or diagnostic.values.get("right") == "ELSE"
        for diagnostic in diagnostics
    )
    for diagnostic in diagnostics if is_unread else ():
        if diagnostic.code is codes.NOT_OPEN and diagnostic.values["right"] == "IF":
            yield diagnostic


def _uses_of_a_reserved_word(
    diagnostics: Sequence[Diagnostic], source: Source
) -> Iterator[Diagnostic]:
    """Problems that another name for a reserved word also fixes, as in the calls of its DEF."""
    explainers: dict[str, Diagnostic] = {}  # the first of each word
    for diagnostic in diagnostics:
        if diagnostic.code is codes.RESERVED:
            explainers.setdefault(diagnostic.values["word"], diagnostic)
    renamed_spans = {
        edit.span
        for explainer in explainers.values()
        if explainer.repair
        for edit in explainer.repair.edits[1:]
    }
    starts = {span.start for span in renamed_spans}
    for diagnostic in diagnostics:
        if diagnostic in explainers.values():
            continue
        if starts and instruction_at(diagnostic.span, source)[0] in starts:
            yield diagnostic
            continue
        uses_word = (
            diagnostic.code is codes.NO_VALUE and diagnostic.values.get("word") in explainers
        )
        if uses_word or diagnostic.span in renamed_spans:
            yield diagnostic


def _uses_of_a_list(diagnostics: Sequence[Diagnostic], _: Source) -> Iterator[Diagnostic]:
    """Uses of a name without a value that holds a list, which needs several names."""
    names_of_code = {
        diagnostic.values.get("found", "").upper()
        for diagnostic in diagnostics
        if diagnostic.code is codes.LISTS
    }
    for diagnostic in diagnostics if names_of_code else ():
        if (
            diagnostic.code in _NAME_CODES
            and diagnostic.values.get("found", "").upper() in names_of_code
        ):
            yield diagnostic


def _units_of_an_unknown_word(
    diagnostics: Sequence[Diagnostic], source: Source
) -> Iterator[Diagnostic]:
    unknown_offsets = [
        diagnostic.span.start for diagnostic in diagnostics if diagnostic.code in _WORD_CODES
    ]
    units = [diagnostic for diagnostic in diagnostics if diagnostic.code is codes.UNIT_PLACE]
    for diagnostic in units[:_MAX_UNITS] if unknown_offsets else ():
        start, end = instruction_at(diagnostic.span, source)
        if any(start <= offset < end for offset in unknown_offsets):
            yield diagnostic


def _ends_of_a_question_after(
    diagnostics: Sequence[Diagnostic], source: Source
) -> Iterator[Diagnostic]:
    """The missing UNTIL of an endless move: `F(FOREVER, 60) WHILE(DISTANCE > 9)`."""
    question_offsets = [
        diagnostic.span.start
        for diagnostic in diagnostics
        if diagnostic.code is codes.QUESTION_AFTER
    ]
    for diagnostic in diagnostics:
        start = diagnostic.span.start
        texts_between = (source.text[start:offset] for offset in question_offsets if start < offset)
        if diagnostic.code is codes.FOREVER_NEEDS_UNTIL and any(
            not {*text_between} & {*";\r\n"} for text_between in texts_between
        ):
            yield diagnostic


def _calls_of_a_task(diagnostics: Sequence[Diagnostic], _: Source) -> Iterator[Diagnostic]:
    """Calls that were meant to start a named TASK, which is reported at the TASK."""
    started_names = {diagnostic.values.get("started") for diagnostic in diagnostics} - {None, ""}
    for diagnostic in diagnostics if started_names else ():
        names = (diagnostic.values.get(key, "").upper() for key in ("name", "found"))
        if diagnostic.code in _UNTAUGHT_CODES and started_names & {*names}:
            yield diagnostic


_RULES: tuple[Callable[[Sequence[Diagnostic], Source], Iterator[Diagnostic]], ...] = (
    _ends_of_a_misspelt_loop, _ends_of_an_unread_if, _uses_of_a_reserved_word,
    _uses_of_a_list, _units_of_an_unknown_word, _ends_of_a_question_after, _calls_of_a_task,
)  # fmt: skip
