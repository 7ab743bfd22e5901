"""One message for a name that is written wrongly in several places.

Each place would get the same message with the same repair. The first one names the others' lines,
and its repair changes all of them.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Diagnostic
from tiniscript.source import Edit, Source, Span
from tiniscript.words import BLOCK_ENDS

_NAMES = (
    codes.NAME_WITH_SPACE, codes.BAD_NAME, codes.EMPTY_BRACKETS, codes.RESERVED, codes.SAME_AGAIN,
)  # fmt: skip
_SIGNS = (codes.OTHER_SIGN, codes.ODD_CHARACTER)
_LAST = "|".join(("S", "STOP", "BREAK", *BLOCK_ENDS.values()))  # instructions without brackets
_FULL_STOP = re.compile(rf"(?i)(?:\)|\b(?:{_LAST}))[ \t]{{0,9}}(?P<stop>\.)(?![.\w])")
_ROW = re.compile(r"[^\n]+")

_CALLS = (codes.UNKNOWN_WORD, codes.UNTAUGHT, codes.WHICH_WAY)
MOVES = ("F", "B", "L", "R")
TAUGHT = ("SALTO", "PASO", "BAILE", "JUMP", "STEP", "DANCE")  # by the poster and the lessons
_IN_DEF = re.compile(r"(?i)\bDEF\s{0,9}\(?\s{0,9}(\w+)")
_NAME = re.compile(r"[A-Z][A-Z_]{2,19}[0-9]{0,2}")
# What nobody teaches: words of other languages and of talking.
_NO_NAMES = frozenset((
    "RETURN", "CONTINUE", "CONTINUA", "DELAYMICROSECONDS", "HOLA", "HELLO", "IDEM", "ETC", "NULL",
))  # fmt: skip
_TIMES = re.compile(r"[ \t]*\([ \t]*([0-9]{1,2})[ \t]*\)")
_EMPTY = re.compile(r"[ \t]*\([ \t]*\)")
_DIGITS = "0123456789"
MANY = 6  # of them that an example has


def said_once(found: Sequence[Diagnostic], source: Source) -> list[Diagnostic]:
    """Return the diagnostics with one for each name that several of them are about."""
    groups: dict[tuple[str, str], list[int]] = {}
    for k, each in enumerate(found):
        right = each.values.get("right") or each.values.get("word", "")
        if each.code in _NAMES and right and not each.values.get("fix"):
            groups.setdefault((each.code.number, right), []).append(k)
    kept: list[Diagnostic | None] = list(found)
    for places in groups.values():
        if len(places) > 1:
            kept[places[0]] = _with_places([found[k] for k in places], source)
            for k in places[1:]:
                kept[k] = None
    bare = [k for k, each in enumerate(found) if _is_bare(each, source)]
    if len(bare) > 1:
        first = found[bare[0]]
        words = ", ".join(dict.fromkeys(found[k].values["word"] for k in bare))
        example = "; ".join(found[k].values["fix"] for k in bare[:MANY])
        values = {**first.values, "words": words, "fix": "", "whole": "", "example": example}
        kept[bare[0]] = first._replace(values=values, place=None)
        for k in bare[1:]:
            kept[k] = None
    _unknown(kept)
    _untaught(kept, source)
    _other_name(kept, source)
    _full_stops(kept, source)
    return [each for each in kept if each is not None]


def _unknown(kept: list[Diagnostic | None]) -> None:
    """Say once of a variable that is nowhere set what would be said of it in several places."""
    groups: dict[str, list[int]] = {}
    for k, each in enumerate(kept):
        if each is not None and each.code is codes.UNKNOWN_NAME:
            groups.setdefault(each.values["found"], []).append(k)
    for places in groups.values():
        said = [each.values for k in places if (each := kept[k]) is not None]
        is_same = all(each == said[0] for each in said)
        if is_same and not (said[0].get("near") or said[0].get("first")):
            for k in places[1:]:
                kept[k] = None


def _full_stops(kept: list[Diagnostic | None], source: Source) -> None:
    """Say once of `F(1, 80). W(2).` how instructions end."""
    stops = [
        k
        for k, each in enumerate(kept)
        if each is not None
        and not each.repair
        and each.code in _SIGNS
        and each.values.get("found") == "."
    ]
    if not stops:
        return
    places = [
        Span(row.start() + each.start("stop"), row.start() + each.end("stop"))
        for row in _ROW.finditer(source.text)
        for each in _FULL_STOP.finditer(row[0].partition("//")[0])
    ]
    spans = [each.span for k in stops if (each := kept[k]) is not None]
    if len(places) < 2 or not {*places}.issuperset(spans):
        return
    also = " ".join(f"{start}:{end}" for start, end in places if (start, end) != spans[0])
    values = {"found": ".", "right": ";", "stops": str(len(places)), "also": also}
    kept[stops[0]] = Diagnostic(codes.OTHER_SIGN, spans[0], values)
    for k in stops[1:]:
        kept[k] = None


def _untaught(kept: list[Diagnostic | None], source: Source) -> None:
    """Say once of a word that stands alone in several places that no DEF teaches it.

    Of one that stands alone in one place that may be so, or it is a slip.
    """
    groups: dict[str, list[int]] = {}
    for k, each in enumerate(kept):
        if each is not None and each.code is codes.UNKNOWN_WORD and _stands_alone(each, source):
            groups.setdefault(each.values["found"], []).append(k)
    taught = {each.upper() for each in _IN_DEF.findall(source.text)} if groups else set()
    stems = {each.rstrip(_DIGITS) for each in taught}  # `PASO2`, where there is a DEF PASO1
    for name, places in groups.items():
        first = kept[places[0]]
        assert first is not None
        is_sure = len(places) > 1 or {name, name.rstrip(_DIGITS)} & {*TAUGHT, *stems}
        if name.upper() in taught:
            continue
        if not is_sure:
            is_name = _NAME.fullmatch(name) and name not in _NO_NAMES
            own = name if is_name and name[:3] not in ("END", "FIN") else ""
            kept[places[0]] = first._replace(values={**first.values, "own": own})
            continue
        values = {"name": name}
        times = _TIMES.match(source.text, first.span.end)
        if times is not None and int(times[1]) > 1 and len(places) == 1:
            values["often"] = f"LOOP({times[1]});{name};END_LOOP"
        kept[places[0]] = Diagnostic(codes.UNTAUGHT, first.span, values)
        for k in places[1:]:
            kept[k] = None


def _other_name(kept: list[Diagnostic | None], source: Source) -> None:
    """`DEF JUMP` twice, and one name below that no DEF teaches: it is that of the second."""
    found = [(k, each) for k, each in enumerate(kept) if each is not None and each.is_mistake]
    twice = [(k, each) for k, each in found if each.code is codes.DEF_TWICE]
    calls = [(k, each) for k, each in found if each.code in _CALLS and _is_call(each, source)]
    names = {source[each.span].upper() for _, each in calls}
    if len(twice) != 1 or len(names) != 1:
        return
    place, double = twice[0]
    if any(each.span.start < double.span.start for _, each in calls):
        return
    kept[place] = double._replace(values={**double.values, "called": names.pop()})
    for k, _ in calls:
        kept[k] = None


def _is_call(diagnostic: Diagnostic, source: Source) -> bool:
    """Whether a name that a DEF may have is all of an instruction."""
    text, (start, end) = source.text, diagnostic.span
    before = text[max(0, start - 100) : start].rstrip(" \t")[-1:]
    after = text[end:][:100].lstrip(" \t")[:1]
    name = source[diagnostic.span].upper()
    is_name = _NAME.fullmatch(name) is not None and name not in _NO_NAMES
    return is_name and before in ("", *";\r\n|") and after in ("", *";\r\n")


def _stands_alone(diagnostic: Diagnostic, source: Source) -> bool:
    """Whether nothing is said of an unknown word, which is all of its instruction.

    Brackets may be behind it with how often it is done, or nothing.
    """
    text, (start, end) = source.text, diagnostic.span
    said = {key for key, value in diagnostic.values.items() if value}
    before = text[max(0, start - 100) : start].rstrip(" \t")[-1:]
    bracket = _TIMES.match(text, end) or _EMPTY.match(text, end)
    after = text[bracket.end() if bracket else end :][:100].lstrip(" \t")[:1]
    return said == {"found"} and before in ("", *";\r\n|") and after in ("", *";\r\n")


def _is_bare(diagnostic: Diagnostic, source: Source) -> bool:
    """Whether a word stands without its brackets and without values: `F; R; F`."""
    said = diagnostic.values
    is_one = diagnostic.code is codes.MISSING_OPEN and diagnostic.place is None
    is_one = is_one and bool(said.get("fix"))
    return is_one and source[diagnostic.span].upper() == said["word"] in MOVES


def _with_places(found: Sequence[Diagnostic], source: Source) -> Diagnostic:
    first, *others = found
    line, *rest = [source.position(each.span.start)[0] for each in found]
    lines = [str(each) for each in dict.fromkeys(rest) if each != line]
    also = " ".join(f"{each.span.start}:{each.span.end}" for each in others)
    values = {**first.values, "also": also, "times": str(len(found))}
    if len(lines) > 1:
        values["lines"] = ", ".join(lines)
    elif lines:
        values["line"] = lines[0]
    return first._replace(values=values)


def edits_elsewhere(diagnostic: Diagnostic, edit: Edit) -> list[Edit]:
    """Return the changes of the other places that a diagnostic is about, too."""
    spans = [each.split(":") for each in diagnostic.values.get("also", "").split()]
    return [Edit(Span(int(start), int(end)), edit.text) for start, end in spans]
