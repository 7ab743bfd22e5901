"""What a robot says to a person: `remarks.h`, and the texts of problems and remarks, packed."""

from __future__ import annotations

from collections.abc import Sequence

from tiniscript.bytecode.opcodes import FAULTS
from tiniscript.link.messages import LINK_FAULTS
from tiniscript.text.problems import PROBLEMS
from tiniscript.text.remarks import REMARKS
from tools.generate.cpp_header import camel
from tools.generate.packed_texts import DEEPEST, FIRST_PAIR, packed, unpacked
from tools.generate.text_tables import file_of


def remarks_header(command: str) -> str:
    """Return `remarks.h`."""
    rows = [
        f"  k{camel(remark.name)} = {number},  // {remark.english}".rstrip(" /")
        for number, remark in enumerate(REMARKS, 1)
    ]
    return file_of(
        command,
        "remarks.h",
        "// What the robot says to a person beside what is wrong with a line.\n",
        [
            "enum class Remark : uint8_t {",
            "  kNone = 0,",
            *rows,
            "};",
            "",
            "// The text of a remark, in flash, packed; a 0 ends it.",
            "const uint8_t* text_of(Remark remark);",
            "",
            "// The name of a fault, in flash, packed; a 0 ends it.",
            "const uint8_t* name_of_fault(uint8_t fault);",
        ],
    )


def texts_header(command: str) -> str:
    """Return `texts.h`."""
    return file_of(
        command,
        "texts.h",
        "// How the texts of problems and remarks are packed.\n",
        [
            "// A byte from this one on stands for two, in flash, which may be such bytes again,",
            f"// {DEEPEST} deep.",
            f"constexpr uint8_t kFirstPair = 0x{FIRST_PAIR:02x};",
            "const uint8_t* pair_of(uint8_t code);",
        ],
    )


def rows(language: str) -> list[str]:
    """Return all that a robot says in a language, in the order of the table."""
    names = [name for _, name, _ in sorted((*FAULTS, *LINK_FAULTS))]
    said = [(row.english, row.spanish) for row in (*PROBLEMS, *REMARKS)]
    return [*(spanish if language == "es" else english for english, spanish in said), *names]


def texts(command: str) -> str:
    """Return `texts.cpp`. The last of the names of faults is that of the highest number."""
    first = LINK_FAULTS[0][0]
    own = sum(number < first for number, *_ in FAULTS)
    names = [name for _, name, _ in sorted((*FAULTS, *LINK_FAULTS))]
    before = len(PROBLEMS) + len(REMARKS)
    return file_of(
        command,
        "texts.cpp",
        "",
        [
            "namespace {",
            "",
            *_tables("English", rows("en")),
            "",
            *_tables("Spanish", rows("es")),
            "",
            "// The text of this number, from 1: they lie one after the other.",
            "const uint8_t* text_at(uint8_t number) {",
            "  const uint8_t* text = robot_speaks_spanish() ? kSpanish : kEnglish;",
            "  for (; number > 1; number--) {",
            "    while (flash_byte(text++) != 0) {",
            "    }",
            "  }",
            "  return text;",
            "}",
            "",
            "}  // namespace",
            "",
            "const uint8_t* text_of(Problem problem) {",
            "  return text_at(static_cast<uint8_t>(problem));",
            "}",
            "",
            "const uint8_t* text_of(Remark remark) {",
            f"  constexpr uint8_t kProblems = {len(PROBLEMS)};",
            "  return text_at(static_cast<uint8_t>(kProblems + static_cast<uint8_t>(remark)));",
            "}",
            "",
            "const uint8_t* name_of_fault(uint8_t fault) {",
            f"  if (fault > {LINK_FAULTS[-1][0]}) return text_at({before + len(names)});",
            f"  if (fault >= {first}) fault = static_cast<uint8_t>(fault - {first - own - 1});",
            f"  return text_at(static_cast<uint8_t>({before} + fault));",
            "}",
            "",
            "const uint8_t* pair_of(uint8_t code) {",
            "  return (robot_speaks_spanish() ? kSpanishPairs : kEnglishPairs)[code - kFirstPair];",
            "}",
        ],
        include=("kit_words.h", "problems.h", "remarks.h"),
    )


def _tables(language: str, rows: Sequence[str]) -> list[str]:
    """Return the texts of a language. On a board the linker leaves the other one out."""
    pairs, codes = packed(rows)
    return [
        f"const uint8_t k{language}[] tini_progmem =",
        *(
            f'    "{_escaped(code)}\\0"  // {row}'.rstrip(" /")
            for code, row in zip(codes, rows, strict=True)
        ),
        "    ;",
        "",
        f"const uint8_t k{language}Pairs[][2] tini_progmem = {{",
        *(
            f"    {{0x{one:02x}, 0x{two:02x}}},  // {unpacked(bytes((one, two)), pairs)}"
            for one, two in pairs
        ),
        "};",
    ]


def _escaped(data: bytes) -> str:
    return "".join(chr(each) if each < FIRST_PAIR else f"\\{each:03o}" for each in data)
