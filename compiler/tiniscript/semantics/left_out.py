"""What a BREAK outside a loop leaves out: `IF(C);S;BREAK;ENDIF;BEEP(1, 440)`.

A person wants the rest of the program only where the BREAK is not reached: it goes into the other
branch, `IF(C);S;ELSE;BEEP(1, 440);ENDIF`.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import NamedTuple

from tiniscript.base.source import Edit, Source, Span
from tiniscript.syntax import ast

_END = re.compile(r"(?i)\bEND_?IF\Z")
_MOST_CHARACTERS = 180  # characters that a message can show


class LeftOut(NamedTuple):
    """The IF with the rest in its other branch: in one line, and as edits of the text."""

    text: str
    edits: tuple[Edit, ...]


def rewrite_without_break(
    source: Source, parsed_program: ast.Program, break_node: ast.Break
) -> LeftOut | None:
    """Return how an IF leaves out the rest without its BREAK, its last instruction in a branch.

    The IF is no part of another block but a DEF or a TASK, whose rest is what follows.
    """
    bodies = [
        parsed_program.body,
        *(item.body for item in parsed_program.body if isinstance(item, (ast.Def, ast.Task))),
    ]
    for body in bodies:
        for k, statement in enumerate(body):
            rest = [item for item in body[k + 1 :] if not isinstance(item, (ast.Def, ast.Task))]
            if isinstance(statement, ast.If) and len(statement.arms) == 1 and rest:
                if len(rest) != len(body) - k - 1:
                    continue  # a DEF among them goes into no block
                if left_out := _rewrite_if(source, statement, rest, break_node):
                    return left_out
    return None


def _rewrite_if(
    source: Source, if_node: ast.If, rest: Sequence[ast.Instruction], break_node: ast.Break
) -> LeftOut | None:
    whole_span = Span(if_node.span.start, rest[-1].span.end)
    arm = if_node.arms[0]
    branches = [[*arm.body], [*if_node.otherwise]]
    last_instructions = [branch[-1] if branch else None for branch in branches]
    if break_node not in last_instructions or arm.condition is None:
        return None
    ended_branch = last_instructions.index(break_node)
    branch_texts = [
        [source[each.span] for each in branch if each is not break_node] for branch in branches
    ]
    branch_texts[1 - ended_branch] += [source[each.span] for each in rest]
    branch_texts[0] = branch_texts[0] or ["S"]  # it stands still there
    head = f"IF({source[arm.condition.span]})"
    parts = [
        head,
        *branch_texts[0],
        *(["ELSE", *branch_texts[1]] if branch_texts[1] else []),
        "ENDIF",
    ]
    text = ";".join(" ".join(part.split("\n")) for part in parts)
    if len(text) > _MOST_CHARACTERS or any("\n" in part or "//" in part for part in parts):
        return None
    if "//" in source[whole_span]:
        return _with_notes(source, if_node, rest, break_node, text)
    separator = "\n" if "\n" in source[whole_span] else "; " if "; " in source[whole_span] else ";"
    return LeftOut(text, (Edit(whole_span, separator.join(parts)),))


def _with_notes(
    source: Source,
    if_node: ast.If,
    rest: Sequence[ast.Instruction],
    break_node: ast.Break,
    text: str,
) -> LeftOut | None:
    """Return the same where lines have notes: each stays where it is, and ENDIF comes last."""
    body, else_body = if_node.arms[0].body, if_node.otherwise
    end = _END.search(source[if_node.span])
    if break_node is not body[-1] or else_body or end is None:
        return None
    start = if_node.span.start
    last = source.text.find("\n", rest[-1].span.end)
    last = last if last >= 0 else len(source.text)
    edits = (
        Edit(break_node.span, "S" if len(body) == 1 else ""),
        Edit(Span(start + end.start(), start + end.end()), "ELSE"),
        Edit(Span(last, last), "\nENDIF"),
    )
    return LeftOut(text, edits)
