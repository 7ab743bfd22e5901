"""Where the thing to try of a diagnostic stands: the changes of the text that it asks for.

Knows for each code what its repair replaces. What is only an example (`F(2, 80)` for F alone), or
names two ways, is no change. Does not know whether a repair is meant: `fixing` decides that.
"""

from __future__ import annotations

import re
from collections.abc import Callable

from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Code, Diagnostic
from tiniscript.repairs.braces import without_braces
from tiniscript.repairs.copied import without_pasted
from tiniscript.repairs.everywhere import edits_elsewhere
from tiniscript.source import Edit, Source, Span

Edits = list[Edit] | None

_NEAR = 80  # characters before a value in which its word is looked for
_CALL = re.compile(r"[A-Za-z_]\w*\s*\([^()\r\n]*$")  # up to a value in brackets
_WORD_BEFORE = re.compile(r"[A-Za-z_]\w*\s*$")
_TO_ITS_END = re.compile(r"[^;\r\n{}]*")


def edits_of(diagnostic: Diagnostic, source: Source) -> Edits:
    """Return the changes that the thing to try asks for; None where it is no change of the text."""
    if diagnostic.repair is not None:
        return [*diagnostic.repair.edits]
    if diagnostic.place is not None and diagnostic.values.get("block"):
        return [Edit(diagnostic.place, diagnostic.values["block"])]  # see `whole_blocks`
    place = _PLACES.get(diagnostic.code)
    edits = None if place is None else place(diagnostic, source)
    return [*edits, *edits_elsewhere(diagnostic, edits[0])] if edits else edits


def _span(diagnostic: Diagnostic, source: Source) -> Edits:
    """The span becomes what is right."""
    values = diagnostic.values
    new = values.get("right") or values.get("near") or ""
    new = values.get("fix", new)
    if new.isalpha() and diagnostic.code is codes.OTHER_SIGN:  # `A&&B`
        before, after = (
            source.text[: diagnostic.span.start][-1:],
            source.text[diagnostic.span.end :][:1],
        )
        new = " " * (before.isalnum() or before == "_") + new + " " * after.isalnum()
    return [Edit(diagnostic.place or diagnostic.span, new)] if new else None


def _own(diagnostic: Diagnostic, source: Source) -> Edits:
    """The call that a value or a pair of brackets belongs to becomes what is right."""
    fix, text = diagnostic.values.get("fix", ""), source.text
    if not fix:
        return None
    if diagnostic.place is not None:
        return [Edit(diagnostic.place, fix)]
    start, end = diagnostic.span
    head = fix.partition("(")[0].upper()
    if text[start:end].startswith("("):
        begin = max(0, start - _NEAR)
        word = _WORD_BEFORE.search(text[begin:start])
        if word is None or word[0].strip().upper() != head:
            return None
        return [Edit(Span(begin + word.start(), end), fix)]
    if "UNTIL" not in fix:
        end = _end_of_call(text, start) or end
    return [Edit(Span(start, end), fix)]


def _around(diagnostic: Diagnostic, source: Source) -> Edits:
    """The whole call around a value becomes what is right: `F(-2, 80)`."""
    fix = diagnostic.values.get("fix", "")
    begin = max(0, diagnostic.span.start - _NEAR)
    call = _CALL.search(source.text[begin : diagnostic.span.start])
    end = _end_of_call(source.text, begin + call.start()) if call else None
    return [Edit(Span(begin + call.start(), end), fix)] if fix and call and end else None


def _taken_out(diagnostic: Diagnostic, source: Source) -> Edits:
    """The span is too much, and the spaces behind it."""
    if diagnostic.values.get("between"):
        return None
    if diagnostic.place is not None and "fix" in diagnostic.values:  # `¿DISTANCE < 20?`
        return [Edit(diagnostic.place, diagnostic.values["fix"])]
    start, end = diagnostic.span
    if source[diagnostic.span].isdecimal():
        return None  # `4 F(2, 80)` may mean four times
    if _is_inside_a_word(source.text, start, end):
        return None  # `potencia:80` would become one word
    while source.text[end : end + 1] == " " and (not start or source.text[start - 1] in " \r\n"):
        end += 1
    return [Edit(Span(start, end), "")]


def _is_inside_a_word(text: str, start: int, end: int) -> bool:
    return text[max(0, start - 1) : start].isalnum() and text[end : end + 1].isalnum()


def _extra_word(diagnostic: Diagnostic, source: Source) -> Edits:
    """A word between instructions becomes the `;` that is meant; one before or after goes."""
    if diagnostic.place is not None:
        return _assigned(diagnostic, source)
    start, end = diagnostic.span
    text = source.text
    before = text[:start].rstrip(" \t")
    after = text[end:].lstrip(" \t")
    begins = not before or before[-1] in ";|\r\n"
    if diagnostic.values.get("fix") or begins:
        return [Edit(Span(start, len(text) - len(after)), "")]
    new = "" if not after or after[0] in ";\r\n" or after.startswith("//") else ";"
    return [Edit(Span(len(before), end), new)]


def _separator(diagnostic: Diagnostic, source: Source) -> Edits:
    """A `;` goes between two instructions, or in the place of the sign between them."""
    if diagnostic.values.get("fix"):
        return _span(diagnostic, source)
    start, end = diagnostic.span
    if source.text[start:end] in (",", ".", ":"):
        return [Edit(diagnostic.span, ";")]
    start = len(source.text[:start].rstrip(" \t"))
    return [Edit(Span(start, start), ";")]


def _close(diagnostic: Diagnostic, source: Source) -> Edits:
    if diagnostic.values.get("fix"):
        return _span(diagnostic, source)
    end = diagnostic.span.end
    return [Edit(Span(end, end), ")")]


def _written(new: str) -> Callable[[Diagnostic, Source], Edits]:
    """The span becomes this sign."""
    return lambda diagnostic, source: [Edit(diagnostic.span, new)]


def _setup(diagnostic: Diagnostic, source: Source) -> Edits:
    start, end = diagnostic.span
    if source.text[end : end + 1] != "|":
        return None
    return [Edit(Span(start, end + 1), diagnostic.values["right"])]


def _word(diagnostic: Diagnostic, source: Source) -> Edits:
    return [Edit(diagnostic.span, diagnostic.values["word"])]


def _note(diagnostic: Diagnostic, source: Source) -> Edits:
    """The sign of another note becomes `//`: all of the note stays."""
    start, end = diagnostic.span
    text = source[diagnostic.span]
    edits = [Edit(Span(start, start + len(diagnostic.values["found"])), "//")]
    if text.startswith("/*"):
        is_last = source.text[end : end + 1] in ("", "\r", "\n")
        if "\n" in text or "\r" in text or not (is_last and text.endswith("*/")):
            return None
        edits.append(Edit(Span(end - 2, end), ""))
    return edits


def _other_word(diagnostic: Diagnostic, source: Source) -> Edits:
    """A word of another language, and its values where the repair has some."""
    fix = diagnostic.values.get("fix", "")
    if diagnostic.place is not None or "(" not in fix:
        return _span(diagnostic, source)
    return _own(diagnostic, source)


def _braces(diagnostic: Diagnostic, source: Source) -> Edits:
    if diagnostic.values.get("fix"):
        return _span(diagnostic, source)
    return without_braces(source.text)


def _wrong_end(diagnostic: Diagnostic, source: Source) -> Edits:
    if diagnostic.values.get("fix"):
        return _span(diagnostic, source)
    if diagnostic.values.get("after"):
        values = diagnostic.values
        return _end_below(values["right"], source, int(values["after"]), int(values["line"]))
    start = diagnostic.span.start
    return [Edit(Span(start, start), diagnostic.values["right"] + ";")]


def _assigned(diagnostic: Diagnostic, source: Source) -> Edits:
    fix = diagnostic.values.get("fix", "")
    return [Edit(diagnostic.place, fix)] if fix and diagnostic.place else None


def _missing_end(diagnostic: Diagnostic, source: Source) -> Edits:
    """The end of a block, below the line that the message names."""
    number = diagnostic.values.get("line", "")
    if not number:
        return None
    header = source.position(diagnostic.span.start)[0]
    return _end_below(diagnostic.values["right"], source, int(number), header)


def _end_below(end: str, source: Source, number: int, header: int) -> Edits:
    """An end on a line of its own below a line, as far in as the line of its block's header."""
    text = source.text
    lines = text.splitlines(keepends=True)
    place = sum(len(line) for line in lines[:number])
    above = lines[number - 1]
    bare = above.rstrip("\r\n")
    line_end = above[len(bare) :] or ("\r\n" if "\r\n" in text else "\n")
    head = source.line_text(header)
    indent = head[: len(head) - len(head.lstrip())]
    if above == bare:  # the last line of a file that has no line end there
        return [Edit(Span(place, place), f"{line_end}{indent}{end}")]
    return [Edit(Span(place, place), f"{indent}{end}{line_end}")]


def _end_of_call(text: str, start: int) -> int | None:
    """Return where the call at `start` ends; None where it has no brackets."""
    begin = _TO_ITS_END.match(text, start)
    opened = text.find("(", start, begin.end() if begin else start)
    if opened < 0 or not text[start:opened].strip().isidentifier():
        return None
    depth = 0
    for k in range(opened, len(text)):
        depth += (text[k] == "(") - (text[k] == ")")
        if not depth:
            return k + 1
        if text[k] in ";\r\n":
            break
    return None


_PLACES: dict[Code, Callable[[Diagnostic, Source], Edits]] = {
    codes.ODD_CHARACTER: _taken_out,
    codes.QUOTE: _span,
    codes.OTHER_NOTE: _note,
    codes.BAD_NUMBER: _span,
    codes.BAD_NAME: _span,
    codes.OTHER_SIGN: _span,
    codes.DECIMAL_COMMA: _own,
    codes.MISSING_SEPARATOR: _separator,
    codes.HEADER_SEPARATOR: _separator,
    codes.MISSING_OPEN: _own,
    codes.MISSING_CLOSE: _close,
    codes.MISSING_COMMA: _own,
    codes.MISSING_VALUE: _assigned,
    codes.MISSING_SIGN: _assigned,
    codes.SEMICOLON_INSIDE: _written(","),
    codes.ARGUMENT_COUNT: _own,
    codes.ELSE_IF: _assigned,
    codes.END_SPLIT: _span,
    codes.END_ALONE: _span,
    codes.NEVER_ENDS: _missing_end,
    codes.WRONG_END: _wrong_end,
    codes.EMPTY_BRACKETS: _word,
    codes.UNTIL_ALONE: _assigned,
    codes.SETUP_UNKNOWN: _setup,
    codes.CHAINED: _assigned,
    codes.NO_BRACKETS_HERE: _assigned,
    codes.NO_VALUE: _assigned,
    codes.EXTRA_CLOSE: _taken_out,
    codes.NOT_AN_INSTRUCTION: _assigned,
    codes.EXTRA_WORD: _extra_word,
    codes.SPANISH_IF: _assigned,
    codes.BRACES: _braces,
    codes.UNIT: _span,
    codes.OTHER_ASSIGNMENT: _assigned,
    codes.NAMED_ARGUMENT: _span,
    codes.LINE_NUMBER: _taken_out,
    codes.BAR_BETWEEN: _written(";"),
    codes.SIGN_BETWEEN: _written(";"),
    codes.REPEATED: _span,
    codes.LOOP_COUNTS: _span,
    codes.ASKED_BEHIND: _assigned,
    codes.NEEDLESS_FRAME: _assigned,
    codes.CASES: _assigned,
    codes.LISTS: _span,
    codes.CHOICE_IN_VALUE: _span,
    codes.WORDS_SHOWN: _assigned,
    codes.QUESTION_BEHIND: _assigned,
    codes.PASTED: lambda diagnostic, source: without_pasted(source.text) or None,
    codes.PROSE: _span,
    codes.SEVERAL_ORDERS: _span,
    codes.OTHER_CALL: _span,
    codes.GROUPED: _span,
    codes.BY_CHANCE: _span,
    codes.SET_TOGETHER: _span,
    codes.WORDS_BEHIND: _span,
    codes.SAME_AGAIN: _span,
    codes.NAME_WITH_SPACE: _span,
    codes.NOT_CALLABLE: lambda found, source: (
        _span(found, source) if "times" in found.values else None
    ),
    codes.MISSING_EQUALS: _span,
    codes.UNKNOWN_WORD: _span,
    codes.OTHER_LANGUAGE: _other_word,
    codes.UNKNOWN_NAME: _span,
    codes.OUT_OF_RANGE: _around,
    codes.FOREVER_NOT_HERE: _span,
    codes.WANTS_CONDITION: _span,
    codes.MIXED_COMPARE: _span,
}
