"""The compiler's tables for the C++ machine: `bytecode.h` and `bytecode.cpp`.

Knows how the table of instructions is packed for machines with little memory. `__main__.py`
writes the files.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import accumulate
from types import ModuleType
from typing import NamedTuple

from tiniscript.base import limits
from tiniscript.base.kit import DEVICES_POLYNOMIAL, MAX_DEVICES
from tiniscript.bytecode import image, opcodes, verify

TASK_OPS = tuple(op for op in opcodes.OPS if op.needs == opcodes.NEEDS_TASKS)

# Operand kinds that a verifier distinguishes in the first two bytes; devices come last.
OPERAND_BYTE_KINDS = ("any", "power", "percent", "variable", "count", "sensor", "actuator")
FAR_BIT, BACK_BIT = 0x08, 0x10

# The families that the machine looks up: those beyond its inner loop, and those that the verifier
# distinguishes. All others share rows.
ACTS = tuple(op for op in opcodes.UNO_OPS if op.is_act)
ASKED_FAMILIES = (
    "PUSH_READ", "TIME", "RANDOM", "SHOW", "SHOW_YES_NO", *dict.fromkeys(op.family for op in ACTS),
    "LOOK", "END_WHEN",
)  # fmt: skip
FIRST_FOUR = 0x80  # from here on, groups of four codes have the same form
FIRST_SIX = 0xC8  # from here on, six of every eight codes do; the other two are unused


def header(command: str) -> str:
    """Return `bytecode.h`, the C++ machine's copy of the compiler's tables."""
    offsets = accumulate((field.size for field in image.FIELDS), initial=0)
    fields = [
        (f"k{camel(field.name)}At", offset)
        for offset, field in zip(offsets, image.FIELDS, strict=False)
    ]
    rules = [(name, number, meaning) for name, (number, meaning) in verify.RULES.items()]
    refusals = [(name, number, meaning) for name, (number, meaning) in image.REFUSALS.items()]
    faults = [(name, number, meaning) for number, name, meaning in opcodes.FAULTS]
    parts = (
        "// A machine runs images of its own major version, and of its own minor version or less.\n"
        + constants(("kIsaMajor", opcodes.ISA_MAJOR), ("kIsaMinor", opcodes.ISA_MINOR)),
        "// Limits, the same on every machine.\n"
        + constants_of(limits, "CODE_BYTES", "STACK_VALUES", "VARIABLES", "COUNTERS", "CALLS",
                       "DEFS", "TASKS", "NEST_WORDS", "JOINS")
        + constants(
            ("kDevices", MAX_DEVICES),
            ("kCheckMs", limits.CHECK_MS),
            ("kShorts", opcodes.SHORTS),
            ("kPowerHigh", opcodes.OPERAND_KINDS["power"].high),
            ("kPercentHigh", opcodes.OPERAND_KINDS["percent"].high),
        ),
        "// The header of an image: where each field begins. Numbers are little-endian.\n"
        + constants(
            *fields,
            ("kHeaderBytes", image.HEADER_BYTES),
            ("kDevicesPolynomial", DEVICES_POLYNOMIAL),
            ("kStarts", len(image.STARTS)),
            ("kStartPing", image.STARTS.index("PING")),
        ),
        "// Bits of what an image needs, and what this machine has of it.\n"
        + constants(("kNeedsTasks", image.TASKS), ("kNeedsWays", image.GO))
        + "constexpr uint8_t kNeeds = (kHasTasks ? kNeedsTasks : 0) | kNeedsWays;\n",
        minor_functions(),
        enumeration(
            "Op",
            [
                *((op.name, op.code, op.effect) for op in ordered_ops()),
                ("ESCAPE", opcodes.ESCAPE, "a second byte says which instruction it is"),
            ],
        ),
        "// The instructions that are left to Machine::act.\n#define tini_each_act \\\n  "
        + " : \\\n  ".join(f"case Op::k{camel(op.name)}" for op in ACTS)
        + "\n",
        way_constants(),
        "// Why bytes are no image for this machine.\n"
        + enumeration("Refusal", [("NONE", 0, "It is one."), *refusals]),
        "// Which rule code breaks.\n"
        + enumeration("Rule", [("NONE", 0, "It is accepted."), *rules]),
        "// What stops a running program.\n"
        + enumeration("Fault", [("NONE", 0, "It runs."), *faults]),
        "// What an instruction is for the structure of a program.\n"
        + enumeration(
            "ControlRole",
            [
                ("none", 0, "a byte that begins no instruction"),
                *(
                    (role, k, meaning)
                    for k, (role, meaning) in enumerate(opcodes.CONTROL_ROLES.items(), 1)
                ),
            ],
        ),
        "// What a byte of operands is.\n"
        + enumeration("Byte", [(name, k, "") for k, name in enumerate(OPERAND_BYTE_KINDS)]),
        form_numbers(),
    )  # fmt: skip
    comment_lines = (
        "The numbers of the bytecode: instructions, refusals, faults, limits and the header of",
        "an image. Knows no behaviour. `bytecode_spec.md` says what they mean.",
    )
    body = "\n".join(parts)
    return cpp_file(command, "vm/bytecode.h", comment_lines, body, "build.h", "cpu.h")


def cpp_file(
    command: str, name: str, comment_lines: Sequence[str], body: str, *includes: str
) -> str:
    """Return a file of `vm_arduino/src/`; `comment_lines` are lines of its comment.

    `includes` may contain the lines that choose one: `#ifdef tiniscript_has_discs`.
    """
    tables = "compiler/tiniscript" + ("/link" if name.startswith("link/") else "")
    rows = [f"// Generated by {command} from the tables in {tables}. Do not edit."]
    rows += ["//", *(f"// {row}" for row in comment_lines)] if comment_lines else []
    if name.endswith(".h"):
        rows += ["", "#pragma once", "", "#include <stdint.h>"]
    rows += [
        "",
        *(
            f'#include "{include}"' if include and not include.startswith("#") else include
            for include in includes
        ),
    ]
    rows += ["", "// clang-format off", "", "namespace tiniscript {", "", body]
    rows += ["}  // namespace tiniscript", ""]
    return "\n".join(rows)


def camel(name: str) -> str:
    """Return `MoveF` for `MOVE_F` and for `move_f`."""
    return "".join(part[:1].upper() + part[1:].lower() for part in name.split("_"))


def constants(*rows: tuple[str, int]) -> str:
    return "".join(
        f"constexpr uint{8 if value < 256 else 16}_t {name} = {value};\n" for name, value in rows
    )


def constants_of(module: ModuleType, *names: str) -> str:
    """Return the constants of a module, named as in C++."""
    return constants(*((f"k{camel(name)}", getattr(module, name)) for name in names))


def enumeration(name: str, rows: Sequence[tuple[str, int, str]]) -> str:
    """Return an enum of one byte; the third of each row is a comment."""
    lines = []
    for label, value, comment_text in rows:
        number = f"0x{value:02x}" if name == "Op" else str(value)
        comment = f"  // {comment_text}" if comment_text else ""
        lines.append(f"  k{camel(label)} = {number},{comment}".rstrip() + "\n")
    return f"enum class {name} : uint8_t {{\n{''.join(lines)}}};\n"


def minor_functions() -> str:
    """Return the code that computes an image's minor version from its instructions and `needs`."""
    since_of_code = {
        op.code: op.since_minor
        for op in opcodes.OPS
        if op.since_minor > opcodes.SINCE_OF_NEED.get(op.needs, 0)
    }
    assert not {*since_of_code} & {*opcodes.ESCAPED_OPS} and all(
        code <= 0xFF for code in since_of_code
    ), "the byte after an escape would have to be told from an instruction of one byte"
    by_code = "".join(f"code == 0x{code:02x} ? {since} : " for code, since in since_of_code.items())
    needs_by_since: dict[int, int] = {}
    for need, since in opcodes.SINCE_OF_NEED.items():
        needs_by_since[since] = needs_by_since.get(since, 0) | need
    *later_needs, first = sorted(needs_by_since.items(), reverse=True)
    by_need = "".join(f"(needs & 0x{needs:02x}) != 0 ? {since} : " for since, needs in later_needs)
    by_need += f"needs != 0 ? {first[0]} : "
    return (
        "// The minor version that an instruction came with, beside what its `needs` says. An\n"
        "// image has the newest of its instructions.\n"
        f"constexpr uint8_t minor_of_op(uint8_t{' code' if by_code else ''})"
        f" {{ return {by_code}0; }}\n"
        f"constexpr bool kOpsHaveMinors = {str(bool(by_code)).lower()};\n"
        f"constexpr uint8_t minor_of_needs(uint8_t needs) {{ return {by_need}0; }}\n"
    )


def way_constants() -> str:
    """Return the constants of the second bytes: those of a MOVE and of a WATCH."""
    twin_of = {"GO": "MOVE", "WATCH_GO": "WATCH"}
    for code, op in opcodes.ESCAPED_OPS.items():
        base, _, direction = op.name.rpartition("_")
        twin = opcodes.BY_NAME[f"{twin_of[base]}_{direction}"]
        assert (twin.code, twin.control_role, twin.pops) == (
            code,
            op.control_role,
            op.pops,
        ) and not op.operands
    mask, value = 0xF4, min(opcodes.ESCAPED_OPS)
    assert {code for code in range(256) if code & mask == value} == set(opcodes.ESCAPED_OPS)
    return (
        "// Whether a second byte is that of GO or of WATCH_GO: the code of MOVE or of WATCH.\n"
        "constexpr bool is_way(uint8_t code) {"
        f" return (code & 0x{mask:02x}) == 0x{value:02x}; }}\n"
    )


class DecodeForm(NamedTuple):
    """The properties of an opcode for the verifier and the machine."""

    family: str
    role: str
    pop_count: int
    push_count: int
    size: int
    is_far: bool
    is_back: bool
    first: str  # two of BYTES
    second: str


NONE = DecodeForm("NONE", "none", 0, 0, 1, False, False, "any", "any")


def byte_of(kind: opcodes.OperandKind) -> str:
    """Return the possible first bytes of an operand."""
    is_any = kind.size > 1 or kind.high - kind.low == 255
    return "any" if is_any and kind.name not in OPERAND_BYTE_KINDS else kind.name


def decode_form_of(op: opcodes.Op) -> DecodeForm:
    jumps = [operand.kind.name.startswith(("fwd", "back")) for operand in op.operands]
    assert not any(jumps[:-1]), "a jump is the last operand"
    kinds = [byte_of(operand.kind) for operand in op.operands]
    if op.implied is not None:
        assert op.size == 1 and op.code % opcodes.SHORTS == op.implied.value
        kinds = [byte_of(op.implied.kind)]
    assert kinds[2:] in ([], ["any"])
    first, second, *_ = [*kinds, "any", "any"]
    is_far = any(jumps) and op.operands[-1].kind.size == 2
    is_back = any(jumps) and op.operands[-1].kind.name.startswith("back")
    family = op.family if op.family in ASKED_FAMILIES else ""
    if family and op.implied:
        family += "_SHORT"
    return DecodeForm(
        family, op.control_role, op.pops, op.pushes, op.size, is_far, is_back, first, second
    )


def forms() -> dict[DecodeForm, list[opcodes.Op]]:
    """Return the opcodes of each form: first unused codes, then those with a family."""
    rows: dict[DecodeForm, list[opcodes.Op]] = {NONE: []}
    for op in sorted(ordered_ops(), key=place_of):
        rows.setdefault(decode_form_of(op), []).append(op)
    return rows


def place_of(op: opcodes.Op) -> tuple[bool, int]:
    """Return the place of an opcode's row: those only for tasks are last."""
    return op in TASK_OPS, (*ASKED_FAMILIES, op.family).index(op.family)


def ordered_ops() -> tuple[opcodes.Op, ...]:
    """Return all instructions, those of tasks last: some machines do without them."""
    return opcodes.UNO_OPS + TASK_OPS


def form_numbers() -> str:
    """Return the families and the declarations of the tables, for the header."""
    family_rows = [
        (form.family, number, names(ops) if len(ops) > 1 else "")
        for number, (form, ops) in enumerate(forms().items())
        if form.family
    ]
    return "\n".join(
        (
            "// What an instruction does, where the inner loop cannot do it alone: the number of\n"
            "// its form. The others have no names.\n" + enumeration("Family", family_rows),
            "// Bits of the size of a form.\n" + constants(("kFar", FAR_BIT), ("kBack", BACK_BIT)),
            "// The number of each opcode's form; from kFirstFour on one for four of them. Of\n"
            "// eight from kFirstSix on the last two are no opcodes.\n"
            + constants(("kFirstFour", FIRST_FOUR), ("kFirstSix", FIRST_SIX)),
            "extern const uint8_t kFormOf[] tini_progmem;\n",
            "// Of each form: pops (2 bits), pushes (1) and role (5); the number of its\n"
            "// operands (3), kBack, kFar and size (3).\n"
            "extern const uint8_t kForms[][2] tini_progmem;\n",
            "// Of operands: what the second byte is (4 bits) and the first (4).\n"
            "extern const uint8_t kOperands[] tini_progmem;\n",
            "// The least value of a Byte, and how much more than that it may be.\n"
            "extern const uint8_t kRanges[][2] tini_progmem;\n",
        )
    )


def tables(command: str) -> str:
    """Return `bytecode.cpp`: the tables that the header declares."""
    ops_by_form = forms()
    numbers = {op.code: number for number, ops in enumerate(ops_by_form.values()) for op in ops}
    form_numbers_of_codes = [numbers.get(code, 0) for code in range(256)]
    packed_rows = [
        form_numbers_of_codes[code - code % 4 if code >= FIRST_FOUR else code]
        for code in range(256)
    ]
    for code in range(FIRST_SIX, 256):
        packed_rows[code] = 0 if code % 8 >= 6 else packed_rows[code]
    assert packed_rows == form_numbers_of_codes
    entries = [
        f"0x{item:02x}"
        for item in form_numbers_of_codes[:FIRST_FOUR] + form_numbers_of_codes[FIRST_FOUR::4]
    ]
    for op in TASK_OPS:
        assert op.code < FIRST_FOUR
        entries[op.code] = f"kHasTasks ? {entries[op.code]} : 0"
    with_tasks = {decode_form_of(op) for op in TASK_OPS}
    assert list(ops_by_form)[-len(with_tasks) :] == [
        row for row in ops_by_form if row in with_tasks
    ]
    kinds = {byte_of(kind): kind for kind in opcodes.OPERAND_KINDS.values() if kind.size == 1}
    ranges = [
        (0, 255) if name == "any" else (kinds[name].low, kinds[name].high)
        for name in OPERAND_BYTE_KINDS
    ]
    return "\n".join(
        (
            f"// Generated by {command} from the tables in compiler/tiniscript. Do not edit.\n",
            '#include "bytecode.h"\n',
            "// clang-format off\n",
            "namespace tiniscript {\n",
            array(
                "kFormOf[]",
                [
                    (
                        ", ".join(entries[offset : offset + 16]),
                        f"{offset if offset < FIRST_FOUR else 4 * offset - 3 * FIRST_FOUR:02x}",
                    )
                    for offset in range(0, len(entries), 16)
                ],
            ),
            array(
                "kForms[][2]",
                [(pack_form(form), names(ops)) for form, ops in ops_by_form.items()],
                len(with_tasks),
            ),
            array(
                "kOperands[]",
                [(f"0x{number:02x}", ", ".join(kinds)) for number, kinds in operands().items()],
            ),
            array(
                "kRanges[][2]",
                [
                    (f"{{{low % 256}, {high - low}}}", name)
                    for name, (low, high) in zip(OPERAND_BYTE_KINDS, ranges, strict=True)
                ],
            ),
            "}  // namespace tiniscript\n",
        )
    )


def array(name: str, rows: Sequence[tuple[str, str]], task_row_count: int = 0) -> str:
    """Return a table; the second of each row is a comment. The last `task_row_count` need tasks."""
    lines = [f"    {row},  // {comment or '--'}\n" for row, comment in rows]
    if task_row_count:
        task_rows = rows[-task_row_count:]
        lines[-task_row_count:] = [
            f"    tini_of_tasks({row},)  // {comment}\n" for row, comment in task_rows
        ]
    return f"const uint8_t {name} tini_progmem = {{\n{''.join(lines)}}};\n"


def names(ops: Sequence[opcodes.Op]) -> str:
    return ", ".join(op.name for op in ops[:4]) + (" ..." if len(ops) > 4 else "")


def pack_form(form: DecodeForm) -> str:
    roles = ("none", *opcodes.CONTROL_ROLES)
    assert (
        form.size < 8 and form.pop_count < 4 and form.push_count < 2 and roles.index(form.role) < 32
    )
    effects = form.pop_count << 6 | form.push_count << 5 | roles.index(form.role)
    size = form.size | FAR_BIT * form.is_far | BACK_BIT * form.is_back
    number = list(operands()).index(operand_bytes(form))
    assert number < 8, "three bits say which operands a form has"
    return f"{{0x{effects:02x}, 0x{number << 5 | size:02x}}}"


def operand_bytes(form: DecodeForm) -> int:
    return OPERAND_BYTE_KINDS.index(form.second) << 4 | OPERAND_BYTE_KINDS.index(form.first)


def operands() -> dict[int, tuple[str, str]]:
    """Return the possible first two bytes of operands, each once, by packed number."""
    return {operand_bytes(form): (form.first, form.second) for form in forms()}
