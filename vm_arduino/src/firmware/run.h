// The run of a program: what begins it, what ends it, and what a fault leaves.
//
// Knows the machine, the button's and the tether's part in a run. Answers the firmware's events
// (`firmware_on_pressed` ...), and of the machine's questions those that are for no board alone.

#ifndef TINISCRIPT_FIRMWARE_RUN_H_
#define TINISCRIPT_FIRMWARE_RUN_H_

#include <stdint.h>

#include "../link/messages.h"

namespace tiniscript {

// Starts the image `live`, or else `program`, which must be in memory.
void begin_run(bool is_live);

// Starts what the button has asked for, and goes on with what runs.
void tick_run();

// Motors off before anything else. Where a program has not come to its own end, actuators follow.
// The robot is in `state` then; what the button has asked for is forgotten.
void end_run(State state, bool is_done = false);

// Ends what runs, and nothing starts until the link says so. A fault that is not 0 is recorded.
void stop_run(uint8_t fault);

// What the button has asked for is forgotten, if it has not begun.
void forget_start();

// Whether a motor is on.
bool is_driving();

}  // namespace tiniscript

#endif  // TINISCRIPT_FIRMWARE_RUN_H_
