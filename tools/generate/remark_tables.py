"""A robot's remarks to a person: `remarks.h`, and the packed texts of problems and remarks."""

from __future__ import annotations

from collections.abc import Sequence

from tiniscript.bytecode.opcodes import FAULTS
from tiniscript.codegen.text.problems import DEF_PROBLEMS, PROBLEMS, REMARKS, problem_text
from tiniscript.link.messages import LINK_FAULTS
from tiniscript.robots.profile import answer_languages, language_number
from tiniscript.robots.text_levels import LEVELS
from tools.generate.packed_texts import (
    END_CODE,
    FIRST_COMMON,
    FIRST_LETTER,
    MAX_NESTED_PAIRS,
    letters_of,
    pack_texts,
)
from tools.generate.text_tables import bytes_of_table, file_of, numbers_of

SMALLEST_LEVEL = "uno"


def remarks_header(command: str) -> str:
    """Return `remarks.h`."""
    comment = "What the robot says to a person beside what is wrong with a line."
    return file_of(command, "remarks.h", comment, [numbers_of("Remark", REMARKS)])


def texts_header(command: str) -> str:
    """Return `texts.h`. The last of the names of faults is that of the highest number."""
    first, last = LINK_FAULTS[0][0], LINK_FAULTS[-1][0]
    own_fault_count = sum(number < first for number, *_ in FAULTS)
    fault_offset = len(PROBLEMS) + len(REMARKS) - 1
    unknown_fault_number = fault_offset + len(FAULTS) + len(LINK_FAULTS)
    return file_of(
        command,
        "texts.h",
        "The texts of problems, remarks and faults: their numbers, and how they are packed.",
        [
            "// The numbers of texts, in the order in which they lie.",
            "constexpr uint8_t text_of(Problem problem) {",
            "  return static_cast<uint8_t>(static_cast<uint8_t>(problem) - 1);",
            "}",
            "constexpr uint8_t text_of(Remark remark) {",
            f"  return static_cast<uint8_t>(static_cast<uint8_t>(remark) + {len(PROBLEMS) - 1});",
            "}",
            "constexpr uint8_t name_of_fault(uint8_t fault) {",
            "  return static_cast<uint8_t>(",
            f"      fault > {last} ? {unknown_fault_number} "
            f": fault < {first} ? fault + {fault_offset}",
            "                             "
            f": fault - {first} + {fault_offset + own_fault_count + 1});",
            "}",
            "",
            "// A code is the end of a text, a pair, or a letter from kFirstLetter on, in ASCII.",
            "// The high half of a byte comes first. A half from kFirstCommon on is a code of",
            "// packed_codes(), any other one the first half of a code.",
            f"constexpr uint8_t kTextEnd = {END_CODE};",
            f"constexpr uint8_t kFirstLetter = 0x{FIRST_LETTER:02x};",
            f"constexpr uint8_t kFirstCommon = {FIRST_COMMON};",
            "",
            "// In flash: all texts, the codes of halves, and the two codes of each pair, which",
            f"// may be pairs again, {MAX_NESTED_PAIRS} deep.",
            "const uint8_t* packed_texts();",
            "const uint8_t* packed_codes();",
            "const uint8_t* pair_of(uint8_t code);",
        ],
        "problems.h",
        "remarks.h",
    )


def rows(language: str, is_small: bool = False) -> list[str]:
    """Return all that a robot says in a language, in the order of the table.

    `is_small`: texts that an ATmega328P never uses are empty, so that all others keep their
    numbers.
    """
    names = [name for _, name, _ in sorted((*FAULTS, *LINK_FAULTS))]
    rows = [("problem", problem) for problem in PROBLEMS] + [
        ("remark", remark) for remark in REMARKS
    ]
    unused_rows = _unused_remarks() if is_small else set()
    return [
        *("" if row in unused_rows else problem_text(*row, language) for row in rows),
        *("" if ("fault", name) in unused_rows else name for name in names),
    ]


def _unused_remarks() -> set[tuple[str, str]]:
    """Return the remarks that a robot of the smallest level never makes.

    Its own level is the only one, it has no place for words that it does not read, nor for lines of
    keys, and with discs on its wheels it reads no text.
    """
    levels = {("remark", f"LEVEL_{name.upper()}") for name in LEVELS if name != SMALLEST_LEVEL}
    assert "DEF" in LEVELS[SMALLEST_LEVEL].missing_words
    words = {("problem", name) for name in DEF_PROBLEMS}
    faults = {("fault", name) for _, name, _ in FAULTS if name.startswith("STUCK")}
    return levels | words | faults | {("remark", "NO_KEYS")}


def tables_of_texts(command: str, name: str, is_small: bool) -> str:
    """Return a header with the packed texts, for `texts.cpp` alone."""
    comment = "The packed texts of a robot that says all."
    if is_small:
        comment = "The packed texts of an ATmega328P that reads text: what it never says is empty."
    tables = [
        row
        for language in answer_languages()
        for row in (*_tables(language, rows(language, is_small=is_small)), "")
    ]
    return file_of(command, name, comment, ["namespace {", "", *tables, "}  // namespace"])


def texts(command: str, all_texts: str, small_texts: str) -> str:
    """Return `texts.cpp`, which takes one of the two headers."""
    return file_of(
        command,
        "texts.cpp",
        "",
        [
            "static_assert(kHasDiscs || !kReadsDefs,",
            '              "the shorter table does not say where a DEF goes");',
            "",
            *_table_function("packed_texts()", ""),
            "",
            *_table_function("packed_codes()", "Codes"),
            "",
            *_table_function("pair_of(uint8_t code)", "Pairs", "[code - 1]"),
        ],
        "../vm/build.h",
        "kit_words.h",
        "reader.h",
        "",
        "#ifdef tiniscript_has_discs",
        all_texts,
        "#else",
        small_texts,
        "#endif",
    )


def _table_function(function: str, table: str, index_text: str = "") -> list[str]:
    """Return a function that has a table of the robot's language."""
    first_table, *other_tables = (f"k{language.title()}{table}" for language in answer_languages())
    numbers = [language_number(language) for language in answer_languages()[1:]]
    pairs = zip(numbers, other_tables, strict=True)
    choice = "".join(f"robot_language() == 0x{number:04x} ? {other} : " for number, other in pairs)
    choice += first_table
    return [
        f"const uint8_t* {function} {{",
        f"  return {f'({choice}){index_text}' if index_text else choice};",
        "}",
    ]


def _tables(language: str, rows: Sequence[str]) -> list[str]:
    """Return the texts of a language. On a board the linker leaves the others out."""
    language = language.title()
    packed_texts = pack_texts(rows)
    lines = [
        packed_texts.texts[offset : offset + 16] for offset in range(0, len(packed_texts.texts), 16)
    ]
    return [
        f"const uint8_t k{language}[] tini_progmem = {{",
        *(f"    {bytes_of_table(line)}" for line in lines),
        "};",
        "",
        f"const uint8_t k{language}Codes[] tini_progmem = {{",
        f"    {bytes_of_table(packed_texts.common)}  // {_c_bytes(packed_texts.common)}",
        "};",
        "",
        f"const uint8_t k{language}Pairs[][2] tini_progmem = {{",
        *(
            f"    {{0x{first_code:02x}, 0x{second_code:02x}}},"
            f"  // 0x{number:02x}: {letters_of(number, packed_texts.pairs).decode('ascii')}"
            for number, (first_code, second_code) in enumerate(packed_texts.pairs, 1)
        ),
        "};",
    ]


def _c_bytes(codes: Sequence[int]) -> str:
    return "the end, " + ", ".join(f"'{chr(code)}'" for code in codes if code != END_CODE)
