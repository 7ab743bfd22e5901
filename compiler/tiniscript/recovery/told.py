"""Diagnoses a wrong text by steps, in their order.

The first of `READERS` with a result is used. The rest of the text is read with its edits applied,
so that no consequence of a mistake is reported; `usage` has the messages that no reader covers. All
diagnostics together obey the laws; each law is a function that `diagnose` names. `python -m
tools.readers TEXT` shows each step for a text.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from functools import cached_property
from typing import NamedTuple

from tiniscript.base.kit import Kit
from tiniscript.base.source import Edit, Source, Span, apply_edits, edits_overlap
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import MAX_DIAGNOSTICS, Code, Diagnostic, Repair
from tiniscript.diagnostics.fixing import Check, drop_wrong_offers
from tiniscript.recovery import slips
from tiniscript.recovery.bracketed import explain_brackets, explain_else_question
from tiniscript.recovery.calls import misplaced_values, run_on_calls
from tiniscript.recovery.conserved import name_samples, withhold_lossy_repairs
from tiniscript.recovery.counters import counter_diagnostics
from tiniscript.recovery.dedupe import dedupe
from tiniscript.recovery.given_back import find_returned_values
from tiniscript.recovery.invisible import name_invisible_sign
from tiniscript.recovery.keys import KEYS, key_diagnostics
from tiniscript.recovery.labels import label_diagnostics
from tiniscript.recovery.leftovers import leftover_diagnostics, setup_and_end_diagnostics
from tiniscript.recovery.logo import logo_diagnostics
from tiniscript.recovery.meanings import Names, lexemes
from tiniscript.recovery.meant import meant_diagnostics
from tiniscript.recovery.motors import motor_diagnostics, switch_diagnostics
from tiniscript.recovery.notes import note_diagnostics
from tiniscript.recovery.pointing import point_at_found
from tiniscript.recovery.search import Recovery
from tiniscript.recovery.setup import SEAL, beginning_diagnostics, wrong_setup_word
from tiniscript.recovery.shares import find_shares
from tiniscript.recovery.suggestions import find_suggestions
from tiniscript.recovery.usage import with_usage

MAX_ROUNDS = 20  # most rounds of reading on from the repaired text
_LONE_CR = re.compile(r"\r(?!\n)")
MAX_CHARACTERS = 4_000  # characters of a text that is read as a whole


class Findings(NamedTuple):
    """The diagnostics of a text, and the edits for reading the rest."""

    diagnostics: list[Diagnostic]
    edits: list[Edit]


class WrongText:
    """A wrong text: `diagnostics` are those of the parser and the checker, which `check` calls."""

    def __init__(
        self, source: Source, diagnostics: Sequence[Diagnostic], check: Check, kit: Kit
    ) -> None:
        self.source = source
        self.diagnostics = diagnostics
        self.check = check
        self.kit = kit

    @cached_property
    def recovery(self) -> Recovery | None:
        """The readings of the text; or nothing for a long one, or one that is copied again."""
        text = self.source.text.replace("\r\n", "\n").replace("\r", "\n")
        if len(text) > MAX_CHARACTERS or SEAL in text:
            return None
        return Recovery(
            text,
            self.kit,
            lambda checked_text: self._mistakes(checked_text, is_own_text=checked_text == text),
        )

    def _mistakes(self, text: str, is_own_text: bool) -> list[Code]:
        diagnostics = self.diagnostics if is_own_text else self.check(text)
        return [diagnostic.code for diagnostic in diagnostics if diagnostic.is_mistake]


def diagnose(
    source: Source, diagnostics: Sequence[Diagnostic], check: Check, kit: Kit
) -> list[Diagnostic]:
    """Return the diagnoses of a wrong text, given the `diagnostics` of parser and checker.

    The readers know only one line end, a single character: other line ends are replaced by text of
    the same length.
    """
    text = _LONE_CR.sub("\n", source.text)
    source = Source(text, source.name)
    results = _read(WrongText(source, diagnostics, check, kit), MAX_ROUNDS)
    if len(results) > MAX_DIAGNOSTICS:
        results = sorted(results, key=lambda diagnostic: diagnostic.span)[: MAX_DIAGNOSTICS + 1]
    results = [explain_brackets(diagnostic, text, kit, is_offered=True) for diagnostic in results]
    results = drop_wrong_offers(results, text, check)  # every offer is correct
    results = withhold_lossy_repairs(results, text, kit)  # every repair keeps the written values
    results = [explain_brackets(diagnostic, text, kit, is_offered=False) for diagnostic in results]
    results = [explain_else_question(diagnostic, text) for diagnostic in results]
    results = name_samples(
        results, text, kit
    )  # the distance is an example, because none was written
    results = [name_invisible_sign(diagnostic, text) for diagnostic in results]
    return codes.in_order([point_at_found(diagnostic, source) for diagnostic in results])


def _read(wrong_text: WrongText, rounds_left: int) -> list[Diagnostic]:
    """Return the readers' diagnostics of a text, and then those of the rest after their edits."""
    findings = (reader(wrong_text) for reader in READERS if rounds_left)
    diagnostics, edits = next(
        (finding for finding in findings if finding.diagnostics), Findings([], [])
    )
    if not diagnostics:
        diagnostics = with_usage(wrong_text.diagnostics, wrong_text.source, wrong_text.kit)
    elif len(diagnostics) <= MAX_DIAGNOSTICS:
        repaired_text = apply_edits(wrong_text.source.text, edits)
        diagnostics_left = wrong_text.check(repaired_text)
        if any(
            diagnostic.is_mistake for diagnostic in diagnostics_left
        ):  # otherwise the warnings appear after its repair
            later_diagnostics = _read(
                WrongText(
                    Source(repaired_text), diagnostics_left, wrong_text.check, wrong_text.kit
                ),
                rounds_left - 1,
            )
            sure_edits = {edit for diagnostic in diagnostics for edit in _sure_edits(diagnostic)}
            later_diagnostics = [
                to_original(diagnostic, edits, wrong_text.source)
                for diagnostic in later_diagnostics
            ]
            guessed_edits = [edit for edit in edits if edit not in sure_edits]
            diagnostics = [
                *diagnostics,
                *(
                    _unsure_if_guessed(diagnostic, guessed_edits)
                    for diagnostic in later_diagnostics
                ),
            ]
    return dedupe(diagnostics, wrong_text.source)


# -- readers --------------------------------------------------------------------------------------


def _notes(wrong_text: WrongText) -> Findings:
    """Return comments that begin with another sign: their content is not read (`notes`)."""
    return _with_edits(note_diagnostics(wrong_text.source))


def _labels(wrong_text: WrongText) -> Findings:
    """Return the diagnostics for labels that number the instructions (`labels`)."""
    return _with_edits(label_diagnostics(wrong_text.source))


def _keys(wrong_text: WrongText) -> Findings:
    """Return the diagnostics for keys (`keys`).

    The rest is read with a key that exists.
    """
    diagnostics = key_diagnostics(wrong_text.source, wrong_text.kit)
    edits = _with_edits(diagnostics).edits
    return Findings(
        diagnostics,
        edits
        + [Edit(diagnostic.span, KEYS[0]) for diagnostic in diagnostics if not diagnostic.repair],
    )


def _shares(wrong_text: WrongText) -> Findings:
    """Return the diagnostics for sensors compared with a percentage (`shares`)."""
    return Findings(*find_shares(wrong_text.source, wrong_text.kit))


def _beginning(wrong_text: WrongText) -> Findings:
    """Return the diagnostics for the lines before the program, and for its `SI|` (`setup`)."""
    return _with_edits(
        beginning_diagnostics(
            wrong_text.source, wrong_text.diagnostics, wrong_text.check, wrong_text.kit
        )
    )


def _calls(wrong_text: WrongText) -> Findings:
    """Return the diagnostics for calls with all values in another form (`calls`)."""
    names = Names([lexemes(line) for line in wrong_text.source.text.split("\n")], wrong_text.kit)
    return _with_edits(
        misplaced_values(wrong_text.source) or run_on_calls(wrong_text.source, names)
    )


def _motors(wrong_text: WrongText) -> Findings:
    """Return the diagnostics for motors switched on and off, or set one by one (`motors`)."""
    if moves := switch_diagnostics(wrong_text.source):
        return _with_edits(moves)
    diagnostics_and_edits = motor_diagnostics(wrong_text.source)
    return Findings(
        [diagnostic for diagnostic, _ in diagnostics_and_edits],
        [edit for _, edit in diagnostics_and_edits],
    )


def _turtle(wrong_text: WrongText) -> Findings:
    """Return the diagnostics for lines of Logo, whose words have one number each (`logo`)."""
    return _with_edits(logo_diagnostics(wrong_text.source, wrong_text.kit))


def _given_back(wrong_text: WrongText) -> Findings:
    """Return the diagnostics for DEFs that return a value (`given_back`)."""
    return Findings(*find_returned_values(wrong_text.source))


def _counters(wrong_text: WrongText) -> Findings:
    """Return the diagnostics for counting loops, because LOOP has no counter (`counters`)."""
    return _with_edits(counter_diagnostics(wrong_text.source))


def _frame(wrong_text: WrongText) -> Findings:
    """Return the diagnostics for superfluous starts and ends of a program (`leftovers`)."""
    return _with_edits(setup_and_end_diagnostics(wrong_text.source, wrong_text.kit))


def _leftovers(wrong_text: WrongText) -> Findings:
    """Return words left over in instructions, which are whole without them (`leftovers`)."""
    return _with_edits(leftover_diagnostics(wrong_text.source, wrong_text.kit))


def _wrong_start(wrong_text: WrongText) -> Findings:
    """Return the diagnostic for another word instead of `SI|` (`setup`); the rest is read with
    SI.
    """
    wrong_start = wrong_setup_word(wrong_text.source, wrong_text.diagnostics)
    if wrong_start is None:
        return Findings([], [])
    diagnostics = with_usage([wrong_start], wrong_text.source, wrong_text.kit)
    return Findings(diagnostics, [Edit(wrong_start.span, "SI")])


def _sure_findings(wrong_text: WrongText) -> Findings:
    """Return the diagnostics for a text with a complete and certain reading (`search`, `meant`)."""
    recovery = wrong_text.recovery
    if recovery is None:
        return Findings([], [])
    return _with_edits(
        meant_diagnostics(wrong_text.source, wrong_text.diagnostics, recovery, is_sure=True)
    )


def _words_after(wrong_text: WrongText) -> Findings:
    """Return the diagnostics for words after or instead of instructions (`suggestions`)."""
    suggestions = find_suggestions(wrong_text.source.text, wrong_text.kit)
    if recovery := wrong_text.recovery:  # its sign joins them to the instruction: `X = 20 x 3`
        suggestions = [
            suggestion
            for suggestion in suggestions
            if not recovery.has_signs(suggestion.blanking_edit.span.start)
        ]
    return Findings(
        [suggestion.diagnostic for suggestion in suggestions],
        [suggestion.blanking_edit for suggestion in suggestions],
    )


def _likely_findings(wrong_text: WrongText) -> Findings:
    """Return the diagnostics for lines with an uncertain reading (`search`, `meant`)."""
    recovery = wrong_text.recovery
    if recovery is None:
        return Findings([], [])
    return _with_edits(
        meant_diagnostics(wrong_text.source, wrong_text.diagnostics, recovery, is_sure=False)
    )


def _words_of_blocks(wrong_text: WrongText) -> Findings:
    """Return misspelt words that begin blocks or end them: the rest is read with them.

    Otherwise the inside of the blocks would be reported, too.
    """
    diagnostics = [
        diagnostic
        for diagnostic in wrong_text.diagnostics
        if diagnostic.code is codes.UNKNOWN_WORD
        and diagnostic.values.get("near") in slips.BLOCK_WORDS
    ]
    return Findings(
        diagnostics,
        [Edit(diagnostic.span, diagnostic.values["near"]) for diagnostic in diagnostics],
    )


# Certain laws come before the search's certain results, and guesses come last.
READERS: tuple[Callable[[WrongText], Findings], ...] = (
    _notes, _labels, _given_back, _beginning, _keys, _shares, _motors, _turtle, _calls, _counters,
    _frame, _wrong_start, _sure_findings, _leftovers, _words_after, _likely_findings,
    _words_of_blocks,
)  # fmt: skip


def _with_edits(diagnostics: list[Diagnostic]) -> Findings:
    return Findings(
        diagnostics,
        [
            edit
            for diagnostic in diagnostics
            if diagnostic.repair
            for edit in diagnostic.repair.edits
        ],
    )


# -- places ---------------------------------------------------------------------------------------


def _sure_edits(diagnostic: Diagnostic) -> Sequence[Edit]:
    return diagnostic.repair.edits if diagnostic.repair and diagnostic.repair.is_sure else ()


def _unsure_if_guessed(diagnostic: Diagnostic, guessed_edits: Sequence[Edit]) -> Diagnostic:
    """Return a diagnostic with an uncertain repair if it writes text that is only shown."""
    repair = diagnostic.repair
    spans = [edit.span for edit in repair.edits] if repair else []
    if repair is None or not any(
        own_span.start <= guessed_span.start and guessed_span.end <= own_span.end
        for own_span in spans
        for guessed_span, _ in guessed_edits
    ):
        return diagnostic
    return diagnostic._replace(repair=repair._replace(is_sure=False))


def to_original(diagnostic: Diagnostic, edits: Sequence[Edit], source: Source) -> Diagnostic:
    """Return a diagnostic of the text with these edits, as one of the text without them.

    An unreadable condition is shown as written, not as its placeholder.
    """
    values = dict(diagnostic.values)
    for edit in edits:
        if edit.text.endswith("(TRUE)") and "TRUE" not in (
            original_text := source[edit.span].strip()
        ):
            values = {name: text.replace(edit.text, original_text) for name, text in values.items()}
    place = diagnostic.place and _original_span(diagnostic.place, edits)
    repair = diagnostic.repair
    if repair is not None:
        own_edits = tuple(
            Edit(_original_span(edit.span, edits), edit.text) for edit in repair.edits
        )
        blanking_edits = [
            edit for edit in edits if edit.text.isspace()
        ]  # words that must not be dropped
        repair = (
            Repair((), False)
            if edits_overlap(own_edits, blanking_edits)
            else repair._replace(edits=own_edits)
        )
    return Diagnostic(
        diagnostic.code, _original_span(diagnostic.span, edits), values, place, repair
    )


def _original_span(span: Span, edits: Sequence[Edit]) -> Span:
    """Return the original span of a span in the edited text, including edits it begins in."""
    start_shift = end_shift = shift = 0
    for edit in sorted(edits):
        edit_start = edit.span.start + shift
        edit_end = edit_start + len(edit.text)
        shift = edit_end - edit.span.end
        if span.start >= edit_end:
            start_shift = shift
        elif span.start > edit_start:
            start_shift = span.start - edit.span.start
        if span.end > edit_start:
            end_shift = shift if span.end >= edit_end else span.end - edit.span.end
    return Span(span.start - start_shift, max(span.start - start_shift, span.end - end_shift))
