"""What can go wrong, as exceptions: `str()` of each is a sentence for a person.

`reason` is a short name that stays the same in every language; `values` are what fills the gaps
of the sentence.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from tiniscript.library.programs import Diagnostic


class TiniScriptError(Exception):
    """The base of all of them."""

    def __init__(
        self, reason: str, language: str = "en", values: Mapping[str, str] | None = None,
        said: str | None = None,
    ) -> None:  # fmt: skip
        """`said` is the sentence, where it is not the one that `reason` has in `texts`."""
        from tiniscript.library.texts import sentence

        self.reason = reason
        self.values = dict(values or {})
        super().__init__(sentence(reason, language, self.values) if said is None else said)


class UsageError(TiniScriptError, ValueError):
    """A function was called with something that it does not take."""


class ProgramError(TiniScriptError):
    """A program is wrong. `diagnostics` has all mistakes and warnings of its text, by place.

    It is empty for bytes that are no image, and for a program that has no room in the robot.
    """

    diagnostics: tuple[Diagnostic, ...] = ()


class RobotError(TiniScriptError):
    """The robot or the way to it: `reason` says what, such as `port_missing`, `link_lost` or the
    name of a status of the link."""


class StopNotConfirmed(RobotError):
    """The robot was told to stop and has not confirmed it: it may still drive."""
