"""What a robot says to a person beside what is wrong with a line: `remarks.h` and `remarks.cpp`."""

from __future__ import annotations

from tiniscript.bytecode.opcodes import FAULTS
from tiniscript.link.messages import LINK_FAULTS
from tiniscript.text.remarks import REMARKS
from tools.generate.cpp_header import camel
from tools.generate.text_tables import file_of, in_both, strings


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
            "// The text of a remark, in flash; a 0 ends it.",
            "const uint8_t* text_of(Remark remark);",
            "",
            "// The name of a fault, in flash; a 0 ends it.",
            "const uint8_t* name_of_fault(uint8_t fault);",
        ],
    )


def remarks_texts(command: str) -> str:
    """Return `remarks.cpp`. The last of the names of faults is that of the highest number."""
    first = LINK_FAULTS[0][0]
    own = sum(number < first for number, *_ in FAULTS)
    names = [name for _, name, _ in sorted((*FAULTS, *LINK_FAULTS))]
    return file_of(
        command,
        "remarks.cpp",
        "",
        [
            *in_both("kRemarkTexts", "Remark remark", REMARKS),
            "",
            "namespace {",
            "",
            "const uint8_t kFaultNames[] tini_progmem =",
            *strings(names),
            "",
            "}  // namespace",
            "",
            "const uint8_t* name_of_fault(uint8_t fault) {",
            f"  if (fault > {LINK_FAULTS[-1][0]}) return text_at(kFaultNames, {len(names)});",
            f"  if (fault >= {first}) fault = static_cast<uint8_t>(fault - {first - own - 1});",
            "  return text_at(kFaultNames, fault);",
            "}",
        ],
        include=("kit_words.h", "problems.h"),
    )
