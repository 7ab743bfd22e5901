"""Features of correct programs that a level's reader lacks, as diagnostics.

Knows the table of levels and how much memory a program needs. Looks for no mistake of the language:
those have been reported.
"""

from __future__ import annotations

from tiniscript.base.kit import Kit
from tiniscript.base.source import Source, Span
from tiniscript.base.words import WORDS
from tiniscript.codegen.text.line import PlainCode, plain_code, spell_out
from tiniscript.codegen.text.memory import MAX_BRACKETS, Reader
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Diagnostic
from tiniscript.robots.text_levels import CODE_BYTES, LONGEST_WORD, Level
from tiniscript.semantics.ir import Program, yes_no_variables
from tiniscript.semantics.task_copies import count_tasks_by_def
from tiniscript.syntax.lexer import WORD
from tiniscript.syntax.parser import parse


def find_misfits(source: Source, program: Program, kit: Kit, level: Level) -> list[Diagnostic]:
    """Return the features of a checked program that robots of this level lack."""
    parsed_program = parse(source)
    tokens = list(spell_out(parsed_program.scan.tokens))
    end_roles = ("end", "alias")  # the word that begins their block explains them
    lacking_words = {word for word in level.missing_words if WORDS[word].role.name not in end_roles}
    diagnostics = [
        Diagnostic(codes.LEVEL_WORD, token.span, {"level": level.name, "word": token.text})
        for token in tokens
        if token.kind is WORD and (token.text in lacking_words or len(token.text) > LONGEST_WORD)
    ]
    if "DEF" not in level.missing_words and any(
        procedure.values for procedure in program.procedures
    ):
        diagnostics += _value_problems(program, kit, level)
    program_code = plain_code(program)
    limit = min(CODE_BYTES, level.room)
    if program_code.short_length > limit:
        span = _first_span_beyond(program_code, limit)
        diagnostics.append(
            _too_many(codes.LEVEL_CODE, span, level, program_code.short_length, limit)
        )
        return diagnostics
    reader = Reader(tokens, kit, level.sensor_bytes)
    reader.program()
    if reader.extra_bracket_span is not None:
        values = {"level": level.name, "limit": str(MAX_BRACKETS)}
        diagnostics.append(Diagnostic(codes.LEVEL_BRACKETS, reader.extra_bracket_span, values))
    for need in reader.needs:
        if need.byte_count > level.room:
            diagnostics.append(
                _too_many(codes.LEVEL_ROOM, need.span, level, reader.most_bytes, level.room)
            )
            break
    return diagnostics


def _value_problems(program: Program, kit: Kit, level: Level) -> list[Diagnostic]:
    """Return each DEF that has a value other than a number, or values for several tasks."""
    problems, yes_no = [], yes_no_variables(program, kit)
    for procedure, tasks in zip(program.procedures, count_tasks_by_def(program), strict=True):
        level_values = {"level": level.name, "name": procedure.name}
        span = Span(procedure.span.start, procedure.span.start + len("DEF"))
        for name in (program.variables[k] for k in procedure.values if yes_no[k]):
            problems.append(Diagnostic(codes.LEVEL_VALUES, span, {**level_values, "yes_no": name}))
        if procedure.values and tasks > 1:
            problems.append(
                Diagnostic(codes.LEVEL_VALUES, span, {**level_values, "count": str(tasks)})
            )
    return problems


def _first_span_beyond(code: PlainCode, limit: int) -> Span:
    """Return the text of the first instruction whose code does not lie within the limit."""
    ends = [*(location.offset for location in code.locations[1:]), code.short_length]
    return next(
        location.span for location, end in zip(code.locations, ends, strict=True) if end > limit
    )


def _too_many(
    code: codes.Code, span: Span, level: Level, byte_count: int, limit: int
) -> Diagnostic:
    values = {"level": level.name, "code": str(byte_count), "limit": str(limit),
              "over": str(byte_count - limit)}  # fmt: skip
    return Diagnostic(code, span, values)
