"""The machine and the reader of text on the emulated chips of ESP boards: LX6, lx106, rv32imc.

Builds `vm_arduino/extras/qemu` for a chip and talks to one QEMU that runs it: many requests, each a
length and bytes. A chip that faults, or does not answer, ends its emulator; the next request then
begins another one, so that one case that is wrong is one that fails.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from io import BytesIO
from pathlib import Path
from struct import pack
from threading import Timer
from typing import TYPE_CHECKING

from tests.machines import host
from tests.machines.chips import agrees
from tests.machines.host import (
    SOURCES,
    WARNINGS,
    Process,
    Ran,
    build_cached,
    contents,
    parse_run,
    run_request,
)
from tests.machines.text_reader import Answer
from tiniscript.base.kit import Kit
from tiniscript.bytecode.image import STARTS
from tiniscript.codegen.text.problems import PROBLEM_NAMES
from tiniscript.robots.kit_words import kit_words
from tools.builds import chips

if TYPE_CHECKING:
    from tests.machines import Senses

MAX_SECONDS = 60  # timeout of one answer
QUIET = ("-m", "16M", "-nodefaults", "-display", "none", "-serial", "none", "-monitor", "none")


def missing(name: str) -> str:
    """Return the reason why there is no such chip, or ""."""
    return chips.missing_reason(chips.CHIPS[name], can_run=True)


class Emulated(Process):
    """An emulator process. `program` is a result of `build_chip_program`."""

    def __init__(self, name: str, program: Path) -> None:
        words = [*chips.CHIPS[name].emulator, *QUIET]
        load = ("-device", f"loader,file={program},cpu-num=0")
        super().__init__([*words, *load], chips.CHIPS[name].board)

    def run(self, image: bytes, kit: Kit, senses: Senses) -> Ran:
        return parse_run(self.ask(b"R", run_request(image, kit, senses)).decode())

    def agrees(self, run: Ran, expected: Ran, max_ms: int) -> bool:
        return agrees(run, expected, max_ms)

    def read(self, texts: Sequence[bytes], kit: Kit, room: int) -> list[Answer]:
        """Return the reader's answer to each text."""
        data = host.texts(kit_words(kit), *texts)
        bytes_io = BytesIO(self.ask(b"T", pack("<H", room) + data))
        answers = [_answer(bytes_io) for _ in texts]
        assert not bytes_io.read()
        return answers

    def ask(self, letter: bytes, request: bytes) -> bytes:
        watch = Timer(MAX_SECONDS, self.end)
        watch.start()
        try:
            return super().ask(letter, request)
        finally:
            watch.cancel()


def _answer(bytes_io: BytesIO) -> Answer:
    (kind,) = bytes_io.read(1)
    if kind == 2:  # a block is open
        return Answer()
    first, second = bytes_io.read(2)
    if kind == 1:
        return Answer(problem=PROBLEM_NAMES[first], column=second)
    assert kind == 0
    return Answer(start=STARTS[first], code=bytes_io.read(second))


@lru_cache(maxsize=2 * len(chips.CHIPS))
def build_chip_program(name: str, sources: Path = SOURCES) -> Path:
    """Return the program of a chip made from `sources`, a folder like `vm_arduino`."""
    folders = [sources / folder for folder in ("src/vm", "src/text", "extras/chip", "extras/qemu")]
    source_paths = [path for folder in folders for path in sorted(folder.glob("*.cpp"))]
    source_paths.append(sources / "extras/qemu" / chips.CHIPS[name].start_file)
    chip = chips.CHIPS[name]
    made_from = [*contents(sources / "src", *folders), (folders[-1] / "chip.ld").read_bytes()]
    words = (*chips.COMMON_FLAGS, *WARNINGS, *map(str, chip))
    return build_cached(
        chip.compiler[0],
        words,
        made_from,
        lambda path: chips.build(chip, source_paths, path, *WARNINGS),
    )


_running: dict[str, Emulated] = {}


def start_emulator(name: str) -> Emulated:
    """Return the emulator that all tests of a worker share, or a new one where it has ended."""
    if name in _running and _running[name].has_ended():
        _running.pop(name).close()
    if name not in _running:
        _running[name] = Emulated(name, build_chip_program(name))
    return _running[name]
