"""Measures how much flash and RAM the machine takes on the chips of robots: linked, with libgcc.

Builds the same small program with and without the machine, and takes the difference. That of the
store is what it adds to the machine; the memory below it is not counted. Knows the
AVR's compiler and its flags; `chips.py` knows those of other chips. `machine.py` and `targets.py`
print it.
"""

from __future__ import annotations

import shutil
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parent.parent.parent
sys.path[:0] = [str(ROOT)]

from tools.bench import avr_bench
from tools.builds import chips

SOURCE = ROOT / "vm_arduino" / "src"
WASM = ROOT / "compiler" / "tiniscript" / "vm" / "machine.wasm"
MUST = 7168  # bytes of flash on the AVR, machine and verifier

# A robot that does nothing, and a use of each part that no optimiser can leave out.
PROBE = """
#include "robot.h"
#include "store/nvm.h"
#include "store/store.h"
#include "vm/image.h"
#include "vm/verify.h"
#include "vm/vm.h"
using namespace tiniscript;
volatile uint8_t sink;
namespace tiniscript {
void robot_motors(int8_t left, int8_t right) { sink = left; sink = right; }
void robot_off() { sink = 0; }
bool robot_read(uint8_t sensor, int32_t* value) { *value = sensor; return sink; }
void robot_beep(uint16_t hertz, uint32_t) { sink = hertz; }
bool robot_show(int32_t value, bool) { sink = value; return sink; }
void robot_set(uint8_t actuator, int32_t value) { sink = actuator; sink = value; }
uint16_t robot_device_hash(uint16_t device) { sink = device; return sink; }
#define once __attribute__((noinline))
once bool nvm_is_ready() { return sink; }
once uint8_t nvm_read(uint16_t place) { sink = place; return sink; }
once void nvm_write(uint16_t place, uint8_t value) { sink = place; sink = value; }
once void nvm_clear(uint16_t place) { sink = place; }
}
uint8_t bytes[64];  // not of the machine, but here with and without it
int main() {
  int32_t value;
  robot_motors(sink, sink); robot_off(); robot_read(sink, &value); robot_beep(sink, sink);
  robot_show(value, sink); robot_set(sink, value);
  sink = nvm_is_ready(); sink = nvm_read(sink); nvm_write(sink, sink); nvm_clear(sink);
  bytes[sink] = sink; sink = bytes[sink];
  USE
}
"""
IMAGE = """{ Image image;
        sink = (uint8_t)unpack(bytes, sink, &image); sink = image.start; }"""
VERIFY = """{ uint16_t devices;
        Verdict verdict = verify(bytes, sink, sink, sink, &devices);
        sink = (uint8_t)verdict.rule; sink = verdict.offset; sink = devices; }"""
MACHINE = """{ static Machine machine; static int32_t readings[8];
        machine.start(bytes, sink, readings, sink, sink, sink);
        sink = (uint8_t)machine.tick(sink, sink); }"""
STORE = """{ static Store store; const Area area = (Area)sink;
        store.boot(); store.tick(sink); sink = (uint8_t)store.state(); sink = store.is_busy();
        sink = store.begin_save(bytes); sink = store.begin_keep(area, bytes);
        sink = store.used(area); store.refuse();
        sink = store.fetch(area, sink, bytes); }"""
USES = {
    "image": IMAGE,
    "verify": VERIFY,
    "vm and number": MACHINE,
    "machine and verifier": VERIFY + MACHINE,
    "all": IMAGE + VERIFY + MACHINE,
}

# What the table says of a chip: what is measured, and how.
AVR = "ATmega328P (AVR)"
EMULATED = {f"{chip.board}": chip for chip in chips.CHIPS.values()}


STORE_MUST = 1600  # bytes of flash of the store on the AVR


class Size(NamedTuple):
    flash: int
    ram: int


def missing(name: str) -> str:
    """Return why a chip cannot be measured here, or nothing."""
    if name != AVR:
        return chips.missing(EMULATED[name])
    return "" if shutil.which("avr-g++") else f"no avr-g++ ({avr_bench.PACKAGES}): no {AVR}"


def size(name: str, use: str, flags: tuple[str, ...] = avr_bench.FLAGS) -> Size:
    """Return what a use of the machine adds to a small program; `flags` are for the AVR alone."""

    with_it, without = (built(name, each, flags) for each in (USES[use], ""))
    return Size(with_it.flash - without.flash, with_it.ram - without.ram)


def store_size(flags: tuple[str, ...] = avr_bench.FLAGS) -> Size:
    """Return what the store adds to the machine on the AVR."""
    with_it, without = (built(AVR, use, flags) for use in (USES["all"] + STORE, USES["all"]))
    return Size(with_it.flash - without.flash, with_it.ram - without.ram)


@lru_cache
def built(name: str, use: str, flags: tuple[str, ...]) -> Size:
    probe = PROBE.replace("USE", use)
    return Size(*(on_avr(probe, flags) if name == AVR else chips.size(EMULATED[name], probe)))


def on_avr(probe: str, flags: Sequence[str]) -> tuple[int, int]:
    """Return the flash and the RAM of a program, linked with the machine."""
    with tempfile.TemporaryDirectory() as folder:
        program = Path(folder) / "probe"
        link(program, probe, flags)
        said = done("avr-size", str(program))
    text, data, bss = (int(word) for word in said.splitlines()[1].split()[:3])
    return text + data, data + bss


def link(program: Path, probe: str, flags: Sequence[str]) -> None:
    source = program.with_suffix(".cpp")
    source.write_text(probe, encoding="utf-8")
    machine = sorted(path for each in ("vm", "store") for path in (SOURCE / each).glob("*.[cS]*"))
    done("avr-g++", *flags, f"-I{SOURCE}", str(source), *map(str, machine), "-o", str(program))


def done(*command: str) -> str:
    ran = subprocess.run(command, capture_output=True, text=True)
    if ran.returncode != 0:
        raise RuntimeError(f"{command[0]} fails:\n{ran.stderr[:4000]}")
    return ran.stdout
