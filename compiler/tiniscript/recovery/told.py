"""What people are told of a wrong text: each step of it, in their order.

The first of `READERS` that says something is told. The rest of the text is read as if its edits
were made, so that no consequence of a mistake is reported; `usage` says what no reader does. What
is told in all is held to the laws, each by a function that `told_of` names. Of a given text
`python -m tools.readers TEXT` shows all of it.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from functools import cached_property
from typing import NamedTuple

from tiniscript.base.kit import Kit
from tiniscript.base.source import Edit, Source, Span, apply_edits, edits_overlap
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import MOST_DIAGNOSTICS, Code, Diagnostic, Repair
from tiniscript.diagnostics.fixing import Check, drop_wrong_offers
from tiniscript.recovery import slips
from tiniscript.recovery.bracketed import answered, bracketed
from tiniscript.recovery.calls import misplaced_values, run_on
from tiniscript.recovery.conserved import conserving, with_sample
from tiniscript.recovery.counters import counters
from tiniscript.recovery.dedupe import dedupe
from tiniscript.recovery.given_back import given_back
from tiniscript.recovery.invisible import invisible
from tiniscript.recovery.keys import KEYS, asked_keys
from tiniscript.recovery.labels import labelled
from tiniscript.recovery.leftovers import leftovers, setup_and_end_leftovers
from tiniscript.recovery.logo import turtle
from tiniscript.recovery.meanings import Names, lexemes
from tiniscript.recovery.meant import meant_in
from tiniscript.recovery.motors import one_by_one, switched
from tiniscript.recovery.notes import noted
from tiniscript.recovery.pointing import pointed
from tiniscript.recovery.search import Recovery
from tiniscript.recovery.setup import SEAL, beginning, other_word
from tiniscript.recovery.shares import shares
from tiniscript.recovery.suggestions import suggested
from tiniscript.recovery.usage import with_usage

MOST_ROUNDS = 20  # of reading what follows a mistake from the repaired text
_LONE_CR = re.compile(r"\r(?!\n)")
MOST_CHARACTERS = 4_000  # characters of a text that is read as a whole


class Findings(NamedTuple):
    """What is told of a text, and the edits with which the rest of it is read."""

    diagnostics: list[Diagnostic]
    edits: list[Edit]


class WrongText:
    """A wrong text: `diagnostics` is what parser and checker, which `check` asks, say of it."""

    def __init__(
        self, source: Source, diagnostics: Sequence[Diagnostic], check: Check, kit: Kit
    ) -> None:
        self.source = source
        self.diagnostics = diagnostics
        self.check = check
        self.kit = kit

    @cached_property
    def recovery(self) -> Recovery | None:
        """The readings of the text; nothing for a long one, or one that is copied again."""
        text = self.source.text.replace("\r\n", "\n").replace("\r", "\n")
        if len(text) > MOST_CHARACTERS or SEAL in text:
            return None
        return Recovery(text, self.kit, lambda to: self._mistakes(to, is_own_text=to == text))

    def _mistakes(self, text: str, is_own_text: bool) -> list[Code]:
        diagnostics = self.diagnostics if is_own_text else self.check(text)
        return [diagnostic.code for diagnostic in diagnostics if diagnostic.is_mistake]


def told_of(
    source: Source, diagnostics: Sequence[Diagnostic], check: Check, kit: Kit
) -> list[Diagnostic]:
    """Return what is told of a wrong text, of which the parser and the checker say `diagnostics`.

    The readers know one end of a line that is a character: what the text has instead takes as much.
    """
    text = _LONE_CR.sub("\n", source.text)
    source = Source(text, source.name)
    diagnostics_told = _read(WrongText(source, diagnostics, check, kit), MOST_ROUNDS)
    if len(diagnostics_told) > MOST_DIAGNOSTICS:
        diagnostics_told = sorted(diagnostics_told, key=lambda it: it.span)[: MOST_DIAGNOSTICS + 1]
    diagnostics_told = [bracketed(item, text, kit, is_offered=True) for item in diagnostics_told]
    diagnostics_told = drop_wrong_offers(diagnostics_told, text, check)  # what is offered is right
    diagnostics_told = conserving(
        diagnostics_told, text, kit
    )  # what is made keeps what was written
    diagnostics_told = [bracketed(item, text, kit, is_offered=False) for item in diagnostics_told]
    diagnostics_told = [answered(item, text) for item in diagnostics_told]
    diagnostics_told = with_sample(
        diagnostics_told, text, kit
    )  # of a distance that nobody wrote it says: an example
    diagnostics_told = [invisible(item, text) for item in diagnostics_told]
    return codes.in_order([pointed(item, source) for item in diagnostics_told])


def _read(wrong_text: WrongText, rounds_left: int) -> list[Diagnostic]:
    """Return what the readers say of a text, and then of what their edits leave wrong."""
    findings = (reader(wrong_text) for reader in READERS if rounds_left)
    diagnostics, edits = next((each for each in findings if each.diagnostics), Findings([], []))
    if not diagnostics:
        diagnostics = with_usage(wrong_text.diagnostics, wrong_text.source, wrong_text.kit)
    elif len(diagnostics) <= MOST_DIAGNOSTICS:
        repaired_text = apply_edits(wrong_text.source.text, edits)
        diagnostics_left = wrong_text.check(repaired_text)
        if any(
            each.is_mistake for each in diagnostics_left
        ):  # else its warnings come when it is repaired
            later_diagnostics = _read(
                WrongText(
                    Source(repaired_text), diagnostics_left, wrong_text.check, wrong_text.kit
                ),
                rounds_left - 1,
            )
            sure_edits = {it for each in diagnostics for it in _sure_edits(each)}
            later_diagnostics = [
                moved_back(each, edits, wrong_text.source) for each in later_diagnostics
            ]
            guessed_edits = [edit for edit in edits if edit not in sure_edits]
            diagnostics = [
                *diagnostics,
                *(_unless_guessed(each, guessed_edits) for each in later_diagnostics),
            ]
    return dedupe(diagnostics, wrong_text.source)


# -- readers --------------------------------------------------------------------------------------


def _notes(wrong_text: WrongText) -> Findings:
    """Return notes that begin with another sign: nothing in them is read (`notes`)."""
    return _with_edits(noted(wrong_text.source))


def _labels(wrong_text: WrongText) -> Findings:
    """Return what counts the instructions of a text, before each of them (`labels`)."""
    return _with_edits(labelled(wrong_text.source))


def _keys(wrong_text: WrongText) -> Findings:
    """Return what is wrong with keys that are asked for (`keys`).

    The rest is read with a key that exists.
    """
    diagnostics = asked_keys(wrong_text.source, wrong_text.kit)
    edits = _with_edits(diagnostics).edits
    return Findings(
        diagnostics, edits + [Edit(it.span, KEYS[0]) for it in diagnostics if not it.repair]
    )


def _shares(wrong_text: WrongText) -> Findings:
    """Return what is wrong with sensors that are asked for a percentage (`shares`)."""
    return Findings(*shares(wrong_text.source, wrong_text.kit))


def _beginning(wrong_text: WrongText) -> Findings:
    """Return what is wrong with the lines before the program, and with its `SI|` (`setup`)."""
    return _with_edits(
        beginning(wrong_text.source, wrong_text.diagnostics, wrong_text.check, wrong_text.kit)
    )


def _calls(wrong_text: WrongText) -> Findings:
    """Return what is wrong with calls that have all their values in another form (`calls`)."""
    names = Names([lexemes(line) for line in wrong_text.source.text.split("\n")], wrong_text.kit)
    return _with_edits(misplaced_values(wrong_text.source) or run_on(wrong_text.source, names))


def _motors(wrong_text: WrongText) -> Findings:
    """Return what is wrong with motors that are switched on and off, or one by one (`motors`)."""
    if moves := switched(wrong_text.source):
        return _with_edits(moves)
    diagnostics_and_edits = one_by_one(wrong_text.source)
    return Findings(
        [message for message, _ in diagnostics_and_edits],
        [edit for _, edit in diagnostics_and_edits],
    )


def _turtle(wrong_text: WrongText) -> Findings:
    """Return what is wrong with lines of Logo, whose words have one number each (`logo`)."""
    return _with_edits(turtle(wrong_text.source, wrong_text.kit))


def _given_back(wrong_text: WrongText) -> Findings:
    """Return what is wrong with DEFs that give a value back (`given_back`)."""
    return Findings(*given_back(wrong_text.source))


def _counters(wrong_text: WrongText) -> Findings:
    """Return what is wrong with loops that count, where LOOP counts nothing (`counters`)."""
    return _with_edits(counters(wrong_text.source))


def _frame(wrong_text: WrongText) -> Findings:
    """Return what begins a program once more, or ends it, which needs no word (`leftovers`)."""
    return _with_edits(setup_and_end_leftovers(wrong_text.source, wrong_text.kit))


def _leftovers(wrong_text: WrongText) -> Findings:
    """Return words left over in instructions, which are whole without them (`leftovers`)."""
    return _with_edits(leftovers(wrong_text.source, wrong_text.kit))


def _wrong_start(wrong_text: WrongText) -> Findings:
    """Return that another word stands in the place of `SI|` (`setup`); the rest is read with SI."""
    wrong_start = other_word(wrong_text.source, wrong_text.diagnostics)
    if wrong_start is None:
        return Findings([], [])
    diagnostics = with_usage([wrong_start], wrong_text.source, wrong_text.kit)
    return Findings(diagnostics, [Edit(wrong_start.span, "SI")])


def _sure_findings(wrong_text: WrongText) -> Findings:
    """Return what is wrong with a text that is read wholly and surely (`search`, `meant`)."""
    recovery = wrong_text.recovery
    if recovery is None:
        return Findings([], [])
    return _with_edits(meant_in(wrong_text.source, wrong_text.diagnostics, recovery, is_sure=True))


def _words_after(wrong_text: WrongText) -> Findings:
    """Return what words say after instructions, or in the place of one (`suggestions`)."""
    suggestions = suggested(wrong_text.source.text, wrong_text.kit)
    if recovery := wrong_text.recovery:  # they belong to the instruction by its sign: `X = 20 x 3`
        suggestions = [
            item for item in suggestions if not recovery.has_signs(item.blanking_edit.span.start)
        ]
    return Findings(
        [item.diagnostic for item in suggestions], [item.blanking_edit for item in suggestions]
    )


def _likely_findings(wrong_text: WrongText) -> Findings:
    """Return what is wrong with the lines that are read, if not surely (`search`, `meant`)."""
    recovery = wrong_text.recovery
    if recovery is None:
        return Findings([], [])
    return _with_edits(meant_in(wrong_text.source, wrong_text.diagnostics, recovery, is_sure=False))


def _words_of_blocks(wrong_text: WrongText) -> Findings:
    """Return misspelt words that begin blocks or end them: the rest is read with them.

    Else what is inside would be told of as well.
    """
    diagnostics = [each for each in wrong_text.diagnostics if each.code is codes.UNKNOWN_WORD
                   and each.values.get("near") in slips.BLOCK_WORDS]  # fmt: skip
    return Findings(diagnostics, [Edit(each.span, each.values["near"]) for each in diagnostics])


# Laws of their own come before what a search finds surely, and what it guesses comes last.
READERS: tuple[Callable[[WrongText], Findings], ...] = (
    _notes, _labels, _given_back, _beginning, _keys, _shares, _motors, _turtle, _calls, _counters,
    _frame, _wrong_start, _sure_findings, _leftovers, _words_after, _likely_findings,
    _words_of_blocks,
)  # fmt: skip


def _with_edits(diagnostics: list[Diagnostic]) -> Findings:
    return Findings(
        diagnostics, [edit for item in diagnostics if item.repair for edit in item.repair.edits]
    )


# -- places ---------------------------------------------------------------------------------------


def _sure_edits(diagnostic: Diagnostic) -> Sequence[Edit]:
    return diagnostic.repair.edits if diagnostic.repair and diagnostic.repair.is_sure else ()


def _unless_guessed(diagnostic: Diagnostic, guessed: Sequence[Edit]) -> Diagnostic:
    """Return a diagnostic whose repair is not sure where it writes what is only shown."""
    repair = diagnostic.repair
    spans = [edit.span for edit in repair.edits] if repair else []
    if repair is None or not any(
        a.start <= b.start and b.end <= a.end for a in spans for b, _ in guessed
    ):
        return diagnostic
    return diagnostic._replace(repair=repair._replace(is_sure=False))


def moved_back(diagnostic: Diagnostic, edits: Sequence[Edit], source: Source) -> Diagnostic:
    """Return a diagnostic of the text with these edits, as one of the text without them.

    A condition that nobody can read is shown as it is written, and not what it was passed over for.
    """
    values = dict(diagnostic.values)
    for edit in edits:
        if edit.text.endswith("(TRUE)") and "TRUE" not in (original := source[edit.span].strip()):
            values = {name: text.replace(edit.text, original) for name, text in values.items()}
    place = diagnostic.place and _original_span(diagnostic.place, edits)
    repair = diagnostic.repair
    if repair is not None:
        own_edits = tuple(
            Edit(_original_span(edit.span, edits), edit.text) for edit in repair.edits
        )
        blanking_edits = [
            edit for edit in edits if edit.text.isspace()
        ]  # words that nothing may drop
        repair = (
            Repair((), False)
            if edits_overlap(own_edits, blanking_edits)
            else repair._replace(edits=own_edits)
        )
    return Diagnostic(
        diagnostic.code, _original_span(diagnostic.span, edits), values, place, repair
    )


def _original_span(span: Span, edits: Sequence[Edit]) -> Span:
    """Return where a span of the text with edits stood before them; all of one it begins in."""
    start = end = shift = 0
    for edit in sorted(edits):
        begin = edit.span.start + shift
        edit_end = begin + len(edit.text)
        shift = edit_end - edit.span.end
        if span.start >= edit_end:
            start = shift
        elif span.start > begin:
            start = span.start - edit.span.start
        if span.end > begin:
            end = shift if span.end >= edit_end else span.end - edit.span.end
    return Span(span.start - start, max(span.start - start, span.end - end))
