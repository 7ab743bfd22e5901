"""Knows what a variable's name says of its value: MI_TIEMPO is seconds, VEL1 a power."""

from __future__ import annotations

from tiniscript.base.words import POWER_WORDS, names_of

_TIMES = frozenset(names_of("time"))
_POWERS = frozenset((*names_of("power"), *POWER_WORDS))


def is_time(name: str) -> bool:
    return _says(name, _TIMES)


def is_power(name: str) -> bool:
    return _says(name, _POWERS)


def value_of(name: str) -> str:
    """Return a value that a variable of this name may have, "" where the name says nothing."""
    if is_power(name):
        return "50"
    return "2" if is_time(name) else ""


def use_of(name: str) -> str:
    """Return how a variable of this name is used: `F(2, SPEED)`, `F(TIME_S, 80)`, `SHOW(X)`."""
    if is_power(name):
        return f"F(2, {name})"
    return f"F({name}, 80)" if is_time(name) else f"SHOW({name})"


def _says(name: str, meanings: frozenset[str]) -> bool:
    """Whether a part of a name is in `meanings`."""
    return any(part.rstrip("0123456789") in meanings for part in name.split("_"))
