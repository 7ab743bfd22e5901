"""The compiler's tables for the robot's reader of text: its words and answers.

Knows how the tables of `vm_arduino/src/text/` are packed. `__main__.py` writes the files.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

from tiniscript.base.fixed_point import HIGHEST, LOWEST
from tiniscript.base.languages import SOURCE_LANGUAGE
from tiniscript.base.limits import BLOCKS
from tiniscript.base.words import ALIASES, WORDS, Word
from tiniscript.bytecode.image import STARTS
from tiniscript.bytecode.opcodes import BY_NAME
from tiniscript.codegen.text.problems import PROBLEMS, problem_text
from tiniscript.robots.kit_words import pack_range, pack_word
from tiniscript.robots.text_levels import TASK_AND_EXTENT_WORDS, UNREAD_WORDS
from tools.generate.cpp_header import camel, cpp_file, enumeration

FIRST_WORD = 0x40  # the token of the first word; those of signs lie below and above
# Roles in the order in which the reader wants their words: those with brackets first.
ROLES = ("move", "wait", "motors", "beep", "show", "loop", "question", "stop", "start", "else",
         "def", "break", "end", "value", "operator", "function", "forever", "setup",
         "task", "later")  # fmt: skip
ANY_KIND, YES_NO_KIND, NUMBER_KIND, FIRST_RANGE = 1, 2, 3, 4  # kinds of arguments
OPCODES = {"W": "WAIT", "M": "MOTORS", "BEEP": "BEEP", "SHOW": "SHOW", "LOOP": "LOOP", "IF": "IF",
           "ELSEIF": "IF", "WHILE": "IF", "UNTIL": "UNTIL"}  # fmt: skip


def role_of(word: Word) -> str:
    """Return the role by which the reader tells words apart: one of ROLES.

    A word that no level reads is like those of later versions: its name is taken, and that is all.
    They are not said, and no more are other spellings of the ends of tasks.
    """
    if word.text in UNREAD_WORDS:
        return "later"
    if word.text in TASK_AND_EXTENT_WORDS:
        return "later" if word.text in ALIASES else "task"
    if word.text in ("LOOP", "DEF", "ELSE"):
        return word.text.lower()
    roles = {"block": "question", "arm": "question", "until": "question", "alias": "end"}
    role = roles.get(word.role.name, word.role.name)
    if role not in ROLES:
        raise LookupError(
            f"a robot's reader of text is to know {word.text} "
            f"(READ_ROLES in robots/text_levels.py): its role, {role}, needs a name in ROLES of "
            "tools/generate/text_tables.py, and what it does in vm_arduino/src/text/"
        )
    return role


def opcode_of(word: Word) -> int:
    """Return the code of the instruction that a reader makes of a word after its arguments."""
    name = OPCODES.get(word.text, f"MOVE_{word.text}")
    if name not in BY_NAME:
        raise LookupError(
            f"{word.text} takes arguments, and a robot's reader of text does not know its "
            "instruction: a row of OPCODES in tools/generate/text_tables.py"
        )
    return BY_NAME[name].code


def words_in_order() -> list[Word]:
    """Return the words of the language as the reader numbers them."""
    # Numbers in an image and in the bytecode.
    numbered_words = [
        *STARTS,
        "CHECK_CONNECTION",
        "FALSE",
        "TRUE",
        "TIME",
        "ABS",
        "MIN",
        "MAX",
        "ROUND",
    ]

    def sort_key(word: Word) -> tuple[int, int]:
        number = (
            numbered_words.index(word.text) if word.text in numbered_words else len(numbered_words)
        )
        role = ROLES.index(role_of(word))
        return role, number if role_of(word) in ("setup", "value", "function") else 0

    return sorted(WORDS.values(), key=sort_key)


def ranges() -> list[tuple[int, int]]:
    """Return the ranges of arguments, each once, in the order of their words."""
    argument_ranges: list[tuple[int, int]] = []
    for word in words_in_order():
        for argument in word.arguments if role_of(word) not in ("function", "later") else ():
            pair = (argument.low, argument.high)
            if pair not in argument_ranges and pair != (LOWEST, HIGHEST):
                argument_ranges.append(pair)
    return argument_ranges


def _kinds(word: Word) -> int:
    """Return the kinds of a word's arguments: four bits each, the first one lowest."""
    role, kinds = role_of(word), 0
    for k, argument in enumerate(word.arguments):
        if role in ("question", "show"):
            kind = YES_NO_KIND if role == "question" else ANY_KIND
        elif (argument.low, argument.high) == (LOWEST, HIGHEST):
            kind = NUMBER_KIND
        else:
            kind = FIRST_RANGE + ranges().index((argument.low, argument.high))
        kinds |= kind << 4 * k
    return kinds


def bytes_before(name: str) -> int:
    """Return the number of letters in the words before this one, or before the first of this
    role.
    """
    words = words_in_order()
    (first_index, *_) = (
        index
        for index, word in enumerate(words)
        if name in (word.text, word.role.name, role_of(word))
    )
    return sum(len(word.text) for word in words[:first_index])


def bytes_of(role: str) -> int:
    """Return the number of letters in the words of this role, except those of tasks."""
    words = (word for word in words_in_order() if word.text not in TASK_AND_EXTENT_WORDS)
    return sum(len(word.text) for word in words if word.role.name == role)


def words_header(command: str) -> str:
    """Return `words.h`."""
    words = words_in_order()
    names = [
        f"constexpr uint8_t kWord{camel(word.text)} = 0x{FIRST_WORD + k:02x};"
        for k, word in enumerate(words)
    ]
    command_count = sum(role_of(word) in ROLES[: ROLES.index("stop")] for word in words)
    return file_of(
        command,
        "words.h",
        "The words of the language as the reader of text knows them.",
        [
            f"constexpr uint8_t kBlocks = {BLOCKS};  // open at once",
            "",
            f"constexpr uint8_t kFirstWord = 0x{FIRST_WORD:02x};",
            *names,
            f"constexpr uint8_t kWordsEnd = 0x{FIRST_WORD + len(words):02x};",
            "",
            "// The words up to this one take arguments in brackets.",
            f"constexpr uint8_t kCommands = {command_count};",
            "",
            "// What an argument may be; from kFirstRange on a number in a range.",
            f"constexpr uint8_t kAnyKind = {ANY_KIND};",
            f"constexpr uint8_t kYesNoKind = {YES_NO_KIND};",
            f"constexpr uint8_t kNumberKind = {NUMBER_KIND};",
            f"constexpr uint8_t kFirstRange = {FIRST_RANGE};",
            f"constexpr uint8_t kDeviceRange = {FIRST_RANGE + len(ranges())};  // of the kit",
            f"constexpr uint8_t kTimeRange = {FIRST_RANGE + ranges().index((0, HIGHEST))};",
            "",
            "// All words one after the other, 0x80 in the last letter of each, and a 0.",
            "// Other spellings begin at kAliasesAt, words of tasks and ways at kTaskWordsAt,",
            "// their other spellings and words of later versions at kLaterWordsAt.",
            f"constexpr uint8_t kAliasesAt = {bytes_before('alias')};",
            f"constexpr uint8_t kAliasBytes = {bytes_of('alias')};",
            f"constexpr uint8_t kTaskWordsAt = {bytes_before('task')};",
            f"constexpr uint8_t kLaterWordsAt = {bytes_before('later')};",
            f"constexpr uint8_t kDefAt = {bytes_before('DEF')};",
            f"constexpr uint8_t kDefBytes = {len('DEF')};",
            f"constexpr uint8_t kEndDefBytes = {len('END_DEF')};  // before kAliasesAt",
            "extern const uint8_t kWords[] tini_progmem;",
            "",
            "// Of each command: the kinds of its arguments (4 bits each), its opcode.",
            "extern const uint8_t kCommandRows[][2] tini_progmem;",
            "",
            "// The least and the largest plain number of each range, thousandths, little-endian.",
            "extern const uint8_t kArgumentRanges[][8] tini_progmem;",
        ],
    )


def words_tables(command: str) -> str:
    """Return `words.cpp`."""
    words = words_in_order()
    rows = []
    for word in words:
        if role_of(word) in ROLES[: ROLES.index("stop")]:
            row = f"{{0x{_kinds(word):02x}, 0x{opcode_of(word):02x}}}"
            rows.append(f"    {row},  // {word.text}")
    return file_of(
        command,
        "words.cpp",
        "",
        [
            "const uint8_t kWords[] tini_progmem = {",
            *(f"    {bytes_of_table(pack_word(word.text))}  // {word.text}" for word in words),
            "    0,",
            "};",
            "",
            "const uint8_t kCommandRows[][2] tini_progmem = {",
            *rows,
            "};",
            "",
            "const uint8_t kArgumentRanges[][8] tini_progmem = {",
            *(f"    {{{bytes_of_table(pack_range(low, high))}}}," for low, high in ranges()),
            "};",
        ],
    )


def problems_header(command: str) -> str:
    """Return `problems.h`."""
    comment = "What the reader of text says about a wrong line."
    return file_of(command, "problems.h", comment, [numbers_of("Problem", PROBLEMS)])


def numbers_of(name: str, keys: Sequence[str]) -> str:
    """Return an enum of a robot's messages, with their English texts."""
    rows = [
        (key, k, problem_text(name.lower(), key, SOURCE_LANGUAGE)) for k, key in enumerate(keys, 1)
    ]
    return enumeration(name, [("NONE", 0, ""), *rows]).rstrip("\n")


def bytes_of_table(data: Iterable[int]) -> str:
    """Return bytes as a row of a table has them."""
    return " ".join(f"0x{byte:02x}," for byte in data)


def file_of(command: str, name: str, comment: str, lines: Sequence[str], *includes: str) -> str:
    """Return a file of `vm_arduino/src/text/`; `includes` are more headers."""
    first_includes = ["../vm/cpu.h"] if name.endswith(".h") else [f"{Path(name).stem}.h"]
    if includes and not name.endswith(".h"):
        first_includes.append("")
    comment_lines = [comment] if comment else []
    return cpp_file(
        command, f"text/{name}", comment_lines, "\n".join([*lines, ""]), *first_includes, *includes
    )
