// What looks after the main loop, and what is known of the last reset.
//
// While the main loop stands still, a timer turns the motors off after 0.1 s; the watchdog restarts
// the chip, on an Uno also where interrupts are off. A bootloader of an old Nano or Mega would not
// come out of a reset by the watchdog: there the restart is a jump.

#ifndef TINISCRIPT_BOARDS_GUARD_H_
#define TINISCRIPT_BOARDS_GUARD_H_

#include "../link/port.h"

namespace tiniscript {

void guard_begin();

// The main loop goes on.
void guard_calm();

// Whether it stood still, since the last question.
bool guard_has_stalled();

Reset guard_reset();

// A number from memory as it was found, seldom the same twice.
uint32_t guard_noise();

}  // namespace tiniscript

#endif  // TINISCRIPT_BOARDS_GUARD_H_
