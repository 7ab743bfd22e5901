"""The disassembly: code as text, and that text as code.

The text that `tsc show` prints and that cases compare: offset, bytes, instruction. Reading one
takes the bytes; the words after them are for people.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import NamedTuple

from tiniscript.base.kit import Kit
from tiniscript.bytecode.opcodes import Op, instruction_text, op_at, read_operands

_ROW = re.compile(r"([0-9a-f]{4})  ((?:[0-9a-f]{2} )*[0-9a-f]{2})(?:  |$)")
_BYTES_WIDTH = 18  # room for six bytes


class Row(NamedTuple):
    """One instruction; `op` is None for bytes that are not an instruction."""

    offset: int
    data: bytes
    op: Op | None
    operands: tuple[int, ...]

    @property
    def text(self) -> str:
        if self.op is None:
            return "?"
        return instruction_text(self.op, self.operands, self.offset + len(self.data))


def rows(code: bytes) -> list[Row]:
    """Return the instructions of `code`, verified or not; other bytes have rows of their own."""
    found_rows = []
    offset = 0
    while offset < len(code):
        op = op_at(code, offset)
        if op is None or offset + op.size > len(code):
            data = code[offset : offset + 1] if op is None else code[offset:]
            found_rows.append(Row(offset, data, None, ()))
        else:
            data = code[offset : offset + op.size]
            found_rows.append(Row(offset, data, op, read_operands(op, code, offset)))
        offset += len(data)
    return found_rows


def disassemble(
    code: bytes, remarks: Mapping[int, str] | None = None, kit: Kit | None = None,
    variables: Sequence[str] = (),
) -> str:  # fmt: skip
    """Return `code` as text, a line for each instruction.

    `remarks` come after the instruction at their offset; a kit gives devices their names, and
    `variables` are those of variables in the order of their numbers.
    """
    names_of_kind: dict[str, Sequence[str]] = {"variable": variables}
    if kit is not None:
        names_of_kind["sensor"] = [sensor.name for sensor in kit.readings]
        names_of_kind["actuator"] = [actuator.name for actuator in kit.actuators]
    lines = []
    for row in rows(code):
        text = row.text
        names = [
            names_of_kind[kind][value]
            for kind, value in _operand_values(row)
            if kind in names_of_kind and value < len(names_of_kind[kind])
        ]
        remark = "  ".join([*names, *([remarks[row.offset]] if remarks and row.offset in remarks
                                      else [])])  # fmt: skip
        line = f"{row.offset:04x}  {row.data.hex(' '):<{_BYTES_WIDTH}} {text}"
        lines.append(f"{line:<55} ; {remark}" if remark else line)
    return "".join(line.rstrip() + "\n" for line in lines)


def devices_of(row: Row) -> list[tuple[str, int]]:
    """Return the devices that an instruction names: "sensor" or "actuator", and its number."""
    return [(kind, value) for kind, value in _operand_values(row) if kind in ("sensor", "actuator")]


def _operand_values(row: Row) -> list[tuple[str, int]]:
    """Return the kind and the value of each operand, with the one that the opcode implies."""
    if row.op is None:
        return []
    kinds = [operand.kind.name for operand in row.op.operands]
    kinds_and_values = list(zip(kinds, row.operands, strict=True))
    if row.op.implied is not None:
        kinds_and_values.append((row.op.implied.kind.name, row.op.implied.value))
    return kinds_and_values


def assemble(text: str) -> bytes:
    """Return the bytes of a disassembly.

    Raises ValueError if a line is not an instruction, or its offset is wrong.
    """
    code = bytearray()
    for line in text.splitlines():
        if not line.strip():
            continue
        match = _ROW.match(line.strip())
        if match is None or int(match[1], 16) != len(code):
            raise ValueError(f"no line of a disassembly at offset {len(code):04x}: {line!r}")
        code += bytes.fromhex(match[2])
    return bytes(code)
