"""Warns of useless code: the robot never executes it, or it has no effect.

Instructions after an endless loop or in a note, a DEF that nobody calls, a variable or a reading
that nobody uses, a loop that only repeats, a block with nothing inside.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import pairwise, takewhile

from tiniscript.base.source import Source, Span
from tiniscript.base.words import BLOCK_ENDS, WORDS, lexicon_meaning
from tiniscript.diagnostics import codes
from tiniscript.semantics import ir
from tiniscript.semantics.lint.context import BodyContext, LintContext
from tiniscript.semantics.named_values import use_of
from tiniscript.semantics.optimizer import known_value
from tiniscript.syntax.cursor import INSTRUCTION_ENDS
from tiniscript.syntax.lexer import NEWLINE, Token

_SEEN_STATEMENTS = (ir.Move, ir.Act, ir.Motors)  # statements with a visible or audible effect
_NOTE_BEHIND = r"[ \t;]{0,99}//"
MAX_EXAMPLE_INSTRUCTIONS = 12  # instructions that an example has
_CALL = (
    r"(?:[FBLR]\(\s*(?:-?[0-9.]+(?:\s*(?:CM|DEG))?|FOREVER)\s*,\s*-?[0-9.]+\s*\)"
    r"|(?:M|BEEP)\(\s*-?[0-9.]+\s*,\s*-?[0-9.]+\s*\)|W\(\s*(?:[0-9.]+|FOREVER)\s*\))"
    r"(?:\s*UNTIL\s*\([^();]+\))?"
)
# Few programs have notes: these are not compiled before there are some.
_CALLS = rf"(?i)/+\s*(?:{_CALL})(?:[;\s]*(?:{_CALL}|STOP|S))*[;\s]*"
_CALL_IN_IT = rf"(?i)(?:{_CALL})|STOP|S"
# Tokens allowed between such calls.
_HEADER_OR_END = r"(?i)(?:LOOP|IF|ELSEIF|WHILE|WHEN|SHOW)\s*\([^();]+\)|ELSE|TASK|END_?[A-Z]+"
MAX_NOTE_CHARACTERS = 200  # characters of a note that is looked at


# -- what is never done ----------------------------------------------------------------------


def report_never_reached(body: ir.Body, body_context: BodyContext, context: LintContext) -> None:
    """Report instructions after an endless loop or after BREAK."""
    for statement, next_statement in pairwise(body):
        if not ir.falls_through((statement,)):
            values = {"found": context.source[next_statement.span].split("\n")[0]}
            if isinstance(statement, ir.Loop):
                values["line"] = str(context.source.position(statement.span.start)[0])
                if (
                    isinstance(next_statement, ir.Loop)
                    and next_statement.times is None
                    and body is context.program.body
                ):
                    values["together"] = "TASK"
            elif isinstance(statement, ir.Break):
                values["ends"] = "BREAK"
            context.report(codes.NEVER_REACHED, next_statement.span, **values)
            return


def report_instructions_in_notes(context: LintContext) -> None:
    """`F(2, 80)//R(1, 60)`: instructions in a comment.

    Only a comment that is a row of calls with numbers, or has such a call after a `;`, counts as a
    slip, and only after an instruction, where a `;` would work: a whole line may be commented out
    on purpose, and after a header or `SI|` a comment describes what follows.
    """
    source, tokens = context.source, context.scan.tokens
    short_comments = [
        comment for comment in context.scan.comments if len(comment.text) <= MAX_NOTE_CHARACTERS
    ]
    if all(token.kind in INSTRUCTION_ENDS for token in tokens):
        _report_all_notes(short_comments, context)
        return
    notes = [
        token
        for token in short_comments
        if re.fullmatch(_CALLS, token.text) or swallowed_instructions(token.text)
    ]
    is_ping = [token.text for token in tokens[:2]] == ["PING", "|"]
    depth = k = 0
    for note in notes:
        while tokens[k].start < note.start:
            depth += (tokens[k].kind == "(") - (tokens[k].kind == ")")
            k += 1
        line_start = max(source.text.rfind(sign, 0, note.start) for sign in "\r\n") + 1
        if depth or not source.text[line_start : note.start].strip(" \t;"):
            continue
        if _ends_instruction(tokens, k) and not is_ping:
            rest = "; ".join(swallowed_instructions(note.text))
            text = rest or note.text.strip("/; \t")
            context.report(codes.IN_A_NOTE, note.span, found=text, rest=rest)


def _report_all_notes(notes: Sequence[Token], context: LintContext) -> None:
    """`// I go F(1, 80); W(2)`, where the program is nothing but notes."""
    for note in notes:
        rest = "; ".join(re.findall(_CALL, note.text, re.IGNORECASE))
        if rest:
            context.report(codes.IN_A_NOTE, note.span, found=rest, rest=rest)
            return


def swallowed_instructions(note: str) -> list[str]:
    """Return the instructions after the words of a note: `// voy; W(2) // compro`.

    None if a bracket is outside a whole instruction: `// L va; R(1, 60) es derecha`.
    """
    first_part, *other_parts = (part.strip() for part in re.split(r";|//", note.removeprefix("//")))
    instructions = [
        part for part in other_parts if re.fullmatch(rf"{_CALL_IN_IT}|{_HEADER_OR_END[4:]}", part)
    ]
    are_instructions = all(
        part in instructions or not set("()") & set(part) for part in (first_part, *other_parts)
    )
    are_instructions = are_instructions and any(
        re.fullmatch(_CALL, part, re.IGNORECASE) for part in instructions
    )
    return instructions if are_instructions and first_part else []


def _ends_instruction(tokens: Sequence[Token], end: int) -> bool:
    """Return whether an instruction precedes the token at `end`, not a header or `SI|`."""
    k = end - 1
    while k >= 0 and tokens[k].kind == ";":
        k -= 1
    if k < 0 or tokens[k].kind == "|":
        return False
    depth = 0
    while k >= 0 and (depth or tokens[k].kind not in (";", "|", NEWLINE)):
        depth += (tokens[k].kind == ")") - (tokens[k].kind == "(")
        k -= 1
    word = WORDS.get(tokens[k + 1].text)
    return word is None or word.role.name not in ("start", "block", "arm")


# -- blocks ----------------------------------------------------------------------------------


def report_busy_loop(
    loop: ir.Loop | ir.While, body_context: BodyContext, context: LintContext
) -> None:
    """`WHILE(TRUE);X = DISTANCE;END_WHILE`: it never ends, and nothing in it takes time."""
    procedures = context.program.procedures
    if (
        context.program.tasks  # with tasks, each turn of a loop takes time
        or not _is_forever(loop)
        or ir.breaks_out(loop.body)
        or any(
            isinstance(call, _SEEN_STATEMENTS) for call in ir.walk_with_calls(loop.body, procedures)
        )
    ):
        return
    word = "LOOP(FOREVER)" if isinstance(loop, ir.Loop) else "WHILE"
    header_span = Span(loop.span.start, loop.span.start + len(word))
    context.report(codes.BUSY_LOOP, header_span, word=word)


def _is_forever(loop: ir.Loop | ir.While) -> bool:
    if isinstance(loop, ir.Loop):
        return loop.times is None
    return known_value(loop.condition) == 1


def report_empty_blocks(body: ir.Body, body_context: BodyContext, context: LintContext) -> None:
    """`LOOP(4)`, `END_LOOP`, and the moves below: show what was probably meant to be in it.

    There is no warning for an endless LOOP or a WHILE, which wait, nor for a block with a comment
    inside or after its end.
    """
    source = context.source
    for k, statement in enumerate(body):
        if not _is_empty(statement):
            continue
        text = source[statement.span]
        note_match = re.compile(_NOTE_BEHIND).match(source.text, statement.span.end)
        if "//" in text or note_match:
            continue
        word = "IF" if isinstance(statement, ir.If) else "LOOP"
        span = context.header_span(statement.span)
        instructions_after = _leading_instructions(body[k + 1 :], source)
        instructions_before = (
            []
            if instructions_after
            else _leading_instructions(body[k - 1 :: -1] if k else (), source)[::-1]
        )
        if not instructions_after and not instructions_before:
            continue
        header, end = " ".join(source[span].split()), BLOCK_ENDS[word]
        values = {"head": header, "end": end}
        for name, instructions in (
            ("example", instructions_after),
            ("before", instructions_before),
        ):
            if 0 < len(instructions) <= MAX_EXAMPLE_INSTRUCTIONS:
                values[name] = "; ".join((header, *instructions, end))
        context.report(codes.EMPTY_BLOCK, span, **values)


def _is_empty(statement: ir.Statement) -> bool:
    if isinstance(statement, ir.Loop):
        return statement.times is not None and not statement.body
    if isinstance(statement, ir.If):
        return len(statement.arms) == 1 and not statement.arms[0].body and not statement.has_else
    return False


def _leading_instructions(statements: Sequence[ir.Statement], source: Source) -> list[str]:
    """Return the instructions at the beginning of a row that are no blocks, as written."""
    plain_statements = [
        *takewhile(
            lambda statement: not isinstance(statement, (ir.If, ir.Loop, ir.While)), statements
        )
    ]
    end = next(
        (k + 1 for k, statement in enumerate(plain_statements) if isinstance(statement, ir.Break)),
        len(plain_statements),
    )
    return [
        source[statement.span]
        for statement in plain_statements[:end]
        if not isinstance(statement, ir.Read)
    ]


# -- what nobody uses ------------------------------------------------------------------------


def report_unused_variables(context: LintContext) -> None:
    program = context.program
    used_variables = ir.referenced_numbers("VARIABLE", context.statements)
    owners = {k: procedure for procedure in program.procedures for k in procedure.values}
    for statement in context.statements:
        if isinstance(statement, ir.Assign) and statement.variable not in used_variables:
            used_variables.add(statement.variable)  # reported once
            name = program.variables[statement.variable]
            device = name if lexicon_meaning(name, "device") else ""
            values = {"name": name, "device": device, "example": use_of(name)}
            if statement.variable in owners:
                values["own"] = owners[statement.variable].name
            context.report(codes.UNUSED_VARIABLE, statement.span, **values)


def report_unused_readings(context: LintContext) -> None:
    """`SI|DISTANCE`, if nothing asks for the distance: it is measured, and nobody sees it."""
    referenced_sensors = ir.referenced_numbers("SENSOR", context.statements)
    for statement in context.statements:
        if isinstance(statement, ir.Read) and statement.sensor not in referenced_sensors:
            referenced_sensors.add(statement.sensor)  # reported once
            name = context.kit.readings[statement.sensor].name
            context.report(codes.UNUSED_READING, statement.span, name=name, fix=f"SHOW({name})")


def report_unused_defs(context: LintContext) -> None:
    called_numbers = {
        statement.procedure for statement in context.statements if isinstance(statement, ir.Call)
    }
    for number, procedure in enumerate(context.program.procedures):
        if number not in called_numbers:
            span = Span(procedure.span.start, procedure.span.start + len("DEF"))
            values = {"name": procedure.name}
            if procedure.values:
                names = ", ".join(context.program.variables[k] for k in procedure.values)
                values["usage"] = f"{procedure.name}({names})"
            context.report(codes.UNUSED_DEF, span, **values)
