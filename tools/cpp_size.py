"""Prints how much flash and RAM the machine takes on an ATmega328P, linked, with libgcc.

Builds the same small program with and without the machine, and prints the difference. Knows
avr-g++ and its flags. `--parts` prints the functions too, largest last.
"""

from __future__ import annotations

import argparse
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SOURCE = ROOT / "vm_arduino" / "src"
MUST, AIM = 5120, 4096  # bytes of flash, machine and verifier

USUAL = (
    "-mmcu=atmega328p", "-Os", "-std=c++11", "-fno-exceptions", "-fno-rtti",
    "-ffunction-sections", "-fdata-sections", "-Wl,--gc-sections",
)  # fmt: skip
WAYS = {
    "-Os": (),
    "-Os -flto": ("-flto",),
    "-Os -flto -mrelax -mcall-prologues": ("-flto", "-mrelax", "-mcall-prologues"),
}

# A robot that does nothing, and a use of each part that no optimiser can leave out.
PROBE = """
#include "robot.h"
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
}
int main() {
  int32_t value;
  robot_motors(sink, sink); robot_off(); robot_read(sink, &value); robot_beep(sink, sink);
  robot_show(value, sink); robot_set(sink, value);
  USE
}
"""
USES = {
    "nothing": "",
    "image": """static uint8_t data[64]; Image image;
        sink = (uint8_t)unpack(data, sink, sink, &image); sink = image.start;""",
    "verify": """static uint8_t code[64];
        Verdict verdict = verify(code, sink, sink, sink);
        sink = (uint8_t)verdict.rule; sink = verdict.offset;""",
    "vm and number": """static uint8_t code[64]; static Machine machine;
        machine.start(code, sink, sink, sink, sink);
        sink = (uint8_t)machine.tick(sink, sink);""",
}
USES["all"] = " ".join(f"{{ {use} }}" for use in USES.values())


def main() -> int:
    parser = argparse.ArgumentParser(description="Print how large the machine is on an AVR.")
    parser.add_argument("--parts", action="store_true", help="print its functions too")
    options = parser.parse_args()
    if not shutil.which("avr-g++"):
        print("no avr-g++: apt-get install gcc-avr avr-libc binutils-avr", file=sys.stderr)
        return 2
    with tempfile.TemporaryDirectory() as folder:
        program = Path(folder) / "probe"
        print(f"| flags | {' | '.join(list(USES)[1:])} | RAM |\n|{' --- |' * (len(USES) + 1)}")
        for name, flags in WAYS.items():
            sizes = {use: built(program, use, flags) for use in USES}
            row = [str(flash - sizes["nothing"][0]) for flash, _ in list(sizes.values())[1:]]
            print(f"| `{name}` | {' | '.join(row)} | {sizes['all'][1] - sizes['nothing'][1]} |")
        print(f"\nBytes of flash of machine and verifier: must {MUST}, aim {AIM}.")
        if options.parts:
            built(program, "all", ())
            subprocess.run(["avr-nm", "-CS", "--size-sort", str(program)], check=True)
    return 0


def built(program: Path, use: str, flags: tuple[str, ...]) -> tuple[int, int]:
    """Build the probe with one use of the machine; return its flash and its RAM."""
    probe = program.with_suffix(".cpp")
    probe.write_text(PROBE.replace("USE", USES[use]), encoding="utf-8")
    sources = [str(probe), *sorted(str(path) for path in (SOURCE / "vm").glob("*.cpp"))]
    command = ["avr-g++", *USUAL, *flags, f"-I{SOURCE}", *sources, "-o", str(program)]
    subprocess.run(command, check=True)
    said = subprocess.run(["avr-size", str(program)], check=True, capture_output=True, text=True)
    text, data, bss = (int(word) for word in said.stdout.splitlines()[1].split()[:3])
    return text + data, data + bss


if __name__ == "__main__":
    sys.exit(main())
