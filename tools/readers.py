"""The readers of a wrong program: `python -m tools.readers 'SI|REPEAT 4;F(1, 50);END'`.

Follows a text through `recovery.told`: each reader that finds something, the steps in which it
rewrites lines, the resulting codes, and the final messages after the laws.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterable, Iterator

from tiniscript import robots
from tiniscript.base.kit import Kit
from tiniscript.base.source import Source, apply_edits
from tiniscript.diagnostics.codes import Diagnostic
from tiniscript.library.compiling import analyze, check_text
from tiniscript.library.named_robot import robot_of
from tiniscript.recovery import rewrites
from tiniscript.recovery.lines import Step
from tiniscript.recovery.meanings import UNNAMED_END, Lexeme, Names, lexemes, setup_of, texts
from tiniscript.recovery.search import LineChange
from tiniscript.recovery.told import MAX_ROUNDS, READERS, WrongText

WHOLE_LINE_READERS = (
    "_sure_findings",
    "_likely_findings",
)  # the readers that ask `search` for a meaning


def trace(text: str) -> Iterator[str]:
    """Yield lines about the readers of a text, round by round, and their messages."""
    kit = robot_of(text.encode(), robots.load(robots.DEFAULT)).kit
    text_left = text
    for _ in range(MAX_ROUNDS):
        diagnostics = analyze(text_left, kit).diagnostics
        if not any(diagnostic.is_mistake for diagnostic in diagnostics):
            break
        wrong_text = WrongText(
            Source(text_left), diagnostics, lambda text: analyze(text, kit).diagnostics, kit
        )
        findings = ((reader, reader(wrong_text)) for reader in READERS)
        reader, finding = next(
            (found_by_reader for found_by_reader in findings if found_by_reader[1].diagnostics),
            (None, None),
        )
        if reader is None or finding is None:
            yield f"{_line(text_left)}: no reader, so usage.py says what it knows of the mistake"
            break
        yield f"{_line(text_left)}: {reader.__name__.strip('_')}"
        is_whole = reader.__name__ in WHOLE_LINE_READERS
        recovery = wrong_text.recovery if is_whole else None
        if recovery is not None and recovery.chosen_candidate:
            lines = recovery.program.split("\n")
            for change in recovery.chosen_candidate.changes:
                old_text = "\n".join(lines[change.first_line : change.last_line + 1])
                yield from _line_changes(old_text, change, kit)
            messages = ", ".join(map(_told_text, finding.diagnostics))
            yield f"  which slips.py and meant.py tell as {messages or 'nothing'}"
        text_left = apply_edits(text_left, finding.edits)
    yield from map(_diagnostic_text, check_text(text, kit).diagnostics)


def _line_changes(old_text: str, change: LineChange, kit: Kit) -> Iterator[str]:
    """Yield lines about the changes of a text's line, step by step."""
    for step in change.steps:
        yield f"  {_tokens_text(step.old_tokens)}  ->  {_tokens_text(step.new_tokens)}"
        yield f"    by {describe_row(step, kit)}"
    tokens = change.steps[-1].new_tokens if change.steps else lexemes(old_text)
    tokens_with_ends = lexemes(change.text)
    lexemes_before, lexemes_after = (
        line_lexemes[len(setup_of(line_lexemes)) :] for line_lexemes in (tokens, tokens_with_ends)
    )
    if texts(lexemes_before) != texts(lexemes_after):
        yield f"  {_tokens_text(lexemes_before)}  ->  {_tokens_text(lexemes_after)}"
        yield "    by blocks.py, which gives each block its end"


def describe_row(step: Step, kit: Kit) -> str:
    """Return the example of the row that makes a rewrite, or which module makes it without one."""
    setup_length = len(setup_of(step.old_tokens))
    line = rewrites.EncodedLine(step.old_tokens[setup_length:], Names([step.old_tokens], kit))
    for row in rewrites.token_rows():
        for match in line.matches(row.pattern) if row.code is step.code else ():
            rewritten_line = line.apply_row(row, match)
            if (
                rewritten_line is not None
                and texts(rewritten_line) == texts(step.new_tokens)[setup_length:]
            ):
                return f"the row of {_line(' => '.join(row.example))}"
    text = "".join(
        (lexeme.space or "") + (lexeme.source or lexeme.text) for lexeme in step.old_tokens
    )
    for sign_row in rewrites.sign_rows():
        if texts(lexemes(sign_row.pattern.sub(sign_row.replacement, text, count=1))) == texts(
            step.new_tokens
        ):
            return f"the row of {_line(' => '.join(sign_row.example))}"
    is_word = len(step.old_tokens) == len(step.new_tokens)
    return "a word's meaning (meanings.py)" if is_word else "no row (slots.py, or a sign: lines.py)"


def _line(text: str) -> str:
    return text.strip().replace("\n", " ⏎ ")


def _tokens_text(tokens: Iterable[Lexeme]) -> str:
    """Return tokens as a person may know them; `UNNAMED_END` is no word of anybody."""
    return " ".join(
        "(an end)" if token.text == UNNAMED_END and token.source is None else token.text
        for token in tokens
    )


def _told_text(diagnostic: Diagnostic) -> str:
    value = diagnostic.values.get("found", "")
    return f"{diagnostic.code.number} {value}".strip()


def _diagnostic_text(diagnostic: Diagnostic) -> str:
    values = {name: value for name, value in diagnostic.values.items() if value}
    repair_kind = (
        "" if diagnostic.repair is None else "made" if diagnostic.repair.is_sure else "offered"
    )
    return f"{diagnostic.code.number} {values} {repair_kind}".rstrip()


def main(arguments: Iterable[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description="Say who reads a wrong program.")
    parser.add_argument("text", nargs="?", help="a program; without one it is read from stdin")
    text = parser.parse_args(None if arguments is None else [*arguments]).text
    print(*trace(sys.stdin.read() if text is None else text), sep="\n")


if __name__ == "__main__":
    main()
