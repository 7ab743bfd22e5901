"""Finds words of a program that its robot's kit lacks, but the kits of other robots have.

Knows the diagnostics of a program and the kits of other robots. Opens no profile.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from tiniscript.base.kit import Kit
from tiniscript.base.words import said_of
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Diagnostic
from tiniscript.syntax.lexer import WORD, scan

_UNKNOWN = (codes.UNKNOWN_NAME, codes.UNKNOWN_WORD)
_NUMBERS = ("first", "second", "third")


def is_unknown(diagnostic: Diagnostic) -> bool:
    """Whether a word is not known to the program's robot: another kit may have it."""
    return diagnostic.code in (*_UNKNOWN, codes.OTHER_ROBOT)


def naming_robots(
    found: Sequence[Diagnostic],
    text: str,
    own: tuple[str, Kit],
    others: Mapping[str, Kit],
    meant: Callable[[str], str | None],
) -> list[Diagnostic]:
    """Return diagnostics that name the robots that have an unknown word; at most three of them.

    Where a robot has all kit words of the program, those that lack one are not named. `meant` says
    which word of a kit a word in another language is.
    """
    known = {robot: words(kit) for robot, kit in others.items() if robot != own[0]}
    of_kits = words(own[1]).union(*known.values())
    said = {token.text for token in scan(text).tokens if token.kind is WORD}
    used = {word if word in of_kits else meant(word) for word in said} & of_kits
    whole = [robot for robot, its in known.items() if used <= its]
    named = []
    for diagnostic in found:
        word = diagnostic.values.get("found", "").upper()
        word = word if word in of_kits else meant(word) or word
        side = f"{''.join(said_of(word, 'stem')) or word}_L"  # `LINEA`, where others have LINE_L
        word = side if side in of_kits - words(own[1]) else word
        having = [robot for robot, its in known.items() if word in its - words(own[1])]
        if diagnostic.code in _UNKNOWN and having:
            robots = [robot for robot in having if robot in whole] or having
            numbered = dict(zip(_NUMBERS, robots, strict=False))
            values = {"found": word, "own": own[0], **numbered}
            diagnostic = Diagnostic(codes.OTHER_ROBOT, diagnostic.span, values)
        named.append(diagnostic)
    return named


def words(kit: Kit) -> frozenset[str]:
    """Return the names that a kit has."""
    return frozenset(device.name for device in (*kit.sensors, *kit.actuators))
