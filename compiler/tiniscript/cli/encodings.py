"""What stands for a character that an output cannot have.

A window of Windows shows each character, but what goes from there into a file or a pipe is in
cp1252, cp850 or another of its code pages, without Ω, arrows and dots. A sign that has a plain
counterpart becomes it; any other character becomes its number, as `\\u03c0`.
"""

from __future__ import annotations

import codecs

NAME = "tiniscript_plain"  # of the handler of errors
# for drawings: as wide as what they stand for
_SAME_WIDTH = ("│─├┤█▌▐♪↑↖←↙↓↘→↗", "|-||#==~^\\</v\\>/")
DRAWN = str.maketrans(_SAME_WIDTH[0] + "…", _SAME_WIDTH[1] + ".")
_WORDS = {
    "Ω": "ohm", "−": "-", "–": "-", "—": "-", "…": "...", "‘": "'", "’": "'", "“": '"',
    "”": '"', "×": "x", "\N{REPLACEMENT CHARACTER}": "?",
}  # fmt: skip
PLAIN = {**dict(zip(*_SAME_WIDTH, strict=True)), **_WORDS}


def register() -> None:
    """Make the handler known to Python's streams."""
    codecs.register_error(NAME, _plain)


def _plain(error: UnicodeError) -> tuple[str | bytes, int]:
    if isinstance(error, UnicodeEncodeError):
        end = error.start + 1
        found = PLAIN.get(error.object[error.start : end])
        if found is not None:
            return found, end
        error.end = end
    return codecs.backslashreplace_errors(error)
