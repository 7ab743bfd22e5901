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
from tiniscript.base.source import Edit, Source, Span, apply_edits, overlap
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import ENOUGH, Code, Diagnostic, Repair
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

ROUNDS = 20  # of reading what follows a mistake from the repaired text
_CR_ALONE = re.compile(r"\r(?!\n)")
LONGEST = 4_000  # characters of a text that is read as a whole


class Findings(NamedTuple):
    """What is told of a text, and the edits with which the rest of it is read."""

    told: list[Diagnostic]
    edits: list[Edit]


class Wrong:
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
        if len(text) > LONGEST or SEAL in text:
            return None
        return Recovery(text, self.kit, lambda to: self._mistakes(to, is_own=to == text))

    def _mistakes(self, text: str, is_own: bool) -> list[Code]:
        diagnostics = self.diagnostics if is_own else self.check(text)
        return [diagnostic.code for diagnostic in diagnostics if diagnostic.is_mistake]


def told_of(
    source: Source, diagnostics: Sequence[Diagnostic], check: Check, kit: Kit
) -> list[Diagnostic]:
    """Return what is told of a wrong text, of which the parser and the checker say `diagnostics`.

    The readers know one end of a line that is a character: what the text has instead takes as much.
    """
    text = _CR_ALONE.sub("\n", source.text)
    source = Source(text, source.name)
    message = _read(Wrong(source, diagnostics, check, kit), ROUNDS)
    if len(message) > ENOUGH:
        message = sorted(message, key=lambda it: it.span)[: ENOUGH + 1]
    message = [bracketed(item, text, kit, is_offered=True) for item in message]
    message = drop_wrong_offers(message, text, check)  # what is offered is right
    message = conserving(message, text, kit)  # what is made keeps what was written
    message = [bracketed(item, text, kit, is_offered=False) for item in message]
    message = [answered(item, text) for item in message]
    message = with_sample(message, text, kit)  # of a distance that nobody wrote it says: an example
    message = [invisible(item, text) for item in message]
    return codes.in_order([pointed(item, source) for item in message])


def _read(wrong: Wrong, rounds: int) -> list[Diagnostic]:
    """Return what the readers say of a text, and then of what their edits leave wrong."""
    findings = (reader(wrong) for reader in READERS if rounds)
    message, edits = next((each for each in findings if each.told), Findings([], []))
    if not message:
        message = with_usage(wrong.diagnostics, wrong.source, wrong.kit)
    elif len(message) <= ENOUGH:
        rest = apply_edits(wrong.source.text, edits)
        left = wrong.check(rest)
        if any(each.is_mistake for each in left):  # else its warnings come when it is repaired
            later = _read(Wrong(Source(rest), left, wrong.check, wrong.kit), rounds - 1)
            sure = {it for each in message for it in _sure_edits(each)}
            later = [moved_back(each, edits, wrong.source) for each in later]
            guessed = [edit for edit in edits if edit not in sure]
            message = [*message, *(_unless_guessed(each, guessed) for each in later)]
    return dedupe(message, wrong.source)


# -- readers --------------------------------------------------------------------------------------


def _notes(wrong: Wrong) -> Findings:
    """Return notes that begin with another sign: nothing in them is read (`notes`)."""
    return _with_edits(noted(wrong.source))


def _labels(wrong: Wrong) -> Findings:
    """Return what counts the instructions of a text, before each of them (`labels`)."""
    return _with_edits(labelled(wrong.source))


def _keys(wrong: Wrong) -> Findings:
    """Return what is wrong with keys that are asked for (`keys`).

    The rest is read with a key that exists.
    """
    message = asked_keys(wrong.source, wrong.kit)
    edits = _with_edits(message).edits
    return Findings(message, edits + [Edit(it.span, KEYS[0]) for it in message if not it.repair])


def _shares(wrong: Wrong) -> Findings:
    """Return what is wrong with sensors that are asked for a percentage (`shares`)."""
    return Findings(*shares(wrong.source, wrong.kit))


def _beginning(wrong: Wrong) -> Findings:
    """Return what is wrong with the lines before the program, and with its `SI|` (`setup`)."""
    return _with_edits(beginning(wrong.source, wrong.diagnostics, wrong.check, wrong.kit))


def _calls(wrong: Wrong) -> Findings:
    """Return what is wrong with calls that have all their values in another form (`calls`)."""
    names = Names([lexemes(line) for line in wrong.source.text.split("\n")], wrong.kit)
    return _with_edits(misplaced_values(wrong.source) or run_on(wrong.source, names))


def _motors(wrong: Wrong) -> Findings:
    """Return what is wrong with motors that are switched on and off, or one by one (`motors`)."""
    if moves := switched(wrong.source):
        return _with_edits(moves)
    found = one_by_one(wrong.source)
    return Findings([message for message, _ in found], [edit for _, edit in found])


def _turtle(wrong: Wrong) -> Findings:
    """Return what is wrong with lines of Logo, whose words have one number each (`logo`)."""
    return _with_edits(turtle(wrong.source, wrong.kit))


def _given_back(wrong: Wrong) -> Findings:
    """Return what is wrong with DEFs that give a value back (`given_back`)."""
    return Findings(*given_back(wrong.source))


def _counters(wrong: Wrong) -> Findings:
    """Return what is wrong with loops that count, where LOOP counts nothing (`counters`)."""
    return _with_edits(counters(wrong.source))


def _frame(wrong: Wrong) -> Findings:
    """Return what begins a program once more, or ends it, which needs no word (`leftovers`)."""
    return _with_edits(setup_and_end_leftovers(wrong.source, wrong.kit))


def _leftovers(wrong: Wrong) -> Findings:
    """Return words left over in instructions, which are whole without them (`leftovers`)."""
    return _with_edits(leftovers(wrong.source, wrong.kit))


def _wrong_start(wrong: Wrong) -> Findings:
    """Return that another word stands in the place of `SI|` (`setup`); the rest is read with SI."""
    begun = other_word(wrong.source, wrong.diagnostics)
    if begun is None:
        return Findings([], [])
    message = with_usage([begun], wrong.source, wrong.kit)
    return Findings(message, [Edit(begun.span, "SI")])


def _sure_findings(wrong: Wrong) -> Findings:
    """Return what is wrong with a text that is read wholly and surely (`search`, `meant`)."""
    recovery = wrong.recovery
    if recovery is None:
        return Findings([], [])
    return _with_edits(meant_in(wrong.source, wrong.diagnostics, recovery, is_sure=True))


def _words_after(wrong: Wrong) -> Findings:
    """Return what words say after instructions, or in the place of one (`suggestions`)."""
    after = suggested(wrong.source.text, wrong.kit)
    if recovery := wrong.recovery:  # they belong to the instruction by its sign: `X = 20 x 3`
        after = [item for item in after if not recovery.has_signs(item.passed.span.start)]
    return Findings([item.diagnostic for item in after], [item.passed for item in after])


def _likely_findings(wrong: Wrong) -> Findings:
    """Return what is wrong with the lines that are read, if not surely (`search`, `meant`)."""
    recovery = wrong.recovery
    if recovery is None:
        return Findings([], [])
    return _with_edits(meant_in(wrong.source, wrong.diagnostics, recovery, is_sure=False))


def _words_of_blocks(wrong: Wrong) -> Findings:
    """Return misspelt words that begin blocks or end them: the rest is read with them.

    Else what is inside would be told of as well.
    """
    messages = [each for each in wrong.diagnostics if each.code is codes.UNKNOWN_WORD
            and each.values.get("near") in slips.OF_BLOCKS]  # fmt: skip
    return Findings(messages, [Edit(each.span, each.values["near"]) for each in messages])


# Laws of their own come before what a search finds surely, and what it guesses comes last.
READERS: tuple[Callable[[Wrong], Findings], ...] = (
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
        if edit.text.endswith("(TRUE)") and "TRUE" not in (was := source[edit.span].strip()):
            values = {name: text.replace(edit.text, was) for name, text in values.items()}
    place = diagnostic.place and _original_span(diagnostic.place, edits)
    repair = diagnostic.repair
    if repair is not None:
        own = tuple(Edit(_original_span(edit.span, edits), edit.text) for edit in repair.edits)
        passed = [edit for edit in edits if edit.text.isspace()]  # words that nothing may drop
        repair = Repair((), False) if overlap(own, passed) else repair._replace(edits=own)
    return Diagnostic(
        diagnostic.code, _original_span(diagnostic.span, edits), values, place, repair
    )


def _original_span(span: Span, edits: Sequence[Edit]) -> Span:
    """Return where a span of the text with edits stood before them; all of one it begins in."""
    start = end = shift = 0
    for edit in sorted(edits):
        begin = edit.span.start + shift
        behind = begin + len(edit.text)
        shift = behind - edit.span.end
        if span.start >= behind:
            start = shift
        elif span.start > begin:
            start = span.start - edit.span.start
        if span.end > begin:
            end = shift if span.end >= behind else span.end - edit.span.end
    return Span(span.start - start, max(span.start - start, span.end - end))
