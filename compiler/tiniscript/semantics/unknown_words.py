"""Reports unknown commands, and commands with wrong values.

Knows what was probably meant, and suggests it. The checker knows what a correct program means, and
calls this module for mistakes.
"""

from __future__ import annotations

import re
from collections.abc import Set as AbstractSet
from itertools import chain, takewhile

from tiniscript.diagnostics import codes
from tiniscript.recovery.concepts import meant_by, said_of
from tiniscript.semantics.counts import LONG_TIME_S
from tiniscript.semantics.named_values import value_of
from tiniscript.semantics.symbols import ENOUGH, Scope
from tiniscript.source import Span
from tiniscript.syntax import ast
from tiniscript.syntax.lexer import WORD, scan
from tiniscript.words import (
    BLOCK_ENDS,
    NEAR_WORDS,
    NOTE_WORDS,
    PLACEHOLDERS,
    POWER_WORDS,
    WORDS,
    Word,
    names_of,
    said_instead,
)

_DIGITS = "0123456789"
MOST_POWER = 100
MANY_TIMES = 20  # that a DEF is done by hand in a class
# Short for derecha, izquierda, parar, esperar …, and what pupils say of the way that they go.
_SHORT = {
    "D": "R", "I": "L", "P": "S", "E": "W", "DE": "R", "IZ": "L", "ES": "W", "AD": "F", "AV": "F",
    "AT": "B", "RE": "B", "BP": "BEEP", "BE": "BEEP", "BIIP": "BEEP",
    "VE": "F", "VOY": "F", "VAMOS": "F", "VAYA": "F", "DALE": "F",
    "VUELVE": "B", "VUELVO": "B", "VOLVER": "B", "V": "B",
}  # fmt: skip
_KEYS = re.compile("(?!FOR$)[FBLR]{2,8}")  # as the keys of another robot: `FFLFF`
_CURVES = frozenset(("FL", "LF", "FR", "RF"))  # both at once


def report_unknown(scope: Scope, node: ast.Command, inside: str | None) -> None:
    """Report a command that is neither a word nor a known name; `inside` is the DEF around it."""
    word, span = node.word, node.word_span
    if word == inside:
        scope.report(codes.CALLS_ITSELF, span, name=word)
    elif word in scope.def_names:
        scope.report(codes.CALL_BEFORE_DEF, span, name=word)
    elif word in scope.set_somewhere:
        scope.report(codes.VARIABLE_ALONE, span, name=word)
    else:
        _report_unknown_word(scope, node)


def _report_unknown_word(scope: Scope, node: ast.Command) -> None:
    word, span = node.word, node.word_span
    meant = meant_by(word)
    if (said_of(word, "turn") or meant == "F") and _report_way(scope, node):
        return
    if meant is not None and (meant in WORDS or meant in scope.names):
        _report_foreign(scope, node, meant)
        return
    own = whole_name(scope, word, scope.def_names) if node.arguments is None else ""
    if own:  # `VUELTA`, where there is a DEF MEDIA_VUELTA
        scope.report(codes.UNKNOWN_WORD, span, found=word, near=own)
        return
    if said_of(word, "turn") or word in ("VUELTA", "VUELTAS"):
        scope.report(codes.WHICH_WAY, span, None, **_both_ways(scope, node))
        return
    commands = [each.text for each in WORDS.values() if each.role not in
                ("setup", "later", "value", "operator", "function", "forever")]  # fmt: skip
    near = scope.near(word, chain(commands, scope.names, scope.def_names))
    is_own = near in scope.set_somewhere or near in scope.def_names
    if is_own and near.rstrip(_DIGITS) == word.rstrip(_DIGITS):
        near = ""  # `PASO2`, where there is a DEF PASO1
    glued_loop = re.fullmatch(r"LOOP_?([0-9]+)", word)
    if glued_loop and node.arguments is None:
        near = f"LOOP({glued_loop[1]})"
    is_held = len(word) <= 3 and len(set(word)) == 1  # `FF(2, 80)`: a key that was held
    letter = word[0] if is_held and word[0] in WORDS else _SHORT.get(word, "")
    if letter and len(node.arguments or ()) == len(WORDS[letter].arguments):
        near = letter
    texts = [scope.source[each.span] for each in node.arguments or ()]
    if word in _CURVES and len(texts) == 2 and texts[1].isdecimal():
        less = str(int(texts[1][:9]) // 2)
        powers = (less, texts[1]) if "L" in word else (texts[1], less)
        curve = f"M({', '.join(powers)});W({texts[0]});S"
        scope.report(codes.UNKNOWN_WORD, span, None, found=word, near="", curve=curve)
        return
    if word == "A" and len(texts) == 2:  # adelante, or atrás
        ahead, back = (f"{each}({', '.join(texts)})" for each in "FB")
        scope.report(codes.UNKNOWN_WORD, span, None, found=word, near="", ahead=ahead, back=back)
        return
    if node.arguments is None and _KEYS.fullmatch(word) and not near:
        apart = "; ".join(f"{letter}(1, 60)" for letter in word)
        scope.report(codes.UNKNOWN_WORD, span, None, found=word, near="", apart=apart)
        return
    values = {
        "found": scope.source[span].upper(),
        "near": near,
        **({} if near else said_instead(word)),
    }
    scope.report(codes.UNKNOWN_WORD, span, None, **values)


def _both_ways(scope: Scope, node: ast.Command) -> dict[str, str]:
    """`girar(2, 80)`: return the turns to both sides, nothing where the 2 is no time."""
    texts = [scope.source[each.span] for each in node.arguments or ()]
    if len(texts) != 2 or not all(each.replace(".", "", 1).isdecimal() for each in texts):
        return {}
    if float(texts[0]) >= LONG_TIME_S or float(texts[1]) > MOST_POWER:
        return {}
    return {
        f"to_{way}": f"{word}({texts[0]}, {texts[1]})"
        for way, word in (("left", "L"), ("right", "R"))
    }


def _report_foreign(scope: Scope, node: ast.Command, meant: str) -> None:
    """`ADELANTE(5)`, `delay(1000)`, `DISTANCIA`: the same in a word of the language or the kit."""
    said = {"milli": node.word} if said_of(node.word, "milliseconds") else {}
    usage = WORDS[meant].usage if meant in WORDS else meant
    scope.report(codes.OTHER_LANGUAGE, node.word_span, node.span, found=node.word, right=meant,
                 usage=usage, **said)  # fmt: skip


def _report_way(scope: Scope, node: ast.Command) -> bool:
    """`girar(derecha, 90)`, `mover(adelante, 2, 80)`: the first value says the word."""
    arguments = node.arguments or ()
    texts = [scope.source[each.span] for each in arguments]
    meant = WORDS.get(meant_by(texts[0].upper()) or "") if texts else None
    if meant is None or meant.role != "move":
        return False
    if meant.text in ("L", "R"):
        way = "left" if meant.text == "L" else "right"
        scope.report(codes.WHICH_WAY, node.word_span, word=meant.text, way=way, usage=meant.usage)
        return True
    found = f"{node.word}({texts[0]})"
    scope.report(codes.OTHER_LANGUAGE, node.word_span, node.span, found=found, right=meant.text,
                 usage=meant.usage)  # fmt: skip
    return True


def report_placeholders(scope: Scope, node: ast.Command, word: Word, said: int) -> None:
    """`F(tiempo, potencia)`: these names stand for numbers. Drops the diagnostics since `said`."""
    texts = [scope.source[each.span].upper() for each in node.arguments or ()]
    names = [PLACEHOLDERS.get(its.name, ()) for its in word.arguments]
    if len(texts) == len(names) and all(
        text in its for text, its in zip(texts, names, strict=True)
    ):
        del scope.diagnostics[said:]
        scope.report(codes.PLACEHOLDER, node.span, usage=word.usage, example=word.example)


def report_named_arguments(scope: Scope, node: ast.Command, word: Word, said: int) -> None:
    """`F(t=2, p=80)`: values have no names here. Drops the diagnostics since `said`."""
    codes_of_names = (codes.UNKNOWN_NAME, codes.OTHER_LANGUAGE)  # `TIEMPO` is TIME elsewhere
    unknown = {each.span for each in scope.diagnostics[said:] if each.code in codes_of_names}
    values: dict[str, str] = {}
    names = [its.name for its in word.arguments]
    count = 0
    for argument, slot in zip(node.arguments or (), names, strict=False):
        first, last = argument.expression[0], argument.expression[-1]
        name = Span(first.start, first.end)
        text = scope.source[name].upper()
        means = [each for each in names if text in names_of(each)]
        is_named = last.op == "EQ" and (name in unknown or bool(means))
        if not is_named and not argument.is_plain:
            return
        count += is_named
        its = means[0] if is_named and means else slot
        if its in values:
            return
        value = Span(last.end, argument.span.end) if is_named else argument.span
        values[its] = scope.source[value].strip()
    if not count or (list(values) != names and set(values) != set(names[: len(values)])):
        return
    del scope.diagnostics[said:]
    fix = f"{word.text}({', '.join(values[each] for each in names if each in values)})"
    scope.report(codes.NAMED_ARGUMENT, node.span, word=word.text, fix=fix)


def report_words_for_numbers(scope: Scope, node: ast.Command, word: Word, said: int) -> None:
    """`F(2, rapido)`, `BEEP(1, DO)`: the number that the word says. Changes those since `said`.

    `SHOW(HOLA)` has none: words are not shown.
    """
    if word.role == "show":
        shown = dict.fromkeys(each.values.get("shown") for each in scope.diagnostics[:ENOUGH])
        for k, each in enumerate(scope.diagnostics[said:], said):
            if each.code is codes.UNKNOWN_NAME and not each.values.get("near"):
                name = each.values["found"]
                number = str(len([*takewhile(name.__ne__, filter(None, shown))]) + 1)
                is_word = len(name) > 2 and name.isalpha() and not value_of(name)
                said_as = {"meaning": name, "number": number} if is_word else {}
                values = {**each.values, "shown": name, **said_as}
                scope.diagnostics[k] = each._replace(values=values)
        return
    tables = {"%": POWER_WORDS, "Hz": NOTE_WORDS}
    if word.role == "beep":
        tables["s"] = NOTE_WORDS  # in the wrong order
    elif word.role in ("move", "wait"):
        tables["s"] = dict.fromkeys(("MEDIO", "MEDIA", "HALF"), "0.5")
    for argument, its in zip(node.arguments or (), word.arguments, strict=False):
        for k, each in enumerate(scope.diagnostics[said:], said):
            if each.code is codes.UNKNOWN_NAME and each.span == argument.span:
                near = tables.get(its.unit, {}).get(each.values["found"])
                if near:
                    values = {**each.values, "near": near}
                    scope.diagnostics[k] = each._replace(values=values)


def whole_name(scope: Scope, part: str, names: AbstractSet[str]) -> str:
    """Return the one name that `part` is a word of: MI_VELOCIDAD for VELOCIDAD, else nothing.

    After ENOUGH mistakes the names are not searched, so that a long program stays fast.
    """
    if part in names or len(scope.diagnostics) >= ENOUGH:
        return ""
    found = [each for each in names if part in each.split("_")]
    return found[0] if len(found) == 1 else ""


def meant_value(scope: Scope, span: Span, name: str, is_assigned: bool) -> str:
    """Return what `IF(obstaculo)` asks, or the number that `v = rapido` gives, else nothing."""
    text = scope.source.text
    before, after = text[: span.start][-60:].rstrip()[-1:], text[span.end :][:60].lstrip()[:1]
    if name in NEAR_WORDS and (before, after) == ("(", ")") and "DISTANCE" in scope.names:
        return "DISTANCE < 10" if _HEADER.search(text[: span.start][-60:]) else ""
    return POWER_WORDS.get(name, "") if is_assigned and before == "=" else ""


_HEADER = re.compile(r"(?i)\b(IF|ELSEIF|UNTIL|WHILE)\s*\(\s*(NOT\s+)?$")


def _wanted(scope: Scope, name: str) -> list[str]:
    """Return the names in the body of a DEF that nothing gives a value: of each DEF, once."""
    if name in scope.wanted:
        return scope.wanted[name]
    body = re.search(rf"(?is)\bDEF\s+{name}\b(.*?)\bEND_?DEF\b", scope.source.text)
    words = [each.text for each in scan(body[1]).tokens if each.kind is WORD] if body else []
    known = {*WORDS, *scope.names, *scope.set_somewhere, *scope.def_names}
    scope.wanted[name] = [*dict.fromkeys(each for each in words if each not in known)]
    return scope.wanted[name]


def report_not_callable(scope: Scope, node: ast.Command) -> None:
    """`SQUARE(3)`, where there is a `DEF SQUARE(SIDE)`: a variable brings the value."""
    texts = [scope.source[each.span] for each in node.arguments or ()]
    head = rf"(?i)\bDEF\s+{node.word}[ \t]*\(([ \t,A-Z0-9_]{{1,200}})\)"
    found = re.search(head, scope.source.text)
    names = [each.strip().upper() for each in found[1].split(",")] if found else []
    if found is None:
        names = _wanted(scope, node.word)
    fix = ""
    if texts and len(names) == len(texts):
        pairs = zip(names, texts, strict=True)
        fix = ";".join((*(f"{name} = {text}" for name, text in pairs), node.word))
    said = {"named": node.word} if node.word in scope.def_names and not fix else {}
    if said and len(texts) == 1 and texts[0].isdecimal() and 1 < int(texts[0][:9]) <= MANY_TIMES:
        said["times"] = texts[0]
        fix = f"LOOP({texts[0]});{node.word};{BLOCK_ENDS['LOOP']}"
    scope.report(codes.NOT_CALLABLE, node.span, None, name=node.word, fix=fix, **said)
