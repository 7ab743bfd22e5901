"""The beginning of a program: replacements of its `SI|`, and text above it."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence

from tiniscript.base.kit import Kit
from tiniscript.base.source import Edit, Source, Span, apply_edits
from tiniscript.base.words import WORDS, lexicon_concept, lexicon_meaning
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Diagnostic, Repair
from tiniscript.diagnostics.fixing import is_better
from tiniscript.recovery import lines, rows
from tiniscript.recovery.instructions import (
    block,
    instructions_text,
    samples_text,
    spoken_instructions,
)
from tiniscript.recovery.meanings import (
    CALL_WORDS,
    Lexeme,
    Names,
    lexemes,
    make_token,
    plain,
    texts,
)
from tiniscript.recovery.writing import split_note
from tiniscript.syntax.operators import COMPARISONS

SEAL = "~"  # begins a checksum: such a line is copied again
_MAX_CHARACTERS = 4_000  # characters of a first line that are read
_MAX_START_WORDS = 8  # words about the start of a program
_CALL = re.compile(r"(?i)\s*(?:[FBLRMW]|BEEP)\s*\(")
_SETUP, _LINE = re.compile(r"(?im)^\s*S[IB]\s*\|"), re.compile(r"\S[^\n]*")
_HEAD_IN_WORDS = re.compile(r"(?i)(s[ií]|sb)[ \t]*[,.:!]?[ \t]+(?=[^\W\d])")
_FRAME_HEADER = re.compile(r"\s*((?:\w+[ \t]+)?(\w+)[ \t]*\([ \t]*(?:void[ \t]*)?\))\s*\{")
_SETUP_INSIDE = re.compile(r"(?i)\s*(S[IB])\b[ \t]*\|?[ \t]*")
_BRACKET_CONTENT = re.compile(r"(?:[^()]|\([^()]*\))*(?=\))")  # brackets that are open before it


Check = Callable[[str], Sequence[Diagnostic]]


def beginning_diagnostics(
    source: Source, diagnostics: Sequence[Diagnostic], check: Check, kit: Kit
) -> list[Diagnostic]:
    """Return the diagnostics for the beginning of a text, with which the rest is read."""
    setup_problem = setup_diagnostic(source.text)
    if setup_problem and setup_problem.repair:
        diagnostics_after = check(apply_edits(source.text, setup_problem.repair.edits))
        is_call = _CALL.match(source.text, setup_problem.repair.edits[0].span.end) is not None
        if is_call or is_better(diagnostics_after, diagnostics, setup_problem.repair.edits):
            return [setup_problem]
    if frame_problem := _frame_diagnostic(source):
        return [frame_problem]
    if spoken_problem := _spoken_diagnostic(source, kit):
        return [spoken_problem]
    return _assignments_before_setup(source, kit) or _titles(source, kit)


def wrong_setup_word(source: Source, diagnostics: Sequence[Diagnostic]) -> Diagnostic | None:
    """Return the diagnostics for a word before the bar other than `SI`."""
    first_lexemes = lexemes(source.text[:_MAX_CHARACTERS].lstrip().partition("\n")[0])[:1]
    has_setup = SEAL in source.text or (first_lexemes and first_lexemes[0].text in ("SI", "SB"))
    setup_diagnostics = (
        diagnostic for diagnostic in diagnostics if diagnostic.code is codes.SETUP_UNKNOWN
    )
    return None if has_setup else next(setup_diagnostics, None)


def setup_diagnostic(text: str) -> Diagnostic | None:
    """Return the diagnostic for a program that begins with something instead of `SI|`."""
    start = len(text) - len(text.lstrip())
    line = text[start:].split("\n", 1)[0]
    body = split_note(line)[0]
    match = re.match(rows.SETUP, body)
    if match is None or match["sep"].strip() == "|":
        return None
    head, sign, text_after = plain(match["head"]), match["sep"].strip(), body[match.end() :]
    end = match.end("head") + len(match["sep"].rstrip())
    is_start_word = head in ("SI", "SB")
    is_setup = is_start_word and (not text_after or sign in rows.BARS)
    is_separate = match.end() > match.end("head")
    if SEAL in line[end:] or not (is_setup or _begins_instruction(text_after, sign, is_separate)):
        return None
    head_meant = head if is_start_word else "SI"
    fix = head_meant + "|"
    span = Span(start, start + end)
    edits = [Edit(span, fix)]
    if sign == "(" and (content_match := _BRACKET_CONTENT.match(text_after)):
        close_offset = start + match.end() + content_match.end()
        edits.append(Edit(Span(close_offset, close_offset + 1), ""))
        fix += text[span.end : close_offset]
    values = {"found": head_meant, "letter" if sign.isalpha() else "sign": sign, "fix": fix}
    is_sure = not any(item.isdecimal() for item in head + sign)
    return Diagnostic(codes.SETUP_NEEDS_BAR, span, values, None, Repair(tuple(edits), is_sure))


def _frame_diagnostic(source: Source) -> Diagnostic | None:
    """Return the diagnostic for `void setup() { … }` at the beginning of a sketch.

    The text in its brackets begins the program; `void loop()` after it is a loop.
    """
    head = _FRAME_HEADER.match(source.text)
    if head is None or lexicon_concept(plain(head[2])) != "START":
        return None
    depth = line_offset = 0
    for line in source.text[head.end() - 1 :].splitlines(keepends=True):
        for k, sign in enumerate(split_note(line)[0]):
            depth += (sign == "{") - (sign == "}")
            if not depth:
                return _frame_repair(source, head, head.end() - 1 + line_offset + k)
        line_offset += len(line)
    return None


def _frame_repair(source: Source, head: re.Match[str], close_offset: int) -> Diagnostic:
    body = source.text[head.end() : close_offset]
    start_match = _SETUP_INSIDE.match(body)
    setup_text = f"{start_match[1].upper()}|" if start_match else "SI|"
    start = head.end() + (start_match.end() if start_match else len(body) - len(body.lstrip()))
    end = close_offset if start >= close_offset else head.end() + len(body.rstrip(" \t"))
    name_span = Span(head.start(1), head.end(1))
    edits = (
        Edit(Span(name_span.start, min(start, close_offset)), setup_text),
        Edit(Span(end, close_offset + 1), ""),
    )
    values = {"begun": source[name_span], "fix": setup_text}
    repair = Repair(edits, True)
    return Diagnostic(codes.SETUP_NEEDS_BAR, name_span, values, None, repair)


def _spoken_diagnostic(source: Source, kit: Kit) -> Diagnostic | None:
    """Return the diagnostic for a first line that describes the start, then instructions in words.

    `SI go forward 2 seconds, then stop` is `SI|F(2, 80);S`: after SI comes the bar. `start and go`
    is SI, too, and `when the button is pressed` is SB.
    """
    line_match = _LINE.search(source.text)
    body = split_note(line_match[0])[0].rstrip(" ;\t\r") if line_match else ""
    if line_match is None or "(" in body or any(sign in body for sign in COMPARISONS):
        return None
    names = Names([lexemes(line) for line in source.text.split("\n")], kit)
    if match := _HEAD_IN_WORDS.match(body):
        head, words = plain(match[1]), lexemes(body[match.end() :])
        start_text, values = match[1], {"found": head}
        if block([make_token("IF"), *words], names, goes_on=False):
            return None
    else:
        words = lexemes(body)
        head, count = _start_in_words(words, names)
        start_text = "".join(
            (word.space or "") + (word.source or "") for word in words[:count]
        ).strip()
        values = {"button": "SB|"} if head == "SB" else {"begun": start_text}
        words = words[count:]
    stated_instructions = spoken_instructions(words, names) if head else []
    if not stated_instructions or (head == "SB" and stated_instructions[0].word in ("S", "STOP")):
        return None
    fix = f"{head}|{instructions_text(stated_instructions)}"
    sample = samples_text(stated_instructions)
    values |= {"whole": fix, "example": sample} if sample else {"fix": fix}
    line_span = Span(line_match.start(), line_match.start() + len(body))
    start = line_span.start + body.index(start_text)
    return Diagnostic(
        codes.SETUP_NEEDS_BAR, Span(start, start + len(start_text)), values, line_span,
        Repair((Edit(line_span, fix),), False),
    )  # fmt: skip


def _start_in_words(words: Sequence[Lexeme], names: Names) -> tuple[str, int]:
    """Return the start that the first words of a line say, and how many they are."""
    if not words:
        return "", 0
    if names.find_meaning(words[0].text) == "START":
        return "SI", 1
    first_words = words[:_MAX_START_WORDS]
    button_positions = [
        k for k, word in enumerate(first_words) if lexicon_concept(word.text) == "BUTTON"
    ]
    press_positions = [
        k for k, word in enumerate(first_words) if lexicon_meaning(word.text, "pressed")
    ]
    if not button_positions or not press_positions or "BUTTON" in names.sensors:
        return "", 0
    word_count = max(button_positions[0], press_positions[0]) + 1
    actions = {names.find_meaning(word.text) for word in first_words[:word_count]} & {
        *CALL_WORDS,
        "UNTIL",
        "S",
        "STOP",
    }
    return ("SB", word_count) if actions in (set(), {"W"}, {"W", "UNTIL"}) else ("", 0)


def _begins_instruction(text_after: str, sign: str, is_separate: bool) -> bool:
    """Return whether an instruction begins, not a condition; a sign before it is enough."""
    match = re.match(r"([^\W\d]\w*)\s*(\(|=|;|$)?", text_after)
    if match is None:
        return False
    word, sign_after = plain(match[1]), match[2]
    word_row = WORDS.get(word)
    if word_row is None:
        return bool(sign) and sign_after in ("=", "(")
    is_separate = is_separate and (sign_after is not None or word_row.is_call or word == "DEF")
    return word_row.role.can_start_item and (bool(sign) or sign_after == "(" or is_separate)


def _assignments_before_setup(source: Source, kit: Kit) -> list[Diagnostic]:
    """Return the diagnostics for typed variables assigned above `SI|`.

    `int vel = 70;` above `SI|F(2, vel)` is `SI|vel = 70;F(2, vel)`: SI| comes before them.
    """
    start_match = _SETUP.search(source.text)
    if start_match is None:
        return []
    edits: list[Edit] = []
    assignments: list[str] = []
    declaring_word_count = 0
    for line_match in _LINE.finditer(source.text[: start_match.start()]):
        line = split_note(line_match[0])[0].rstrip(" ;\t\r")
        words = lexemes(line)
        if not words:
            continue
        count = next(
            (k for k, word in enumerate(words) if not lexicon_meaning(word.text, "declare")), 0
        )
        prefix_length = sum(len((word.space or "") + (word.source or "")) for word in words[:count])
        assignment = line[prefix_length:].lstrip()
        signs = texts(words[count + 1 : count + 2])
        if signs != ("=",) or not lines.is_right(
            lexemes(assignment), Names([lexemes(assignment)], kit)
        ):
            return []
        start = line_match.start() + len(line) - len(assignment)
        edits.append(Edit(Span(line_match.start(), start), ""))
        assignments.append(assignment)
        declaring_word_count += count
    if not assignments or not declaring_word_count:
        return []
    setup_span = Span(
        start_match.start() + len(start_match[0]) - len(start_match[0].lstrip()), start_match.end()
    )
    setup_text = "".join(source[setup_span].split()).upper()
    edits[0] = edits[0]._replace(text=setup_text)
    edits = [edit for edit in edits if edit.text or edit.span.start < edit.span.end]
    text_behind = split_note(source.text[start_match.end() :].split("\n")[0])[0].strip(" ;\t\r")
    fix = setup_text + ";".join((*assignments, text_behind))
    repair = Repair((*edits, Edit(setup_span, "")), True)
    return [
        Diagnostic(codes.SETUP_TWICE, setup_span, {"begun": fix, "found": setup_text}, None, repair)
    ]


def _titles(source: Source, kit: Kit) -> list[Diagnostic]:
    """Return lines before `SI|` that are not part of a program: its title, its author."""
    match = _SETUP.search(source.text)
    diagnostics: list[Diagnostic] = []
    for line_match in _LINE.finditer(source.text[: match.start() if match else 0]):
        title = split_note(line_match[0])[0].strip()
        words = lexemes(title)
        if not words:
            continue
        is_assignment = lexicon_meaning(words[0].text, "set") or title.lower().startswith("#define")
        if is_assignment or lines.is_right(words, Names([], kit)) or "(" in title or "{" in title:
            return []
        span, fix = Span(line_match.start(), line_match.start() + len(title)), f"// {title}"
        values = {"command": title} if words[0].text == "TSC" else {"fix": fix}
        diagnostics.append(
            Diagnostic(codes.PROSE, span, values, span, Repair((Edit(span, fix),), False))
        )
    return diagnostics
