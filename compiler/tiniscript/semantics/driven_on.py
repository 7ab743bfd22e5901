"""Finds what ends a move that has FOREVER and no UNTIL: a wait and an S, or an S further on.

Anyone who writes `F(FOREVER, 60);W(3);S` thinks that the robot drives on during the wait.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence

from tiniscript.base.source import Source
from tiniscript.syntax import ast

# The state of the motors in a move, by its power.
_MOTORS = {"F": "M({0}, {0})", "B": "M(-{0}, -{0})", "L": "M(-{0}, {0})", "R": "M({0}, -{0})"}
Body = Sequence[ast.Instruction]


def find_move_end(source: Source, program: ast.Program, move: ast.Command) -> dict[str, str]:
    """Return `whole`, the move that ends there, or `running`, if motors run; `used` is its text.
    Empty if no S ends it.
    """
    if move.word not in _MOTORS or not move.arguments or len(move.arguments) != 2:
        return {}
    power = source[move.arguments[1].span]
    if not power.isdecimal():
        return {}
    following_instructions = _instructions_after(program.body, move)
    first, second = (*following_instructions[:2], None, None)[:2]
    if isinstance(first, ast.Command) and first.word == "W" and _is_stop(second):
        time = source[first.arguments[0].span] if first.arguments else ""
        until_text = f" UNTIL({source[first.until.span]})" if first.until else ""
        if time and (until_text or time.upper() != "FOREVER"):
            instructions_text = "; ".join(
                source[node.span] for node in (move, *following_instructions[:2])
            )
            return {
                "used": instructions_text,
                "fix": "",
                "whole": f"{move.word}({time}, {power}){until_text}",
            }
    for instruction in following_instructions:
        if _is_stop(instruction):
            return {"used": source[move.span], "running": _MOTORS[move.word].format(power)}
        if not isinstance(instruction, (ast.Command, ast.Assign, ast.Loop)) or _ends_a_move(
            instruction
        ):
            break
    return {}


def _instructions_after(body: Body, node: ast.Command) -> Body:
    """Return the instructions after one in its own block."""
    start = node.span.start
    while body:
        k = bisect_right(body, start, key=lambda instruction: instruction.span.start) - 1
        if k < 0 or body[k].span.start == start:
            return body[k + 1 :]
        inner_bodies = [
            inner for inner in _bodies(body[k]) if inner and inner[0].span.start <= start
        ]
        body = inner_bodies[-1] if inner_bodies else ()
    return ()


def _bodies(node: ast.Instruction) -> list[Body]:
    if isinstance(node, ast.If):
        return [*(arm.body for arm in node.arms), node.else_body]
    return [node.body] if isinstance(node, (ast.Loop, ast.While, ast.Def, ast.Task)) else []


def _is_stop(node: ast.Instruction | None) -> bool:
    return isinstance(node, ast.Command) and node.word in ("S", "STOP")


def _ends_a_move(node: ast.Instruction) -> bool:
    """Return whether it is a move or a wait, so that a following S may belong to it."""
    return isinstance(node, ast.Command) and (node.until is not None or node.word in _MOTORS)
