"""Knows what a variable's name says of its value: MI_TIEMPO is seconds, VEL1 a power."""

from __future__ import annotations

from tiniscript.base.words import POWER, TIME, Argument, lexicon_meaning, names_argument


def is_time(name: str) -> bool:
    return _names_argument(name, TIME)


def is_power(name: str) -> bool:
    return _names_argument(name, POWER) or any(
        lexicon_meaning(part, "power") for part in _parts(name)
    )


def value_of(name: str) -> str:
    """Return a value that a variable of this name may have, "" if the name says nothing."""
    if is_power(name):
        return "50"
    return "2" if is_time(name) else ""


def yes_no_of(word: str) -> str:
    """Return the yes-no value of a word about a lamp, a button or a pin: TRUE for ON, FALSE for
    OFF.
    """
    return (
        "TRUE" if lexicon_meaning(word, "lit") else "FALSE" if lexicon_meaning(word, "dark") else ""
    )


def use_of(name: str) -> str:
    """Return a use of a variable with this name: `F(2, SPEED)`, `F(TIME_S, 80)`, `SHOW(X)`."""
    if is_power(name):
        return f"F(2, {name})"
    return f"F({name}, 80)" if is_time(name) else f"SHOW({name})"


def _names_argument(name: str, argument: Argument) -> bool:
    """Return whether a part of a name is a usual name of the argument."""
    return any(names_argument(part, argument) for part in _parts(name))


def _parts(name: str) -> list[str]:
    return [part.rstrip("0123456789") for part in name.split("_")]
