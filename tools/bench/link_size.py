"""Measures how much flash and RAM link and reader of text take on an ATmega328P, linked.

Builds the small program of `machine_size.py` with all of the machine, once with and once without
the link, and takes the difference: so the verifier and the checksum, which both use, are not
counted.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
sys.path[:0] = [str(ROOT)]

from tools.bench import avr_bench, machine_size
from tools.bench.machine_size import SOURCE, USES, Size, done

MUST = 16_000  # bytes of flash, of the link with the reader of text

# A robot that holds nothing, and a use of each part that no optimiser can leave out.
PORT = """
namespace tiniscript {
Identity identity; RobotStatus robot_status; DeviceInfo device_info; Receiver receiver;
Identity& port_identity() { return identity; }
const RobotStatus& port_status() { return robot_status; }
Trim trim;
const Trim& port_trim() { return trim; }
Answer port_set_trim(const Trim& other) { trim = other; return (Answer)sink; }
const DeviceInfo& port_device_info() { return device_info; }
LineErrors port_line_errors() { return {0, 0}; }
uint16_t port_room() { return sink; }
Answer port_undo() { return (Answer)sink; }
Answer port_make_way(bool) { return (Answer)sink; }
bool port_may_prepare() { return sink; }
uint8_t* port_memory(uint16_t length, bool) { return length > 400 ? nullptr : (uint8_t*)0x200; }
void port_forget() { sink = 0; }
void port_take(uint8_t mode, bool) { sink = mode; }
void port_seal(const uint8_t* image) { sink = *image; }
void port_start(bool is_live) { sink = is_live; }
void port_stop(uint8_t fault) { sink = fault; }
void port_release() { sink = 0; }
uint16_t port_image_length() { return sink; }
uint16_t port_run_at() { return sink; }
const uint8_t* port_run_image() { return bytes; }
Answer port_image_byte(uint16_t offset, uint8_t* byte) { *byte = offset; return (Answer)sink; }
uint8_t* port_text_memory(uint16_t*, bool* has_room) { *has_room = sink; return bytes; }
uint8_t* port_text_room(uint16_t* room) { *room = sink; return (uint8_t*)0x300; }
bool port_text_is_beside(bool) { return false; }
bool port_may_make_way(bool) { return sink; }
void port_take_text(uint8_t* image, bool) { sink = *image; }
void port_end() { sink = 0; }
const uint8_t words[] tini_progmem = {0};
const uint8_t* robot_words() { return words; }
bool robot_speaks_spanish() { return false; }
Answer port_rename(const uint8_t* name, uint8_t at) { sink = name[at]; return (Answer)sink; }
Answer port_key(uint8_t which, uint8_t* key) { key[which] = sink; return (Answer)sink; }
Answer port_keep_key(uint8_t at, const uint8_t* key) { sink = key[at]; return (Answer)sink; }
void port_identify() { sink = 1; }
}
"""
PORT_USED = """port_identity(); port_status(); port_device_info(); sink = port_room();
  sink = port_line_errors().framing;
  port_set_trim(port_trim());
  port_may_prepare(); port_make_way(sink); port_memory(sink, 0); port_forget(); port_take(sink, 0);
  port_undo();
  port_seal(bytes); port_start(sink); port_stop(sink);
  port_release(); sink = port_image_length(); port_image_byte(sink, bytes); port_rename(bytes, 1);
  port_key(1, bytes); port_keep_key(1, bytes); port_identify();
"""
LINK = """{ static Link link;
        link.begin(&receiver, sink); sink = receiver.put(sink, sink);
        link.pass_time(sink); link.tick(); sink = link.has_tx_byte();
        link.tell(); link.seal();
        uint8_t byte; while (link.next_tx_byte(&byte)) sink = byte;
        link.done(); link.faulted(); link.stopped(Cause::kButton);
        link.lapse(); sink = link.confirm_claim(); sink = link.show(sink, sink); }"""


def probe(use: str) -> str:
    """Return the program of `machine_size.py` with a port, all of the machine, and `use`."""
    parts = (
        (
            '#include "vm/vm.h"',
            '#include "vm/vm.h"\n#include "link/link.h"\n#include "link/port.h"',
        ),
        ("uint8_t bytes[64];", "uint8_t bytes[64];" + PORT),
        ("  USE\n", PORT_USED + USES["all"] + use),
    )
    text = machine_size.PROBE
    for old, new in parts:
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    return text


def size(flags: tuple[str, ...] = avr_bench.FLAGS) -> Size:
    """Return what the link adds to a program with the machine."""
    with_it, without = (built(use, flags) for use in (LINK, ""))
    return Size(with_it.flash - without.flash, with_it.ram - without.ram)


def built(use: str, flags: tuple[str, ...]) -> Size:
    code = [
        *sorted((SOURCE / "vm").glob("*.[cS]*")),
        *sorted((SOURCE / "link").glob("*.cpp")),
        *sorted((SOURCE / "text").glob("*.[cS]*")),
    ]
    with tempfile.TemporaryDirectory() as folder:
        source, program = Path(folder) / "probe.cpp", Path(folder) / "probe"
        source.write_text(probe(use), encoding="utf-8")
        names = map(str, (source, *code))
        done("avr-g++", *flags, f"-I{SOURCE}", *names, "-o", str(program))
        said = done("avr-size", str(program))
    text, data, bss = (int(word) for word in said.splitlines()[1].split()[:3])
    return Size(text + data, data + bss)
