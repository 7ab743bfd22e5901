"""The machine in C++ on a simulated ATmega328P or ATmega2560.

Builds `vm_arduino/extras/avr` with avr-g++ once, writes each request into the built program where
its flash waits for it, and lets `simavr` run that. What comes out of the UART is the answer.
"""

from __future__ import annotations

import re
import shutil
import subprocess
import tempfile
from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path
from struct import pack
from typing import TYPE_CHECKING

from tests.machines.host import SOURCES, WARNINGS, Ran, contents, kept, ran, run_request
from tiniscript.base.kit import Kit

if TYPE_CHECKING:
    from tests.machines import Senses

UNO, NANO, MEGA = "uno", "nano", "mega"
BUILT = {
    UNO: ("atmega328p", "-Dtiniscript_with_tasks"),
    NANO: ("atmega328p",),
    MEGA: ("atmega2560",),
}
FLAGS = ("-std=c++11", "-Os", "-flto", "-fno-exceptions", "-fno-rtti")
MARK = b"TiniScript: here is the request"
REQUEST_BYTES = 8192


def missing() -> str:
    """Return why there is no simulated chip, or nothing."""
    wanted = [name for name in ("avr-g++", "simavr") if not shutil.which(name)]
    return f"no {' and no '.join(wanted)} on this computer: no simulated ATmega" if wanted else ""


@lru_cache(maxsize=3)
def program(chip: str) -> bytes:
    """Return the program of a chip, an ELF file."""
    folders = [SOURCES / name for name in ("src/vm", "extras/chip", "extras/avr")]
    made_from = contents(SOURCES / "src", *folders)
    code = sorted(str(path) for each in folders for path in each.glob("*.[cS]*"))
    mcu, *more = BUILT[chip]
    flags = (f"-mmcu={mcu}", *more, *FLAGS, *WARNINGS)
    return compiled("the C++ machine", flags, code, made_from).read_bytes()


def compiled(what: str, flags: Sequence[str], code: Sequence[str], made_from: list[bytes]) -> Path:
    """Return the program of sources; what has not changed is used again."""

    def make(made: Path) -> None:
        words = ["avr-g++", *flags, *code, "-o", str(made)]
        done = subprocess.run(words, capture_output=True, text=True)
        assert done.returncode == 0, f"avr-g++ refuses {what}:\n{done.stderr[:4000]}"

    return kept("avr-g++", flags, made_from, make)


def ran_on(
    chip: str,
    image: bytes,
    kit: Kit,
    senses: Senses,
    not_ready: int = 0,
    late_ms: int = 0,
    begin_ms: int = 0,
) -> Ran:
    """Run an image, which is read and verified by the simulated chip.

    A tick after a wait comes `late_ms` late.
    """
    request = pack("<cI", b"L", late_ms) + run_request(image, kit, senses, not_ready, begin_ms)
    return ran(answer(chip, request))


def answer(chip: str, request: bytes, most_seconds: int = 120) -> str:
    """Return what the program says about a request. Raises TimeoutExpired."""
    elf = program(chip)
    at = elf.index(MARK)
    assert len(request) <= REQUEST_BYTES
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "machine.elf"
        path.write_bytes(elf[:at] + request + elf[at + len(request) :])
        done = subprocess.run(
            ["simavr", "-m", BUILT[chip][0], "-f", "16000000", str(path)],
            capture_output=True,
            timeout=most_seconds,
        )
    said = re.findall(rb"\x1b\[32m(.*?)\.\s*\x1b", done.stdout + done.stderr)
    assert said, (done.stdout + done.stderr)[-2000:]
    return "".join(f"{line.decode()}\n" for line in said)
