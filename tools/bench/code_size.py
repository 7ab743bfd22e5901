"""Measures how many bytes of code the programs of the documents and of `examples/` take.

The corpus consists of each program in a fence `tiniscript` of README.md, bytecode_spec.md, docs/
and the lessons that compiles, each text once, and of the files of `examples/`. Each is compiled for
the robot in its fence `senses`, or for the first shipped robot for which it compiles. A statement
is one of the IR: an arm of an IF is part of the IF, END_... is not one, and a DEF, a TASK and a
WHEN are one each.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from typing import NamedTuple

from tests.support.casefile import documents, read
from tiniscript import Compilation, compile_text, robots
from tiniscript.bytecode.disassembly import rows
from tiniscript.semantics.ir import all_statements
from tools import ROOT

CASES = ROOT / "tests" / "cases"
LESSONS = ROOT / "compiler" / "tiniscript" / "lessons"
BYTES_IN_ISA_1_0 = 1066  # bytes of the same programs in the instruction set 1.0
STATEMENTS = 259  # statements of the programs when BYTES_IN_ISA_1_0 was measured


class Measurement(NamedTuple):
    program_count: int
    statement_count: int
    code_bytes: int
    opcodes: Counter[str]

    @property
    def bytes_per_statement(self) -> float:
        return self.code_bytes / self.statement_count


def corpus() -> Iterator[Compilation]:
    """Yield the compiled programs of the documents and examples."""
    robot_of_text: dict[str, str] = {}  # the robot of each text, or an empty text
    for path in (*documents(), *sorted(LESSONS.glob("*/*.md"))):
        if CASES not in path.parents:
            for case in read(path):
                if "tiniscript" in case.parts:
                    robot_of_text.setdefault(case.parts["tiniscript"], _robot_of(case.parts))
    for path in sorted((ROOT / "examples").glob("*.ts")):
        robot_of_text.setdefault(path.read_text(encoding="utf-8"), "")
    for text, robot in robot_of_text.items():
        for name in [robot] if robot else [robots.DEFAULT, *robots.names()]:
            compilation = compile_text(text, robots.load(name).kit)
            if compilation.is_right:
                yield compilation
                break


def _robot_of(parts: dict[str, str]) -> str:
    for row in parts.get("senses", "").splitlines():
        word, _, value = (part.strip() for part in row.partition("="))
        if word == "robot":
            return value
    return ""


def measure() -> Measurement:
    program_count = statement_count = code_bytes = 0
    opcodes: Counter[str] = Counter()
    for compilation in corpus():
        assert compilation.program is not None
        program_count += 1
        statement_count += len(compilation.program.procedures) + len(compilation.program.tasks)
        statement_count += sum(1 for _ in all_statements(compilation.program))
        code_bytes += len(compilation.code)
        opcodes.update(row.op.name for row in rows(compilation.code) if row.op)
    return Measurement(program_count, statement_count, code_bytes, opcodes)


def main() -> None:
    measurement = measure()
    print(f"A statement takes {measurement.bytes_per_statement:.1f} bytes.")


if __name__ == "__main__":
    main()
