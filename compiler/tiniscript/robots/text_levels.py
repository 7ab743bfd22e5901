"""The levels of robots that read text: which words each lacks, and how much room it has.

All other limits (variables, blocks, values on the stack, DEFs, calls) are those of the language.
"""

# No `from __future__ import annotations`: typing would compile each field's again, one by one.
from typing import NamedTuple

from tiniscript.base.words import ALIASES, BLOCK_ENDS, EXTENTS, TASKS, WORDS

CODE_BYTES = 255  # bytes of a typed program; a one-byte jump spans all of it
LONGEST_WORD = 255  # letters of a word that a reader stores


def _block_words(*blocks: str) -> frozenset[str]:
    """Return the words of blocks, and those that end them."""
    ends = {BLOCK_ENDS[block] for block in blocks}
    return frozenset((*blocks, *ends, *(alias for alias, end in ALIASES.items() if end in ends)))


TASK_AND_EXTENT_WORDS = _block_words(*TASKS) | EXTENTS.keys()

# The roles of the instructions that a reader knows, by `codegen/text/memory.py` and in
# `vm_arduino/src/text/`. No level reads others: their names are taken, and no more.
READ_ROLES = frozenset(("move", "wait", "motors", "beep", "show", "stop"))
_INSTRUCTIONS = (word for word in WORDS.values() if word.role.is_instruction)
_UNREAD_INSTRUCTIONS = [word for word in _INSTRUCTIONS if word.role.name not in READ_ROLES]
NEVER_READ_WORDS = frozenset(word.text for word in _UNREAD_INSTRUCTIONS if not word.expansion)
UNREAD_WORDS = frozenset(
    word.text for word in _UNREAD_INSTRUCTIONS
)  # including those that `line` writes


class Level(NamedTuple):
    """`missing_words` are words of the language that this level's reader does not read.

    A Nano has the level of its chip, `uno`.
    """

    name: str
    board: str  # the board whose memory it has, named as in `robots.boards`
    sensor_bytes: int  # bytes of a set of sensors in its reader, one bit for each
    missing_words: frozenset[str] = frozenset()

    @property
    def room(self) -> int:
        """Bytes for the code, and for all that the reader remembers until a program's end.

        It is the memory for a program's image, without its header.
        """
        return _program_bytes(self.board)


def _program_bytes(board: str) -> int:
    from tiniscript.robots.boards import CHIPS  # the options of every verb name the levels

    return CHIPS[board].program_bytes


LEVELS = {
    level.name: level
    for level in (
        Level("uno", "uno", 2, _block_words("DEF") | TASK_AND_EXTENT_WORDS | NEVER_READ_WORDS),
        Level("mega", "mega", 4, NEVER_READ_WORDS),
        Level("esp32", "esp32dev", 4, NEVER_READ_WORDS),
    )
}

# A robot that reads no text, and so no word.
NO_TEXT = Level("none", "uno", 0, frozenset((*WORDS, *ALIASES)))


def level_of(chip: str, has_discs: bool = False) -> Level:
    """Return the level of a robot with this chip, a name of `robots.boards`.

    On an Uno or a Nano discs have the place of the reader.
    """
    room = _program_bytes(chip)
    level = next(level for level in LEVELS.values() if level.room == room)
    return NO_TEXT if has_discs and level.name == "uno" else level
