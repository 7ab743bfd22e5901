"""Moves by centimetres or degrees whose time is known before they run.

Knows how fast a kit says that its robot is.
"""

from __future__ import annotations

from tiniscript.base.fixed_point import HIGHEST, Fault, clamp, round_to_whole
from tiniscript.base.kit import Kit
from tiniscript.semantics.ir import Move, Statement, Term
from tiniscript.semantics.optimizer import known_value


def extent_move_ms(move: Move, kit: Kit) -> int | None:
    """Return the duration of a move by a constant distance and power, or None.

    Raises Fault, as the robot does.
    """
    extent = known_value(move.time)
    power = known_value(move.power)
    if extent is None or power is None:
        return None
    return kit.go_ms(extent, clamp(round_to_whole(power), 0, 100), move.unit == "DEG")


def has_unknown_extent(statement: Statement) -> bool:
    """Return whether a move by distance has a duration that only the robot knows."""
    if not isinstance(statement, Move) or not statement.unit:
        return False
    values = (statement.time, statement.power)
    return any(value is None or known_value(value) is None for value in values)


def timed_move(move: Move, kit: Kit) -> Move:
    """Return a move by its time in place of one by its way, which is not open.

    If the robot would fault, it never ends.
    """
    try:
        time_ms = extent_move_ms(move, kit) or 0
    except Fault:
        time_ms = HIGHEST
    return move._replace(time=(Term("NUMBER", time_ms),), unit="")
