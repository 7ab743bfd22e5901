// Halts the running program at its breakpoints, and resumes it: the part of `run` that handles
// them.

#pragma once

#include <stdint.h>

#include "../vm/machine.h"

namespace tiniscript {

// The machine of the current or last run: `run.cpp`.
typedef Machine MachineOfRun;
MachineOfRun& machine_of_run();

// The run of an image begins, or ends.
void begin_halting(const uint8_t* image, uint16_t length);
void end_halting();

// Before a tick of the machine: whether it is not halted. After it: halts it, if it is at a place.
bool begin_tick();
void end_tick(Status status);

// The time of the machine, which stands while it is halted.
uint32_t machine_ms();

// Whether traps are in the code.
bool are_traps_in();

}  // namespace tiniscript
