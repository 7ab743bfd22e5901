"""Measures how much flash and RAM the reader of text takes on the chips of robots, linked.

Builds a small program once with and once without the reader, and takes the difference. What the
sketch has anyway (the checksum, a division, a multiplication) is in both.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
sys.path[:0] = [str(ROOT)]

from tools.bench.machine_size import AVR, EMULATED, SOURCE, Size, done
from tools.builds import chips

MUST = 6500  # bytes of flash, with the words of the language and the answers
RAM_MUST = 60

# As PlatformIO builds the sketch: Arduino's flags, and those of platformio.ini.
FLAGS = (
    "-mmcu=atmega328p", "-std=gnu++11", "-Os", "-flto", "-fno-exceptions",
    "-fno-threadsafe-statics", "-ffunction-sections", "-fdata-sections", "-Wl,--gc-sections",
    "-mrelax", "-mcall-prologues", "-Wl,--relax", "-mstrict-X", "-fno-gcse",
    "-fno-move-loop-invariants",
)  # fmt: skip

PROBE = """
#include "text/kit_words.h"
#include "text/reader.h"
#include "text/texts.h"
#include "vm/crc32.h"
using namespace tiniscript;
volatile uint8_t sink;
const uint8_t words[] tini_progmem = {0};
const uint8_t* tiniscript::robot_words() { return words; }
bool tiniscript::robot_speaks_spanish() { return false; }
uint8_t buffer[389];
Reader reader;
int main() {
  uint8_t byte = sink;
  sink = (uint8_t)crc32(sink, &byte, sink);
  uint32_t value = sink;
  sink = (uint8_t)(value / 1000 + value * sink);
  buffer[sink] = sink; sink = buffer[sink];
  USE
}
"""
READER = """Reader* const its = near(&reader);
  its->begin(buffer, sizeof buffer);
  for (;;) {
    sink = (uint8_t)its->put(sink);
    sink = its->start(); sink = its->length(); sink = its->column();
    ANSWER
  }"""
ANSWERS = {
    "reader": "sink = (uint8_t)its->problem();",
    "reader and answers": "sink = flash_byte(packed_texts() + text_of(its->problem()));",
}


def size(board: str, use: str) -> Size:
    """Return what a use of the reader adds to the small program."""
    with_it, without = (_size(board, each) for each in (READER.replace("ANSWER", ANSWERS[use]), ""))
    return Size(with_it.flash - without.flash, with_it.ram - without.ram)


def _size(board: str, use: str) -> Size:
    if board == AVR:
        return linked(use)
    return Size(*chips.size(EMULATED[board], PROBE.replace("USE", use), "text"))


def linked(use: str) -> Size:
    """Return what the small program takes on an ATmega328P."""
    code = [
        *sorted((SOURCE / "text").glob("*.[cS]*")),
        *sorted((SOURCE / "vm").glob("crc32*.[cS]*")),
    ]
    with tempfile.TemporaryDirectory() as folder:
        source, program = Path(folder) / "probe.cpp", Path(folder) / "probe"
        source.write_text(PROBE.replace("USE", use), encoding="utf-8")
        done("avr-g++", *FLAGS, f"-I{SOURCE}", *map(str, (source, *code)), "-o", str(program))
        said = done("avr-size", str(program))
    text, data, bss = (int(word) for word in said.splitlines()[1].split()[:3])
    return Size(text + data, data + bss)
