"""How a program begins: what stands for its `SI|`, or above it."""

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
from tiniscript.recovery.meanings import CALL_WORDS, Lexeme, Names, lexemes, made, plain, texts
from tiniscript.recovery.orders import block, made_up, orders, written
from tiniscript.recovery.writing import without_note
from tiniscript.syntax.operators import COMPARISONS

SEAL = "~"  # begins a checksum: what has one is copied again
_MOST_CHARACTERS = 4_000  # characters of a first line that are read
_MOST_START_WORDS = 8  # words that say how a program starts
_CALL = re.compile(r"(?i)\s*(?:[FBLRMW]|BEEP)\s*\(")
_BEGUN, _ROW = re.compile(r"(?im)^\s*S[IB]\s*\|"), re.compile(r"\S[^\n]*")
_HEAD_IN_WORDS = re.compile(r"(?i)(s[ií]|sb)[ \t]*[,.:!]?[ \t]+(?=[^\W\d])")
_FRAME_HEADER = re.compile(r"\s*((?:\w+[ \t]+)?(\w+)[ \t]*\([ \t]*(?:void[ \t]*)?\))\s*\{")
_SETUP_INSIDE = re.compile(r"(?i)\s*(S[IB])\b[ \t]*\|?[ \t]*")
_BRACKET_CONTENT = re.compile(r"(?:[^()]|\([^()]*\))*(?=\))")  # brackets that are open before it


Check = Callable[[str], Sequence[Diagnostic]]


def beginning(
    source: Source, diagnostics: Sequence[Diagnostic], check: Check, kit: Kit
) -> list[Diagnostic]:
    """Return what is told of a text by the way that it begins: with it the rest is read."""
    text = setup(source.text)
    if text and text.repair:
        after = check(apply_edits(source.text, text.repair.edits))
        is_call = _CALL.match(source.text, text.repair.edits[0].span.end) is not None
        if is_call or is_better(after, diagnostics, text.repair.edits):
            return [text]
    if framed := _framed(source):
        return [framed]
    if orders := _spoken(source, kit):
        return [orders]
    return _set_before(source, kit) or _titles(source, kit)


def other_word(source: Source, diagnostics: Sequence[Diagnostic]) -> Diagnostic | None:
    """Return what is told of a word before the bar that is no `SI`."""
    first = lexemes(source.text[:_MOST_CHARACTERS].lstrip().partition("\n")[0])[:1]
    is_own = SEAL in source.text or (first and first[0].text in ("SI", "SB"))
    message = (diagnostic for diagnostic in diagnostics if diagnostic.code is codes.SETUP_UNKNOWN)
    return None if is_own else next(message, None)


def setup(text: str) -> Diagnostic | None:
    """Return what is told of the beginning of a program where something stands for its `SI|`."""
    start = len(text) - len(text.lstrip())
    line = text[start:].split("\n", 1)[0]
    body = without_note(line)[0]
    match = re.match(rows.SETUP, body)
    if match is None or match["sep"].strip() == "|":
        return None
    head, sign, rest = plain(match["head"]), match["sep"].strip(), body[match.end() :]
    end = match.end("head") + len(match["sep"].rstrip())
    is_start_word = head in ("SI", "SB")
    is_setup = is_start_word and (not rest or sign in rows.BARS)
    is_separate = match.end() > match.end("head")
    if SEAL in line[end:] or not (is_setup or _begins_instruction(rest, sign, is_separate)):
        return None
    head_meant = head if is_start_word else "SI"
    fix = head_meant + "|"
    span = Span(start, start + end)
    edits = [Edit(span, fix)]
    if sign == "(" and (inside := _BRACKET_CONTENT.match(rest)):
        close = start + match.end() + inside.end()
        edits.append(Edit(Span(close, close + 1), ""))
        fix += text[span.end : close]
    values = {"found": head_meant, "letter" if sign.isalpha() else "sign": sign, "fix": fix}
    is_sure = not any(item.isdecimal() for item in head + sign)
    return Diagnostic(codes.SETUP_NEEDS_BAR, span, values, None, Repair(tuple(edits), is_sure))


def _framed(source: Source) -> Diagnostic | None:
    """Return what is told of `void setup() { … }`, in which a sketch has its beginning.

    What is in its brackets begins the program; `void loop()` after it is a loop.
    """
    head = _FRAME_HEADER.match(source.text)
    if head is None or lexicon_concept(plain(head[2])) != "START":
        return None
    depth = at = 0
    for line in source.text[head.end() - 1 :].splitlines(keepends=True):
        for k, sign in enumerate(without_note(line)[0]):
            depth += (sign == "{") - (sign == "}")
            if not depth:
                return _unframed(source, head, head.end() - 1 + at + k)
        at += len(line)
    return None


def _unframed(source: Source, head: re.Match[str], close: int) -> Diagnostic:
    body = source.text[head.end() : close]
    start_match = _SETUP_INSIDE.match(body)
    setup_text = f"{start_match[1].upper()}|" if start_match else "SI|"
    start = head.end() + (start_match.end() if start_match else len(body) - len(body.lstrip()))
    end = close if start >= close else head.end() + len(body.rstrip(" \t"))
    name = Span(head.start(1), head.end(1))
    edits = (Edit(Span(name.start, min(start, close)), setup_text), Edit(Span(end, close + 1), ""))
    values = {"begun": source[name], "fix": setup_text}
    repair = Repair(edits, True)
    return Diagnostic(codes.SETUP_NEEDS_BAR, name, values, None, repair)


def _spoken(source: Source, kit: Kit) -> Diagnostic | None:
    """Return what is told of a first line that says how it starts and then orders, all in words.

    `SI go forward 2 seconds, then stop` is `SI|F(2, 80);S`: after SI comes the bar. `start and go`
    is SI, too, and `when the button is pressed` is SB.
    """
    row = _ROW.search(source.text)
    body = without_note(row[0])[0].rstrip(" ;\t\r") if row else ""
    if row is None or "(" in body or any(it in body for it in COMPARISONS):
        return None
    names = Names([lexemes(line) for line in source.text.split("\n")], kit)
    if match := _HEAD_IN_WORDS.match(body):
        head, words = plain(match[1]), lexemes(body[match.end() :])
        start_text, values = match[1], {"found": head}
        if block([made("IF"), *words], names, goes_on=False):
            return None
    else:
        words = lexemes(body)
        head, count = _start_in_words(words, names)
        start_text = "".join((it.space or "") + (it.source or "") for it in words[:count]).strip()
        values = {"button": "SB|"} if head == "SB" else {"begun": start_text}
        words = words[count:]
    orders_said = orders(words, names) if head else []
    if not orders_said or (head == "SB" and orders_said[0].word in ("S", "STOP")):
        return None
    fix = f"{head}|{written(orders_said)}"
    sample = made_up(orders_said)
    values |= {"whole": fix, "example": sample} if sample else {"fix": fix}
    place = Span(row.start(), row.start() + len(body))
    start = place.start + body.index(start_text)
    return Diagnostic(
        codes.SETUP_NEEDS_BAR, Span(start, start + len(start_text)), values, place,
        Repair((Edit(place, fix),), False),
    )  # fmt: skip


def _start_in_words(words: Sequence[Lexeme], names: Names) -> tuple[str, int]:
    """Return the start that the first words of a line say, and how many they are."""
    if not words:
        return "", 0
    if names.meant(words[0].text) == "START":
        return "SI", 1
    first = words[:_MOST_START_WORDS]
    button_positions = [k for k, it in enumerate(first) if lexicon_concept(it.text) == "BUTTON"]
    press_positions = [k for k, it in enumerate(first) if lexicon_meaning(it.text, "pressed")]
    if not button_positions or not press_positions or "BUTTON" in names.sensors:
        return "", 0
    end = max(button_positions[0], press_positions[0]) + 1
    actions = {names.meant(it.text) for it in first[:end]} & {*CALL_WORDS, "UNTIL", "S", "STOP"}
    return ("SB", end) if actions in (set(), {"W"}, {"W", "UNTIL"}) else ("", 0)


def _begins_instruction(rest: str, sign: str, is_separate: bool) -> bool:
    """Whether an instruction begins, and no condition; a sign before it says that by itself."""
    match = re.match(r"([^\W\d]\w*)\s*(\(|=|;|$)?", rest)
    if match is None:
        return False
    word, after = plain(match[1]), match[2]
    word_row = WORDS.get(word)
    if word_row is None:
        return bool(sign) and after in ("=", "(")
    is_separate = is_separate and (after is not None or word_row.is_call or word == "DEF")
    return word_row.role.begins and (bool(sign) or after == "(" or is_separate)


def _set_before(source: Source, kit: Kit) -> list[Diagnostic]:
    """Return what is told of variables that are set above `SI|`, with a type before them.

    `int vel = 70;` above `SI|F(2, vel)` is `SI|vel = 70;F(2, vel)`: SI| comes before them.
    """
    start_match = _BEGUN.search(source.text)
    if start_match is None:
        return []
    edits: list[Edit] = []
    sets: list[str] = []
    declared = 0
    for row in _ROW.finditer(source.text[: start_match.start()]):
        line = without_note(row[0])[0].rstrip(" ;\t\r")
        words = lexemes(line)
        if not words:
            continue
        count = next(
            (k for k, it in enumerate(words) if not lexicon_meaning(it.text, "declare")), 0
        )
        size = sum(len((it.space or "") + (it.source or "")) for it in words[:count])
        assignment = line[size:].lstrip()
        signs = texts(words[count + 1 : count + 2])
        if signs != ("=",) or not lines.is_right(
            lexemes(assignment), Names([lexemes(assignment)], kit)
        ):
            return []
        start = row.start() + len(line) - len(assignment)
        edits.append(Edit(Span(row.start(), start), ""))
        sets.append(assignment)
        declared += count
    if not sets or not declared:
        return []
    head = Span(
        start_match.start() + len(start_match[0]) - len(start_match[0].lstrip()), start_match.end()
    )
    setup_text = "".join(source[head].split()).upper()
    edits[0] = edits[0]._replace(text=setup_text)
    edits = [edit for edit in edits if edit.text or edit.span.start < edit.span.end]
    rest = without_note(source.text[start_match.end() :].split("\n")[0])[0].strip(" ;\t\r")
    fix = setup_text + ";".join((*sets, rest))
    repair = Repair((*edits, Edit(head, "")), True)
    return [Diagnostic(codes.SETUP_TWICE, head, {"begun": fix, "found": setup_text}, None, repair)]


def _titles(source: Source, kit: Kit) -> list[Diagnostic]:
    """Return lines before `SI|` that are none of a program: its title, who wrote it."""
    match = _BEGUN.search(source.text)
    diagnostics: list[Diagnostic] = []
    for row in _ROW.finditer(source.text[: match.start() if match else 0]):
        title = without_note(row[0])[0].strip()
        words = lexemes(title)
        if not words:
            continue
        is_assignment = lexicon_meaning(words[0].text, "set") or title.lower().startswith("#define")
        if is_assignment or lines.is_right(words, Names([], kit)) or "(" in title or "{" in title:
            return []
        span, fix = Span(row.start(), row.start() + len(title)), f"// {title}"
        values = {"command": title} if words[0].text == "TSC" else {"fix": fix}
        diagnostics.append(
            Diagnostic(codes.PROSE, span, values, span, Repair((Edit(span, fix),), False))
        )
    return diagnostics
