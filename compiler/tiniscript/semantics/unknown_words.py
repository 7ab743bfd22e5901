"""Reports unknown commands, and commands with wrong values.

Knows what was probably meant, and suggests it. The checker knows what a correct program means, and
calls this module for mistakes.
"""

from __future__ import annotations

from itertools import chain

from tiniscript.diagnostics import codes
from tiniscript.semantics.symbols import Scope
from tiniscript.source import Source, Span
from tiniscript.syntax import ast
from tiniscript.syntax.call_suggestions import call_of, glued_call
from tiniscript.words import SWITCH_WORDS, TURN_WORDS, WORDS, Word, meant_by

_OPPOSITE = {"F": "B", "B": "F", "L": "R", "R": "L"}


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
    if meant is not None and (meant in WORDS or meant in scope.names):
        fix = meant
        if meant in WORDS:
            spans = [each.span for each in node.arguments or ()]
            fix = call_of(scope.source, WORDS[meant], spans)
        scope.report(codes.OTHER_LANGUAGE, span, found=word, right=meant, fix=fix)
        return
    if word in TURN_WORDS:
        scope.report(codes.WHICH_WAY, span)
        return
    if word in SWITCH_WORDS:
        switched = next((each.name for each in scope.kit.actuators if each.is_yes_no), "")
        fix = f"{switched}({SWITCH_WORDS[word]})" if switched else ""
        scope.report(codes.SWITCH_WHAT, span, found=word if fix else "", fix=fix)
        return
    glued = glued_call(word)
    if glued is not None and node.arguments is None:
        scope.report(codes.MISSING_OPEN, span, word=glued.partition("(")[0], fix=glued)
        return
    commands = [each.text for each in WORDS.values() if each.role not in
                ("setup", "later", "value", "operator", "function", "forever")]  # fmt: skip
    near = scope.near(word, chain(commands, scope.names, scope.def_names))
    scope.report(codes.UNKNOWN_WORD, span, found=word, near=near)


def report_named_arguments(scope: Scope, node: ast.Command, word: Word, said: int) -> None:
    """`F(t=2, p=80)`: values have no names here. Drops the diagnostics since `said`."""
    unknown = {each.span for each in scope.diagnostics[said:] if each.code is codes.UNKNOWN_NAME}
    values = []
    for argument in node.arguments or ():
        first, last = argument.expression[0], argument.expression[-1]
        if last.op != "EQ" or Span(first.start, first.end) not in unknown:
            return
        values.append(scope.source[Span(last.end, argument.span.end)].strip())
    del scope.diagnostics[said:]
    fix = f"{word.text}({', '.join(values)})"
    scope.report(codes.NAMED_ARGUMENT, node.span, word=word.text, fix=fix)


def the_other_way(source: Source, node: ast.Command, word: Word) -> str:
    """Return `B(2, 80)` for `F(-2, 80)` or `F(2, -80)`; nothing for what is no such move."""
    arguments = node.arguments or ()
    texts = [source[each.span] for each in arguments]
    signs = sum(text.startswith("-") for text in texts)
    if word.role != "move" or signs != 1 or not all(each.is_plain for each in arguments):
        return ""
    values = ", ".join(text.lstrip("- ") for text in texts)
    return f"{_OPPOSITE[word.text]}({values})"
