"""Reads the tables of `bytecode_spec.md`: the oracles' knowledge of instructions.

It knows the layout of the page, but not the package: a table that says too little, or something
wrong, makes an oracle disagree.
"""

from __future__ import annotations

import re
from functools import lru_cache
from pathlib import Path
from typing import NamedTuple

ESCAPE = 0xFF
SPEC = Path(__file__).resolve().parent.parent.parent / "bytecode_spec.md"


class Operand(NamedTuple):
    """Its name, its kind, how many bytes it has, and its range."""

    name: str
    kind: str
    size: int
    low: int
    high: int

    def read(self, data: bytes) -> int:
        """Numbers are little-endian; those whose range has negative ones have a sign."""
        return int.from_bytes(data, "little", signed=self.low < 0)

    @property
    def is_distance(self) -> bool:
        """Return whether it is the distance of a jump."""
        return self.kind in ("fwd8", "fwd16", "back8", "back16")


class Instruction(NamedTuple):
    """A row of the table of instructions.

    `stem` is the name of its action: that of the instruction of which it is a short or far form. A
    short one has its operand `implied` by its code: the kind, and the value.
    """

    name: str
    stem: str
    operands: tuple[Operand, ...]
    implied: tuple[tuple[str, int], ...]
    takes: int
    leaves: int
    role: str
    code_size: int = 1

    @property
    def size(self) -> int:
        """Return the number of its bytes, including the opcode."""
        return self.code_size + sum(operand.size for operand in self.operands)

    def read(self, code: bytes, offset: int) -> list[tuple[Operand, int]]:
        """Return the operands with their values, where the instruction is at an offset."""
        operands = []
        offset += self.code_size
        for operand in self.operands:
            operands.append((operand, operand.read(code[offset : offset + operand.size])))
            offset += operand.size
        return operands

    def values(self, code: bytes, offset: int) -> list[int]:
        """Return the values except distances of jumps: implied, or read."""
        operand_values = [
            value for operand, value in self.read(code, offset) if not operand.is_distance
        ]
        return [value for _, value in self.implied] + operand_values

    def target(self, code: bytes, offset: int) -> int:
        """Return the target of a jump, or the next offset."""
        next_offset = offset + self.size
        distances = [part for part in self.read(code, offset) if part[0].is_distance]
        return next_offset + sum(
            -v if operand.kind[:4] == "back" else v for operand, v in distances
        )


def rows(name: str) -> list[list[str]]:
    """Return the cells of a generated table, without the backquotes around them."""
    text = SPEC.read_text(encoding="utf-8")
    begin_mark, end_mark = f"<!-- begin generated: {name} -->", f"<!-- end generated: {name} -->"
    lines = text[text.index(begin_mark) : text.index(end_mark)].splitlines()[3:]
    return [
        [cell.strip().strip("`") for cell in re.split(r"(?<!\\)\|", line)[1:-1]] for line in lines
    ]


@lru_cache(maxsize=1)
def instructions() -> dict[int, Instruction]:
    """Return the specification of each opcode."""
    kinds = {}
    for kind, size, bounds, *_ in rows("operands"):
        low, high = bounds.split(" to ")
        kinds[kind] = int(size), int(low), int(high)
    role_of = {
        name.strip("` "): role for role, names, *_ in rows("roles") for name in names.split(",")
    }
    table_rows = {
        int(code.replace(" ", ""), 16): (
            words.split(),
            [len(side.split()) for side in effect.split("--")],
        )
        for code, words, effect, *_ in rows("instructions")
    }
    kind_of = {
        words[0]: _label_and_kind(words[1])[1] for words, _ in table_rows.values() if words[1:]
    }
    table = {}
    for code, ((name, *operands), (takes, leaves)) in table_rows.items():
        op_operands = tuple(
            Operand(*halves, *kinds[halves[1]]) for halves in map(_label_and_kind, operands)
        )
        short_match = re.fullmatch(r"(.+)_(\d+)", name)
        stem = short_match[1] if short_match else name.removesuffix("_FAR")
        implied = ((kind_of.get(stem, "u8"), int(short_match[2])),) if short_match else ()
        role = role_of[name]
        bytes_ = 2 if code > 0xFF else 1
        table[code] = Instruction(name, stem, op_operands, implied, takes, leaves, role, bytes_)
    return table


def code_at(code: bytes, offset: int) -> int:
    """Return the byte that begins an instruction; after `ff` the next one belongs to it."""
    return int.from_bytes(code[offset : offset + 1 + (code[offset] == ESCAPE)], "big")


def instruction_at(code: bytes, offset: int) -> Instruction:
    """Return the specification of the instruction there."""
    return instructions()[code_at(code, offset)]


@lru_cache(maxsize=1024)
def decode(code: bytes, offset: int) -> tuple[Instruction, list[int], int, int]:
    """Return the instruction there, its values, where the next one begins, and where it jumps."""
    row = instruction_at(code, offset)
    return row, row.values(code, offset), offset + row.size, row.target(code, offset)


def _label_and_kind(word: str) -> tuple[str, str]:
    label, _, kind = word.partition(":")
    return label, kind


def versions() -> dict[tuple[int, int], tuple[set[str], tuple[int, ...]]]:
    """Return the additions of each version: names of instructions, and bits of `needs`."""
    table = {}
    for number, names, bits in rows("versions"):
        major, minor = map(int, number.split("."))
        values = () if bits == "none" else tuple(map(int, bits.split(", ")))
        table[major, minor] = set(re.findall(r"[A-Z_0-9]+", names)), values
    return table


@lru_cache(maxsize=1)
def rule_numbers() -> dict[str, int]:
    """Return the number of each rule of the verifier."""
    return {rule: int(number) for number, rule, *_ in rows("rules")}
