"""Diagnostics based on the meaning of a text: with values and edits."""

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
from tiniscript.recovery.conserved import are_lossless, difference
from tiniscript.recovery.explanation import Explanation, explain_candidate, trimmed_edit
from tiniscript.recovery.meanings import lexemes, plain
from tiniscript.recovery.search import Candidate, Recovery
from tiniscript.recovery.writing import format_line, in_one_line

_ENDLESS_LOOP = "LOOP(FOREVER)"
# Codes whose message names the correct form.
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


def meant_diagnostics(
    source: Source, diagnostics: Sequence[Diagnostic], recovery: Recovery, is_sure: bool
) -> list[Diagnostic]:
    """Return the mistakes in a text whose meaning is known.

    `is_sure`: all of it is surely known; otherwise only the lines that could be read.
    """
    candidate = recovery.sure_candidate() if is_sure else recovery.best_candidate()
    if candidate is None:
        return []
    text = recovery.program
    source_text = source.text
    explanations = explain_candidate(source_text, candidate)
    if not explanations and candidate.is_whole:
        misplaced_diagnostics = [
            mistake for mistake in diagnostics if mistake.code in rows.MISPLACED_CODES
        ]
        reported_diagnostics = misplaced_diagnostics or [
            mistake for mistake in diagnostics if mistake.is_mistake
        ]
        return [
            _moved_lines_diagnostic(mistake, source_text, candidate, recovery.kit)
            for mistake in reported_diagnostics
        ][:1]
    if not explanations:
        return []
    explained_diagnostics = [
        (explanation, _diagnostic(explanation, candidate, diagnostics))
        for explanation in explanations
    ]
    # A reading of a part of the text must not leave anything out.
    loses_nothing = is_sure or not candidate.is_whole
    if loses_nothing and difference(text, candidate.text, recovery.kit).losses:
        kept_flags = (
            []
            if is_sure
            else are_lossless(
                [diagnostic for _, diagnostic in explained_diagnostics], source.text, recovery.kit
            )
        )
        explained_diagnostics = [
            diagnostic
            for diagnostic, is_kept in zip(explained_diagnostics, kept_flags, strict=False)
            if is_kept
        ]
    other_explanations = [
        explanation
        for other_candidate in recovery.other_candidates
        for explanation in explain_candidate(source_text, other_candidate)
    ]
    return [
        _with_rival(_with_carried_unit(diagnostic, source.text), explanation, other_explanations)
        for explanation, diagnostic in explained_diagnostics
    ]


def _with_carried_unit(diagnostic: Diagnostic, text: str) -> Diagnostic:
    """Return a mistake of a unit in a variable; moves that take the value get it: `carried`."""
    assignment_match = (
        _NUMBER_ASSIGNMENT.fullmatch(diagnostic.values.get("fix", ""))
        if diagnostic.code is codes.UNIT
        else None
    )
    unit = _UNIT_AT_END.search(diagnostic.values.get("found", ""))
    unit_word = _unit_word(unit[0]) if unit else ""
    uses = (
        [*_move_pattern(assignment_match[1], unit_word).finditer(text)]
        if assignment_match and unit_word
        else []
    )
    uses = uses or [
        unit_match
        for value_span, unit_match, _ in _uses_in_bodies(text, text)
        if diagnostic.code is codes.UNIT
        and diagnostic.span.start < value_span.end
        and diagnostic.span.end > value_span.start
    ]
    if not uses or not diagnostic.repair:
        return diagnostic
    edits = (Edit(Span(*use.span("unit")), f" {unit_word}") for use in uses)
    start, end = uses[0].span()
    unit_offset = uses[0].start("unit")
    carried_text = format_line(
        lexemes(f"{text[start:unit_offset]} {unit_word}{text[unit_offset:end]}")
    )
    repair = diagnostic.repair._replace(edits=(*diagnostic.repair.edits, *edits))
    return diagnostic._replace(values={**diagnostic.values, "carried": carried_text}, repair=repair)


def _with_rival(
    diagnostic: Diagnostic, explanation: Explanation, other_explanations: Sequence[Explanation]
) -> Diagnostic:
    """Return the diagnostics with a `rival` of about the same cost, if there is one."""
    other_fixes = (
        other_explanation.fix
        for other_explanation in other_explanations
        if other_explanation.place == explanation.place
    )
    rival = next((fix for fix in other_fixes if fix and fix != explanation.fix), "")
    if not rival:
        return diagnostic
    values = {**diagnostic.values, "rival": rival}
    if diagnostic.code is codes.MISSING_CLOSE:
        values |= dict(
            zip(("one", "another"), _bracket_contents(explanation.fix, rival), strict=True)
        )
    return diagnostic._replace(values=values)


def _bracket_contents(fix: str, rival_fix: str) -> tuple[str, str]:
    """Return the contents of the brackets in which two texts first differ."""
    common_start = slips.common_lengths(fix, rival_fix)[0]
    start, depth = common_start, 0
    while start > 0 and depth < 1:
        start -= 1
        depth += (fix[start] == "(") - (fix[start] == ")")
    content_matches = [_BALANCED_TEXT.match(text, start + 1) for text in (fix, rival_fix)]
    return content_matches[0][0] if content_matches[0] else "", content_matches[1][
        0
    ] if content_matches[1] else ""


def _diagnostic(
    explanation: Explanation, candidate: Candidate, diagnostics: Sequence[Diagnostic]
) -> Diagnostic:
    """Return an explanation as a diagnostic; as the checker has it where that counts the values."""
    is_repetition_sure = (
        explanation.code is not codes.ASKED_AFTER or "BREAK" in candidate.text.upper()
    )  # number of repetitions
    is_sure = candidate.is_applied or (candidate.is_whole and explanation.is_sure)
    repair = Repair(tuple(explanation.edits), is_repetition_sure and is_sure)
    if not candidate.has_sure_blocks and "FOREVER" not in explanation.fix:
        explanation.block_text = ""  # the end of the block is a guess
    code, values = _code_and_values(explanation)
    checker_code = codes.ARGUMENT_COUNT if code is codes.OTHER_CALL else code
    checker_diagnostics = (
        diagnostic for diagnostic in diagnostics if diagnostic.code is checker_code
    )
    for diagnostic in checker_diagnostics if checker_code in _CHECKER_CODES else ():
        if explanation.place.start <= diagnostic.span.start < explanation.place.end:
            values = {**diagnostic.values, "fix": explanation.fix}
            return Diagnostic(diagnostic.code, diagnostic.span, values, explanation.place, repair)
    if code in _CHECKER_CODES[:2]:  # the number of its values is wrong
        code, values = codes.OTHER_CALL, explanation.values_as(codes.OTHER_CALL)
    return Diagnostic(code, explanation.span, values, explanation.place, repair)


def _code_and_values(explanation: Explanation) -> tuple[Code, dict[str, str]]:
    """Return the code of the message with a word for the subject, and its values."""
    code, slip = explanation.code, explanation.slip
    if slip and code in _CODES_WITH_RIGHT and not slips.right_text_of(slip):
        has_bracket = "(" in slips.text_before(slip) + slips.wrong_text_of(slip)
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
    moved_text = _with_units(text, candidate.text)
    lost_units = [loss for loss in difference(text, moved_text, kit).losses
            if (unit := _UNIT_AT_END.search(loss)) and _unit_word(unit[0])]  # fmt: skip
    values = {**diagnostic.values, "whole": in_one_line(moved_text)}
    values |= {"lost": ", ".join(lost_units)} if lost_units else {}
    if diagnostic.code is codes.WRONG_END:
        values |= {"swapped": diagnostic.values["right"], "apart": ""}
    elif (move := candidate.move) is not None:
        values |= {"name": move.name, "line": str(move.target_line), "last": str(move.last_line)}
        if diagnostic.code is codes.UNKNOWN_WORD:  # `CALL SALTO`, before its DEF
            diagnostic = diagnostic._replace(code=codes.CALL_BEFORE_DEF)
        is_one_line = move.first_line == move.last_line and not move.moves_only_end
        values |= {"row": values.pop("last")} if is_one_line else {"first": str(move.first_line)}
        if move.moves_only_end and move.last_line > len(text.splitlines()):
            values |= {"open": move.name}  # no line contains its end
    repair = Repair((trimmed_edit(0, text, moved_text),), candidate.is_applied and not lost_units)
    return diagnostic._replace(values=values, repair=repair)


# -- units in a variable, or in the brackets of a DEF ----------------------------------------------


def _unit_word(unit: str) -> str:
    """Return the word for a unit after the first value of a move, or ""."""
    meaning = lexicon_meaning(plain(unit), "unit")
    return next(
        (word for word, way_unit in EXTENTS.items() if meaning and way_unit.unit == meaning[0]), ""
    )


def _move_pattern(name: str, unit_word: str) -> re.Pattern[str]:
    """Return the pattern of moves by an amount whose unit is missing."""
    moves = "|".join(move for move in MOVES if UNIT_OF[move] == unit_word)
    return re.compile(rf"(?i)\b(?:{moves})\s*\(\s*{name}(?P<unit>)\s*,[^();\n]*\)")


def _uses_in_bodies(
    written_text: str, meant_text: str
) -> Iterator[tuple[Span, re.Match[str], str]]:
    """Yield the places where a parameter of a DEF has a unit, and the moves that use it."""
    for def_match in _DEF_HEADER.finditer(written_text):
        body_match = re.search(rf"(?is)\bDEF\s+{def_match[1]}\b.*?(?:\bEND_?DEF\b|\Z)", meant_text)
        for match in _VALUE_WITH_UNIT.finditer(
            written_text, def_match.start("values"), def_match.end()
        ):
            unit_word = _unit_word(match[2])
            for use in (
                _move_pattern(match[1], unit_word).finditer(meant_text, *body_match.span())
                if body_match and unit_word
                else ()
            ):
                yield Span(*match.span()), use, unit_word


def _with_units(written_text: str, meant_text: str) -> str:
    """Return a program in whose DEFs the moves have the units that were written at their values."""
    edits = [
        Edit(Span(*use.span("unit")), f" {unit_word}")
        for _, use, unit_word in _uses_in_bodies(written_text, meant_text)
    ]
    return apply_edits(meant_text, edits)
