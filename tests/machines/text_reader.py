"""The reader of text in C++ on this computer, with the sanitizers of the compiler.

Builds `vm_arduino/extras/text` with g++ and talks to one process of it: texts in, answers out.
"""

from __future__ import annotations

import subprocess
from pathlib import Path
from typing import NamedTuple

from tests.machines.host import FLAGS, SOURCES, Process, compile_program, files_in, texts
from tiniscript.base.kit import Kit
from tiniscript.bytecode.image import STARTS
from tiniscript.codegen.text.problems import PROBLEM_NAMES
from tiniscript.robots.kit_words import kit_words

LARGEST_ROOM = 60_000
NO_DEFS = ("-Dtiniscript_no_defs",)  # flags of a reader like an Uno's


class Answer(NamedTuple):
    """The reader's answer: `code` of a program, or a problem; neither if a block is open."""

    start: str = ""
    code: bytes = b""
    problem: str = ""
    column: int = 0

    @property
    def is_program(self) -> bool:
        return bool(self.start)


class TextReader(Process):
    """A process that reads texts: each is one program, however many lines it has."""

    def __init__(self, kit: Kit, room: int = LARGEST_ROOM, flags: tuple[str, ...] = ()) -> None:
        words = kit_words(kit).hex()
        super().__init__([build_reader(flags), str(room), words, "whole"], "the reader of text")

    def read(self, text: bytes) -> Answer:
        pipe_in, pipe_out = self.pipes
        pipe_in.write(texts(text))
        pipe_in.flush()
        line = pipe_out.readline().decode()
        assert line, f"{text!r} ends the reader:\n{self.report()}"
        return answer(line)


def read_lines(kit: Kit, data: bytes, room: int = LARGEST_ROOM) -> list[Answer]:
    """Return a robot's answers to these bytes, line by line."""
    completed = subprocess.run(
        [build_reader(), str(room), kit_words(kit).hex()],
        input=data,
        capture_output=True,
        check=True,
    )
    return [answer(line) for line in completed.stdout.decode().splitlines()]


def answer(line: str) -> Answer:
    word, *rest = line.split()
    if word == "OK":
        return Answer(start=STARTS[int(rest[0])], code=bytes.fromhex("".join(rest[1:])))
    if word == "NO":
        return Answer(problem=PROBLEM_NAMES[int(rest[0])], column=int(rest[1]))
    assert word == "MORE"
    return Answer()


def build_reader(flags: tuple[str, ...] = ()) -> Path:
    """Return the program made from the reader and `extras/text`."""
    inputs = files_in(SOURCES, "src/text", "extras/text")
    vm = SOURCES / "src" / "vm"
    inputs += [*sorted(vm.glob("*.h")), vm / "crc32.cpp", vm / "find_word.cpp"]
    return compile_program(inputs, (*FLAGS, *flags))
