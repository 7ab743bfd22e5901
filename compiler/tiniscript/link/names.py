"""The names of the numbers that a robot sends: of faults, and of rows in the tables of messages."""

from __future__ import annotations

from tiniscript.bytecode.opcodes import FAULTS
from tiniscript.link.messages import CAUSES, LINK_FAULTS, SAVED_STATES

_FAULTS = {number: name for number, name, _ in (*FAULTS, *LINK_FAULTS)}


def fault_name(number: int) -> str:
    """Return the name of a fault, of the machine's or of the link's; else the number."""
    return _FAULTS.get(number, str(number))


def row_name(table: tuple[tuple[str, str], ...], number: int) -> str:
    """Return the name of a row; that of the first for a number that only newer robots know."""
    return table[number if number < len(table) else 0][0]


def cause_name(number: int) -> str:
    return row_name(CAUSES, number)


def saved_name(number: int) -> str:
    """Return the state of a saved program; unknown states count as in memory."""
    return SAVED_STATES[number][0] if number < len(SAVED_STATES) else "MEMORY"
