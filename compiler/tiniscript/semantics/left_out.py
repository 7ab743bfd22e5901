"""The instructions that a BREAK outside a loop skips: `IF(C);S;BREAK;ENDIF;BEEP(1, 440)`.

A person wants the rest of the program only if the BREAK is not reached: it goes into the other
branch, `IF(C);S;ELSE;BEEP(1, 440);ENDIF`.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import NamedTuple

from tiniscript.base.source import Edit, Source, Span
from tiniscript.syntax import ast

_END = re.compile(r"(?i)\bEND_?IF\Z")
_MAX_CHARACTERS = 180  # characters that a message can show


class RewrittenIf(NamedTuple):
    """The IF with the rest in its other branch: in one line, and as edits of the text."""

    text: str
    edits: tuple[Edit, ...]


def rewrite_without_break(
    source: Source, parsed_program: ast.Program, break_node: ast.Break
) -> RewrittenIf | None:
    """Return an IF that skips the rest without its BREAK, the last instruction in a branch.

    The IF is no part of another block but a DEF or a TASK, whose rest is what follows.
    """
    bodies = [
        parsed_program.body,
        *(node.body for node in parsed_program.body if isinstance(node, (ast.Def, ast.Task))),
    ]
    for body in bodies:
        for k, statement in enumerate(body):
            later_instructions = [
                node for node in body[k + 1 :] if not isinstance(node, (ast.Def, ast.Task))
            ]
            if isinstance(statement, ast.If) and len(statement.arms) == 1 and later_instructions:
                if len(later_instructions) != len(body) - k - 1:
                    continue  # a DEF among them cannot be inside a block
                if rewritten_if := _rewrite_if(source, statement, later_instructions, break_node):
                    return rewritten_if
    return None


def _rewrite_if(
    source: Source,
    if_node: ast.If,
    later_instructions: Sequence[ast.Instruction],
    break_node: ast.Break,
) -> RewrittenIf | None:
    whole_span = Span(if_node.span.start, later_instructions[-1].span.end)
    arm = if_node.arms[0]
    branches = [[*arm.body], [*if_node.else_body]]
    last_instructions = [branch[-1] if branch else None for branch in branches]
    if break_node not in last_instructions or arm.condition is None:
        return None
    ended_branch = last_instructions.index(break_node)
    branch_texts = [
        [source[instruction.span] for instruction in branch if instruction is not break_node]
        for branch in branches
    ]
    branch_texts[1 - ended_branch] += [
        source[instruction.span] for instruction in later_instructions
    ]
    branch_texts[0] = branch_texts[0] or ["S"]  # the robot does not move in that branch
    header = f"IF({source[arm.condition.span]})"
    parts = [
        header,
        *branch_texts[0],
        *(["ELSE", *branch_texts[1]] if branch_texts[1] else []),
        "ENDIF",
    ]
    text = ";".join(" ".join(part.split("\n")) for part in parts)
    if len(text) > _MAX_CHARACTERS or any("\n" in part or "//" in part for part in parts):
        return None
    if "//" in source[whole_span]:
        return _with_notes(source, if_node, later_instructions, break_node, text)
    separator = "\n" if "\n" in source[whole_span] else "; " if "; " in source[whole_span] else ";"
    return RewrittenIf(text, (Edit(whole_span, separator.join(parts)),))


def _with_notes(
    source: Source,
    if_node: ast.If,
    later_instructions: Sequence[ast.Instruction],
    break_node: ast.Break,
    text: str,
) -> RewrittenIf | None:
    """Return the lines with their notes in place, and ENDIF last."""
    body, else_body = if_node.arms[0].body, if_node.else_body
    end_match = _END.search(source[if_node.span])
    if break_node is not body[-1] or else_body or end_match is None:
        return None
    start = if_node.span.start
    line_end = source.text.find("\n", later_instructions[-1].span.end)
    line_end = line_end if line_end >= 0 else len(source.text)
    edits = (
        Edit(break_node.span, "S" if len(body) == 1 else ""),
        Edit(Span(start + end_match.start(), start + end_match.end()), "ELSE"),
        Edit(Span(line_end, line_end), "\nENDIF"),
    )
    return RewrittenIf(text, edits)
