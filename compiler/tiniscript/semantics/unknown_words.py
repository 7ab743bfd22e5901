"""Reports unknown commands, and commands with wrong values.

Knows what was probably meant, and suggests it. The checker knows what a correct program means, and
calls this module for mistakes.
"""

from __future__ import annotations

import re
from collections.abc import Set as AbstractSet
from itertools import chain, takewhile

from tiniscript.base.words import (
    BLOCK_ENDS,
    WORDS,
    Word,
    expand_short,
    lexicon_concept,
    lexicon_meaning,
    names_argument,
)
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import MAX_DIAGNOSTICS
from tiniscript.semantics.named_values import value_of, yes_no_of
from tiniscript.semantics.symbols import Scope
from tiniscript.syntax import ast
from tiniscript.syntax.lexer import WORD, scan

_LETTER = re.compile(r"(?i)(?<!\w)([A-Z])[ \t]*\(")
_DIGITS = "0123456789"
_LAMP_NAME = "LED"  # name of the lamp in kits that have one
_TRUTH_BY_VALUE = {"TRUE": "TRUE", "1": "TRUE", "FALSE": "FALSE", "0": "FALSE"}
MAX_REPETITIONS = 20  # most repetitions of a DEF that a class does by hand


def report_unknown(scope: Scope, node: ast.Command, def_name: str | None) -> None:
    """Report a command that is neither word nor known name; `def_name` is the DEF around it."""
    word, span = node.word, node.word_span
    if word == def_name:
        scope.report(codes.CALLS_ITSELF, span, name=word)
    elif word in scope.def_names:
        scope.report(codes.CALL_BEFORE_DEF, span, name=word)
    elif word in scope.assigned_names:
        scope.report(codes.VARIABLE_ALONE, span, name=word)
    elif not _report_lamp(scope, node):
        _report_unknown_word(scope, node)


def _report_lamp(scope: Scope, node: ast.Command) -> bool:
    """Report `LAMP(1)`, `LIGHT(ON)`: what a kit calls its lamp, or that it has none.

    LED is the word of other kits, and a light that is not switched may be a sensor. Return whether
    that is meant.
    """
    word, arguments = node.word, node.arguments or ()
    value_texts = [scope.source[argument.span].upper() for argument in arguments]
    answers = [yes_no_of(text) or _TRUTH_BY_VALUE.get(text, "") for text in value_texts]
    is_light = (
        lexicon_meaning(word, "stem")[:1] == ("LIGHT",) and len(answers) == 1 and bool(answers[0])
    )
    if word == _LAMP_NAME or not (lexicon_concept(word) == _LAMP_NAME or is_light):
        return False
    values = {"lamp": word}
    if any(device.name == _LAMP_NAME and device.is_yes_no for device in scope.kit.actuators):
        answer = answers[0] if len(answers) == 1 and answers[0] else "TRUE"
        values |= {"switch": _LAMP_NAME, "fix": f"{_LAMP_NAME}({answer})"}
    scope.report(codes.SWITCH_WHAT, node.word_span, node.span, **values)
    return True


def _report_unknown_word(scope: Scope, node: ast.Command) -> None:
    word, span = node.word, node.word_span
    starting_words = (
        starting_word for starting_word in WORDS.values() if starting_word.role.can_start_item
    )
    commands = [
        starting_word.text
        for starting_word in starting_words
        if starting_word.text not in ("FOREVER", "SEND")
    ]
    suggestion = whole_name(scope, word, scope.def_names) if node.arguments is None else ""
    suggestion = suggestion or scope.nearest_word(
        word, chain(commands, scope.names, scope.def_names)
    )
    is_own_name = suggestion in scope.assigned_names or suggestion in scope.def_names
    if is_own_name and suggestion.rstrip(_DIGITS) == word.rstrip(_DIGITS):
        suggestion = ""  # `PASO2`, if there is a DEF PASO1
    is_held = len(word) <= 3 and len(set(word)) == 1  # `FF(2, 80)`: a key that was held
    letters = [word[0]] if is_held and word[0] in WORDS else expand_short(word)
    letters = letters or _initial(word, scope.source.text)
    argument_count = len(node.arguments or ())
    suggestion = next(
        (letter for letter in letters if len(WORDS[letter].arguments) == argument_count), suggestion
    )
    scope.report(codes.UNKNOWN_WORD, span, None, found=scope.source[span].upper(), near=suggestion)


def _initial(word: str, text: str) -> list[str]:
    """Return the command that a letter begins in the language of the other letters of a text.

    `A(2, 70)` means F if there is also `D(1, 50)`, which is a command only in Spanish and
    Portuguese: forward is `adelante` there. It does not if the program has an F.
    """
    commands = lexicon_meaning(word, "initial")
    calls = {match.upper() for match in _LETTER.findall(text)} if commands else set()
    is_other = any(expand_short(other) for other in calls - {word} if other not in WORDS)
    return [*commands] if is_other and not calls.intersection(commands) else []


def report_placeholders(scope: Scope, node: ast.Command, word: Word, diagnostic_count: int) -> None:
    """`F(tiempo, potencia)`: these names stand for numbers.

    Drops the diagnostics since `diagnostic_count`.
    """
    argument_texts = [scope.source[argument.span].upper() for argument in node.arguments or ()]
    if len(argument_texts) == len(word.arguments) and all(
        map(names_argument, argument_texts, word.arguments)
    ):
        del scope.diagnostics[diagnostic_count:]
        scope.report(codes.PLACEHOLDER, node.span, usage=word.usage, example=word.example)


def report_words_shown(scope: Scope, diagnostic_count: int) -> None:
    """`SHOW(HOLA)`: words are not shown. Changes the diagnostics since `diagnostic_count`."""
    shown_words = dict.fromkeys(
        diagnostic.values.get("shown") for diagnostic in scope.diagnostics[:MAX_DIAGNOSTICS]
    )
    for k, diagnostic in enumerate(scope.diagnostics[diagnostic_count:], diagnostic_count):
        if diagnostic.code is codes.UNKNOWN_NAME and not diagnostic.values.get("near"):
            name = diagnostic.values["found"]
            number = str(len([*takewhile(name.__ne__, filter(None, shown_words))]) + 1)
            is_word = len(name) > 2 and name.isalpha() and not value_of(name)
            word_values = {"meaning": name, "number": number} if is_word else {}
            scope.diagnostics[k] = diagnostic._replace(
                values={**diagnostic.values, "shown": name, **word_values}
            )


def whole_name(scope: Scope, part: str, names: AbstractSet[str]) -> str:
    """Return the one name that `part` is a word of, or shortened: MI_VELOCIDAD for VELOCIDAD, VEL.

    After MAX_DIAGNOSTICS mistakes the names are not searched, so that a long program stays fast.
    """
    if part in names or len(scope.diagnostics) >= MAX_DIAGNOSTICS:
        return ""
    whole_names = [
        name for name in names if part in name.split("_") or _is_one_short_for_other(part, name)
    ]
    return whole_names[0] if len(whole_names) == 1 else ""


def _is_one_short_for_other(name: str, other_name: str) -> bool:
    shorter, longer = sorted((name, other_name), key=len)
    return len(shorter) > 2 and longer.isalpha() and longer.startswith(shorter)


def _unset_names(scope: Scope, name: str) -> list[str]:
    """Return the names in the body of a DEF that nothing gives a value: of each DEF, once."""
    if name in scope.unset_names_of_def:
        return scope.unset_names_of_def[name]
    body_match = re.search(rf"(?is)\bDEF\s+{name}\b(.*?)\bEND_?DEF\b", scope.source.text)
    words = (
        [token.text for token in scan(body_match[1]).tokens if token.kind is WORD]
        if body_match
        else []
    )
    known_words = {*WORDS, *scope.names, *scope.assigned_names, *scope.def_names}
    scope.unset_names_of_def[name] = [
        *dict.fromkeys(word for word in words if word not in known_words)
    ]
    return scope.unset_names_of_def[name]


def report_not_callable(scope: Scope, node: ast.Command) -> None:
    """`SQUARE(3)`, where SQUARE has no values: its DEF may name one, or it is done 3 times."""
    if re.search(rf"(?i)\bDEF\s+{node.word}[ \t]*\([^)\n]*\w", scope.source.text):
        return  # the mistake in the DEF's brackets has been reported
    argument_texts = [scope.source[argument.span] for argument in node.arguments or ()]
    values = {"named": node.word} if node.word in scope.def_names else {}
    fix, names = "", _unset_names(scope, node.word)
    if values and argument_texts and len(names) == len(argument_texts):
        values["head"] = f"DEF {node.word}({', '.join(names)})"
    elif (
        values
        and len(argument_texts) == 1
        and argument_texts[0].isdecimal()
        and 1 < int(argument_texts[0][:9]) <= MAX_REPETITIONS
    ):
        values["times"] = argument_texts[0]
        fix = f"LOOP({argument_texts[0]});{node.word};{BLOCK_ENDS['LOOP']}"
    fix_span = node.span if "times" in values else None
    scope.report(codes.NOT_CALLABLE, node.span, fix_span, name=node.word, fix=fix, **values)
