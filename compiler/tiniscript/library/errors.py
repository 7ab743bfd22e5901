"""The exceptions of the library: `str()` of each is a sentence for a person.

`reason` is a short name that is the same in every language; `values` fill the gaps of the
sentence.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from tiniscript.base import languages

if TYPE_CHECKING:
    from tiniscript.diagnostics.rendering import Message


def sentence(reason: str, language: str, values: Mapping[str, str]) -> str:
    """Return the sentence for a reason, with its gaps filled.

    The command has sentences of its own, which name its options; where they do not, they are those
    of the library, too.
    """
    if languages.find_text("library", reason, languages.SOURCE_LANGUAGE) is not None:
        return languages.text("library", reason, language).format(**values)
    text = languages.text("command", reason, language).removeprefix("tsc: ")
    return f"{text[:1].upper()}{text[1:]}".format(**values)


_REASON_WITHOUT_HINT = {
    "port_missing_but": "port_missing",
    "port_not_found_but": "port_not_found",
    "port_forbidden_linux": "port_forbidden",
}


class TiniScriptError(Exception):
    """The base of all exceptions of the library."""

    def __init__(
        self, reason: str, language: str = "en", values: Mapping[str, str] | None = None,
        sentence_text: str | None = None,
    ) -> None:  # fmt: skip
        """`sentence_text` replaces the sentence that `reason` has in the catalogue `library`."""
        self.key = reason  # key of its message, which may be more specific than the reason
        self.reason = _REASON_WITHOUT_HINT.get(reason, reason)
        self.values = dict(values or {})
        super().__init__(
            sentence(reason, language, self.values) if sentence_text is None else sentence_text
        )


class UsageError(TiniScriptError, ValueError):
    """A function was called with a wrong argument."""


class ProgramError(TiniScriptError):
    """A program is wrong. `diagnostics` has all mistakes and warnings of its text, by place.

    It is empty for bytes that are no image, and for a program that is too large for the robot.
    """

    diagnostics: tuple[Message, ...] = ()


class RobotError(TiniScriptError):
    """The robot or the connection has failed: `reason` is `port_missing`, `link_lost`, the name of
    a status of the link, or another short name."""


class StopNotConfirmed(RobotError):
    """The robot was told to stop and has not confirmed it: it may still drive."""
