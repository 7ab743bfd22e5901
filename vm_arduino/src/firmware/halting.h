// Halts the program that runs at its breakpoints, and lets it go on: what `run` does about them.

#pragma once

#include <stdint.h>

#include "../vm/machine.h"

namespace tiniscript {

// The run of an image begins, in this machine, or ends.
void begin_halting(Machine* of_run, const uint8_t* image, uint16_t length);
void end_halting();

// Before a tick of the machine: what its time is then, or false: it is halted. After it: halts it, if it
// is at a place.
bool begin_tick(uint32_t* machine_ms);
void end_tick(Status status);

// Whether traps are in the code.
bool are_traps_in();

}  // namespace tiniscript
