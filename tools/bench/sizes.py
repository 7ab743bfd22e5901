"""Prints how much flash and RAM each part of the firmware takes, on each chip of a robot.

Links a small program once with and once without a use of the part, and takes the difference: shared
parts are in both, and the robot below does not count. Knows the AVR's compiler and its flags;
`chips.py` knows those of the other chips.
"""

from __future__ import annotations

import shutil
import subprocess
import sys
import tempfile
from functools import lru_cache
from pathlib import Path
from typing import NamedTuple

from tools import ROOT
from tools.bench import avr_bench
from tools.builds import chips

SOURCE = ROOT / "vm_arduino" / "src"
AVR = "ATmega328P (AVR)"
EMULATED_CHIPS = {f"{chip.board}": chip for chip in chips.CHIPS.values()}
# Flags of PlatformIO: those of Arduino and of platformio.ini.
SKETCH_FLAGS = (
    *avr_bench.FLAGS, "-std=gnu++11", "-fno-threadsafe-statics", "-Wl,--relax", "-mstrict-X",
    "-fno-gcse", "-fno-move-loop-invariants",
)  # fmt: skip

# A robot that does nothing, and a use of each part that no optimiser can leave out.
MACHINE = """
#include "robot.h"
#include "store/nvm.h"
#include "store/store.h"
#include "vm/image.h"
#include "vm/verify.h"
#include "vm/machine.h"
using namespace tiniscript;
volatile uint8_t sink;
namespace tiniscript {
void robot_motors(int8_t left, int8_t right) { sink = left; sink = right; }
void robot_off() { sink = 0; }
bool robot_read(uint8_t sensor, int32_t* value) { *value = sensor; return sink; }
void robot_beep(uint16_t hertz, uint32_t) { sink = hertz; }
bool robot_show(int32_t value, bool) { sink = value; return sink; }
void robot_set(uint8_t actuator, int32_t value) { sink = actuator; sink = value; }
int32_t robot_speed(bool, uint8_t) { return sink; }
uint16_t robot_device_hash(uint16_t device) { sink = device; return sink; }
#define once __attribute__((noinline))
once bool nvm_is_ready() { return sink; }
once uint8_t nvm_read(uint16_t place) { sink = place; return sink; }
once void nvm_write(uint16_t place, uint8_t value) { sink = place; sink = value; }
once void nvm_clear(uint16_t place) { sink = place; }
}
uint8_t bytes[64];  // not of the machine, but here with and without it
PORT
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
VERIFY_AND_RUN = """{ uint16_t devices;
        Verdict verdict = verify(bytes, sink, sink, sink, &devices, sink);
        sink = (uint8_t)verdict.rule; sink = verdict.offset(); sink = devices; }
      { static Machine machine; static int32_t readings[8];
        machine.start(bytes, sink, readings, sink, sink, sink);
        sink = (uint8_t)machine.tick(sink, sink); }"""
STORE = """{ static Store store; const Area area = (Area)sink;
        store.boot(); store.tick(sink); sink = (uint8_t)store.state(); sink = store.is_busy();
        sink = store.begin_save(bytes); sink = store.begin_save_record(area, bytes);
        sink = store.current_slot(area); store.refuse();
        sink = store.fetch(area, sink, bytes); }"""
PORT = """
#include "link/link.h"
#include "link/port.h"
namespace tiniscript {
Identity identity; RobotStatus robot_status; DeviceInfo device_info; Receiver receiver;
Identity& port_identity() { return identity; }
const RobotStatus& port_status() { return robot_status; }
Tuning tuning;
const Tuning& port_tuning() { return tuning; }
Answer port_tune(const Tuning& other, bool) { tuning = other; return (Answer)sink; }
const DeviceInfo& port_device_info() { return device_info; }
uint8_t port_readings() { return sink; }
uint8_t port_actuators() { return sink; }
LineErrors port_line_errors() { return {0, 0}; }
uint16_t port_room() { return sink; }
Answer port_undo() { return (Answer)sink; }
Answer port_prepare_upload(bool) { return (Answer)sink; }
bool port_may_write_ahead() { return sink; }
uint8_t* port_memory(uint16_t length, bool) { return length > 400 ? nullptr : (uint8_t*)0x200; }
void port_forget() { sink = 0; }
void port_take(uint8_t mode, bool) { sink = mode; }
void port_take_checksum(const uint8_t* image) { sink = *image; }
void port_start(bool is_live) { sink = is_live; }
void port_stop(uint8_t fault) { sink = fault; }
void port_release() { sink = 0; }
uint16_t port_image_length() { return sink; }
uint16_t port_run_at() { return sink; }
uint16_t port_shown_at() { return sink; }
const uint8_t* port_run_image() { return bytes; }
Answer port_image_byte(uint16_t offset, uint8_t* byte) { *byte = offset; return (Answer)sink; }
uint8_t* port_text_memory(uint16_t*, bool* has_room) { *has_room = sink; return bytes; }
uint8_t* port_text_room(uint16_t* room) { *room = sink; return (uint8_t*)0x300; }
bool port_text_is_separate(bool) { return false; }
bool port_may_prepare_upload(bool) { return sink; }
void port_take_text(uint8_t* image, bool) { sink = *image; }
void port_end() { sink = 0; }
const uint8_t words[] tini_progmem = {0, 0};
const uint8_t* robot_words() { return words; }
uint16_t robot_language() { return 0; }
Answer port_rename(const uint8_t* name, uint8_t at) { sink = name[at]; return (Answer)sink; }
Answer port_key(uint8_t which, uint8_t* key) { key[which] = sink; return (Answer)sink; }
Answer port_keep_key(uint8_t at, const uint8_t* key) { sink = key[at]; return (Answer)sink; }
void port_identify() { sink = 1; }
}
"""
PORT_USED = """port_identity(); port_status(); port_device_info(); sink = port_room();
  sink = port_line_errors().framing;
  port_tune(port_tuning(), sink);
  port_may_write_ahead(); port_prepare_upload(sink); port_memory(sink, 0); port_forget();
  port_take(sink, 0);
  port_undo();
  port_take_checksum(bytes); port_start(sink); port_stop(sink);
  port_release(); sink = port_image_length(); port_image_byte(sink, bytes); port_rename(bytes, 1);
  port_key(1, bytes); port_keep_key(1, bytes); port_identify();
"""
LINK = """{ static Link link;
        link.begin(&receiver, sink); sink = receiver.put(sink, sink);
        link.pass_time(sink); link.tick(); sink = link.has_tx_byte();
        link.send_due(); link.write_checksum();
        uint8_t byte; while (link.next_tx_byte(&byte)) sink = byte;
        link.on_done(); link.on_faulted(); link.on_stopped(Cause::kButton);
        link.expire(); sink = link.confirm_claim(); sink = link.show(sink, sink); }"""
READER = """
#include "text/kit_words.h"
#include "text/reader.h"
#include "text/texts.h"
#include "vm/crc32.h"
using namespace tiniscript;
volatile uint8_t sink;
const uint8_t words[] tini_progmem = {0, 0};
const uint8_t* tiniscript::robot_words() { return words; }
uint16_t tiniscript::robot_language() { return 0; }
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
READ = """Reader* const its = near(&reader);
  its->begin(buffer, sizeof buffer);
  for (;;) {
    sink = (uint8_t)its->put(sink);
    sink = its->start(); sink = its->length(); sink = its->column();
    sink = ANSWER;
  }"""
ALL_CODE = IMAGE + VERIFY_AND_RUN


class Size(NamedTuple):
    flash: int
    ram: int


class Part(NamedTuple):
    """A measured part: a program, the code it always uses, and the code that uses the part."""

    program: str
    always_code: str
    statement: str
    folders: tuple[str, ...]  # folders of linked sources besides the machine
    flags: tuple[str, ...]  # compiler flags for the AVR


MACHINE_ALONE = MACHINE.replace("PORT", "")
PARTS = {
    "machine and verifier": Part(
        MACHINE_ALONE, "", VERIFY_AND_RUN, ("store",), avr_bench.FLAGS
    ),
    "store": Part(MACHINE_ALONE, ALL_CODE, STORE, ("store",), avr_bench.FLAGS),
    "link, with text": Part(
        MACHINE.replace("PORT", PORT), PORT_USED + ALL_CODE, LINK, ("link", "text"),
        avr_bench.FLAGS,
    ),
    "reader of text alone": Part(
        READER, "", READ.replace("ANSWER", "(uint8_t)its->problem()"), ("text",), SKETCH_FLAGS
    ),
    "reader of text, with answers": Part(
        READER, "", READ.replace("ANSWER", "flash_byte(packed_texts() + text_of(its->problem()))"),
        ("text",), SKETCH_FLAGS,
    ),
}  # fmt: skip
SHOWN_PARTS = ("machine and verifier", "link, with text", "reader of text alone")
# Bytes of flash and of RAM on the AVR, at most.
LIMITS = {
    "machine and verifier": Size(7168, 400),
    "store": Size(1600, 24),
    "link, with text": Size(16_000, 456),
    "reader of text, with answers": Size(6500, 60),
}


def missing_reason(chip: str) -> str:
    """Return the reason why a chip cannot be measured here, or ""."""
    if chip != AVR:
        return chips.missing_reason(EMULATED_CHIPS[chip])
    return "" if shutil.which("avr-g++") else f"no avr-g++ ({avr_bench.INSTALL_COMMAND}): no {AVR}"


def size(name: str, chip: str = AVR) -> Size:
    """Return the size that a part adds to its small program. Raises RuntimeError with the
    compiler's output.

    On the AVR the stack comes on top.
    """
    part = PARTS[name]
    size_with, size_without = (
        _build(part, part.always_code + use, chip) for use in (part.statement, "")
    )
    return Size(size_with.flash - size_without.flash, size_with.ram - size_without.ram)


@lru_cache
def _build(part: Part, statement: str, chip: str) -> Size:
    program = part.program.replace("USE", statement)
    if chip != AVR:
        return Size(*chips.measure_size(EMULATED_CHIPS[chip], program, *part.folders))
    folders = sorted(("vm", *part.folders))
    source_paths = [
        path for folder in folders for path in sorted((SOURCE / folder).glob("*.[cS]*"))
    ]
    with tempfile.TemporaryDirectory() as folder:
        source, binary = Path(folder) / "probe.cpp", Path(folder) / "probe"
        source.write_text(program, encoding="utf-8")
        _run_checked(
            "avr-g++",
            *part.flags,
            f"-I{SOURCE}",
            str(source),
            *map(str, source_paths),
            "-o",
            str(binary),
        )
        output = _run_checked("avr-size", str(binary))
    text, data, bss = (int(word) for word in output.splitlines()[1].split()[:3])
    return Size(text + data, data + bss)


def _run_checked(*command: str) -> str:
    result = subprocess.run(command, capture_output=True, text=True)
    if result.returncode != 0:
        raise RuntimeError(f"{command[0]} fails:\n{result.stderr[:4000]}")
    return result.stdout


def main() -> int:
    print("| chip |", " | ".join(f"{part}: flash | RAM" for part in SHOWN_PARTS), "|")
    print("| --- |", " | ".join("---: | ---:" for _ in SHOWN_PARTS), "|")
    for chip in (AVR, *EMULATED_CHIPS):
        if missing_reason(chip):
            print(missing_reason(chip), file=sys.stderr)
            continue
        sizes = [size(part, chip) for part in SHOWN_PARTS]
        print(
            f"| {chip} |",
            " | ".join(f"{part_size.flash:,} | {part_size.ram}" for part_size in sizes),
            "|",
        )
    return 0


if __name__ == "__main__":
    sys.exit(main())
