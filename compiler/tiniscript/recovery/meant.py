"""What people are told of a text by what is meant with it: typed values and edits."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

from tiniscript.base.kit import Kit
from tiniscript.base.source import Edit, Source, Span, apply_edits
from tiniscript.base.spelling import is_slip, nearest
from tiniscript.base.words import EXTENTS, MOVES, UNIT_OF, lexicon_meaning
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Code, Diagnostic, Repair
from tiniscript.recovery import rows, slips
from tiniscript.recovery.conserved import difference, keeps_all
from tiniscript.recovery.explanation import Explanation, explained, trimmed
from tiniscript.recovery.meanings import lexemes, plain
from tiniscript.recovery.search import Candidate, Recovery
from tiniscript.recovery.writing import in_one_line, laid_out

_ENDLESS_LOOP = "LOOP(FOREVER)"
# Codes whose sentence names what is right.
_CODES_WITH_RIGHT = (
    codes.OTHER_LANGUAGE,
    codes.OTHER_SIGN,
    codes.END_ALONE,
    codes.OTHER_ASSIGNMENT,
)
_CHECKER_CODES = (codes.ARGUMENT_COUNT, codes.WANTS_CONDITION, codes.NO_BRACKETS_HERE)
_NUMBER_ASSIGNMENT = re.compile(r"(\w+) = -?[0-9.]+")
_BALANCED_TEXT = re.compile(r"(?:[^()]|\((?:[^()]|\([^()]*\))*\))*")
_UNIT_AT_END = re.compile(r"[^\d\s.]+$")
_DEF_HEADER = re.compile(r"(?i)\bDEF[ \t]+(\w+)[ \t]*\((?P<values>[^()\n]*)\)")
_VALUE_WITH_UNIT = re.compile(r"(\w+)[ \t]+(\w+)(?=[ \t]*[,)])")


def meant_in(
    source: Source, diagnostics: Sequence[Diagnostic], recovery: Recovery, is_sure: bool
) -> list[Diagnostic]:
    """Return what is wrong with a text where it is known what is meant by it.

    `is_sure`: by all of it surely; else by the lines that are read.
    """
    candidate = recovery.sure() if is_sure else recovery.best()
    if candidate is None:
        return []
    text = recovery.program
    sentence = source.text
    message = explained(sentence, candidate)
    if not message and candidate.is_whole:
        misplaced_diagnostics = [each for each in diagnostics if each.code in rows.MISPLACED]
        said_of_it = misplaced_diagnostics or [each for each in diagnostics if each.is_mistake]
        return [
            _moved_lines_diagnostic(each, sentence, candidate, recovery.kit) for each in said_of_it
        ][:1]
    if not message:
        return []
    explained_diagnostics = [(each, _diagnostic(each, candidate, diagnostics)) for each in message]
    loses_nothing = is_sure or not candidate.is_whole  # what is read of a part gives up nothing
    if loses_nothing and difference(text, candidate.text, recovery.kit).losses:
        is_kept_of = (
            []
            if is_sure
            else keeps_all([own for _, own in explained_diagnostics], source.text, recovery.kit)
        )
        explained_diagnostics = [
            it for it, is_kept in zip(explained_diagnostics, is_kept_of, strict=False) if is_kept
        ]
    other_explanations = [each for other in recovery.others for each in explained(sentence, other)]
    return [
        _with_rival(_with_carried_unit(own, source.text), each, other_explanations)
        for each, own in explained_diagnostics
    ]


def _with_carried_unit(diagnostic: Diagnostic, text: str) -> Diagnostic:
    """Return a mistake of a unit in a variable; moves that take the value get it: `carried`."""
    set_to = (
        _NUMBER_ASSIGNMENT.fullmatch(diagnostic.values.get("fix", ""))
        if diagnostic.code is codes.UNIT
        else None
    )
    unit = _UNIT_AT_END.search(diagnostic.values.get("found", ""))
    way = _unit_word(unit[0]) if unit else ""
    uses = [*_move_pattern(set_to[1], way).finditer(text)] if set_to and way else []
    uses = uses or [
        unit_match
        for head, unit_match, _ in _in_bodies(text, text)
        if diagnostic.code is codes.UNIT
        and diagnostic.span.start < head.end
        and diagnostic.span.end > head.start
    ]
    if not uses or not diagnostic.repair:
        return diagnostic
    edits = (Edit(Span(*item.span("unit")), f" {way}") for item in uses)
    start, end = uses[0].span()
    place = uses[0].start("unit")
    carried = laid_out(lexemes(f"{text[start:place]} {way}{text[place:end]}"))
    repair = diagnostic.repair._replace(edits=(*diagnostic.repair.edits, *edits))
    return diagnostic._replace(values={**diagnostic.values, "carried": carried}, repair=repair)


def _with_rival(
    diagnostic: Diagnostic, explanation: Explanation, other_explanations: Sequence[Explanation]
) -> Diagnostic:
    """Return what is told with its `rival`, which costs about the same, where there is one."""
    fixes = (item.fix for item in other_explanations if item.place == explanation.place)
    other = next((fix for fix in fixes if fix and fix != explanation.fix), "")
    if not other:
        return diagnostic
    values = {**diagnostic.values, "rival": other}
    if diagnostic.code is codes.MISSING_CLOSE:
        values |= dict(zip(("one", "another"), _in_brackets(explanation.fix, other), strict=True))
    return diagnostic._replace(values=values)


def _in_brackets(one: str, other: str) -> tuple[str, str]:
    """Return what the brackets hold in which two texts differ first."""
    common_start = slips.alike(one, other)[0]
    start, depth = common_start, 0
    while start > 0 and depth < 1:
        start -= 1
        depth += (one[start] == "(") - (one[start] == ")")
    inside = [_BALANCED_TEXT.match(item, start + 1) for item in (one, other)]
    return inside[0][0] if inside[0] else "", inside[1][0] if inside[1] else ""


def _diagnostic(
    explanation: Explanation, candidate: Candidate, diagnostics: Sequence[Diagnostic]
) -> Diagnostic:
    """Return an explanation as a diagnostic; as the checker has it where that counts the values."""
    is_explained = (
        explanation.code is not codes.ASKED_AFTER or "BREAK" in candidate.text.upper()
    )  # how often
    is_sure = candidate.is_applied or (candidate.is_whole and explanation.is_sure)
    repair = Repair(tuple(explanation.edits), is_explained and is_sure)
    if not candidate.has_sure_blocks and "FOREVER" not in explanation.fix:
        explanation.whole = ""  # where it ends is a guess
    code, values = _in_words(explanation)
    checker_code = codes.ARGUMENT_COUNT if code is codes.OTHER_CALL else code
    checker_diagnostics = (each for each in diagnostics if each.code is checker_code)
    for each in checker_diagnostics if checker_code in _CHECKER_CODES else ():
        if explanation.place.start <= each.span.start < explanation.place.end:
            values = {**each.values, "fix": explanation.fix}
            return Diagnostic(each.code, each.span, values, explanation.place, repair)
    if code in _CHECKER_CODES[:2]:  # its values are not counted
        code, values = codes.OTHER_CALL, explanation.values_as(codes.OTHER_CALL)
    return Diagnostic(code, explanation.span, values, explanation.place, repair)


def _in_words(explanation: Explanation) -> tuple[Code, dict[str, str]]:
    """Return the code of the sentence that has a word for what is told, and its values."""
    code, slip = explanation.code, explanation.slip
    if slip and code in _CODES_WITH_RIGHT and not slips.right_of(slip):
        has_bracket = "(" in slips.before_it(slip) + slips.found_in(slip)
        code = codes.OTHER_CALL if has_bracket else codes.MISSING_OPEN
    values = explanation.values_as(code)
    found_word, suggestion = values.get("found", "").upper(), values.get("right", "")
    is_misspelling = nearest(found_word, [suggestion]) or (
        suggestion in EXTENTS and is_slip(found_word, suggestion)
    )
    if code is codes.OTHER_LANGUAGE and is_misspelling:
        code = codes.UNKNOWN_WORD
        values |= {"found": values["found"].upper(), "near": suggestion}
    elif suggestion == "FOREVER" and _ENDLESS_LOOP in explanation.fix:
        values["right"] = _ENDLESS_LOOP  # FOREVER alone begins no block
    return code, values


def _moved_lines_diagnostic(
    diagnostic: Diagnostic, text: str, candidate: Candidate, kit: Kit
) -> Diagnostic:
    """Return a mistake that goes when lines change their places."""
    result = _with_units(text, candidate.text)
    lost = [item for item in difference(text, result, kit).losses
            if (unit := _UNIT_AT_END.search(item)) and _unit_word(unit[0])]  # fmt: skip
    values = {**diagnostic.values, "whole": in_one_line(result)}
    values |= {"lost": ", ".join(lost)} if lost else {}
    if diagnostic.code is codes.WRONG_END:
        values |= {"swapped": diagnostic.values["right"], "apart": ""}
    elif (move := candidate.move) is not None:
        values |= {"name": move.name, "line": str(move.before), "last": str(move.last)}
        if diagnostic.code is codes.UNKNOWN_WORD:  # `CALL SALTO`, before its DEF
            diagnostic = diagnostic._replace(code=codes.CALL_BEFORE_DEF)
        is_one_line = move.first == move.last and not move.is_end
        values |= {"row": values.pop("last")} if is_one_line else {"first": str(move.first)}
        if move.is_end and move.last > len(text.splitlines()):
            values |= {"open": move.name}  # its end is in no line
    repair = Repair((trimmed(0, text, result),), candidate.is_applied and not lost)
    return diagnostic._replace(values=values, repair=repair)


# -- units that stand in a variable, or in the brackets of a DEF -----------------------------------


def _unit_word(unit: str) -> str:
    """Return the word for a unit behind the first value of a move, "" where none is."""
    text = lexicon_meaning(plain(unit), "unit")
    return next((way for way, way_unit in EXTENTS.items() if text and way_unit.unit == text[0]), "")


def _move_pattern(name: str, way: str) -> re.Pattern[str]:
    """Return the pattern of the moves that go so much of a unit, and have none."""
    moves = "|".join(move for move in MOVES if UNIT_OF[move] == way)
    return re.compile(rf"(?i)\b(?:{moves})\s*\(\s*{name}(?P<unit>)\s*,[^();\n]*\)")


def _in_bodies(written_text: str, meant_text: str) -> Iterator[tuple[Span, re.Match[str], str]]:
    """Give where a name has a unit in the brackets of a DEF, and the moves that take it, each."""
    for head in _DEF_HEADER.finditer(written_text):
        body = re.search(rf"(?is)\bDEF\s+{head[1]}\b.*?(?:\bEND_?DEF\b|\Z)", meant_text)
        for match in _VALUE_WITH_UNIT.finditer(written_text, head.start("values"), head.end()):
            way = _unit_word(match[2])
            for use in (
                _move_pattern(match[1], way).finditer(meant_text, *body.span())
                if body and way
                else ()
            ):
                yield Span(*match.span()), use, way


def _with_units(written_text: str, meant_text: str) -> str:
    """Return a program in whose DEFs the moves have the units that stood at their values."""
    edits = [
        Edit(Span(*it.span("unit")), f" {way}")
        for _, it, way in _in_bodies(written_text, meant_text)
    ]
    return apply_edits(meant_text, edits)
