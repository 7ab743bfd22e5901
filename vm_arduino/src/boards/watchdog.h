// The watchdog of the main loop, and what is known of the last reset.
//
// While the main loop stands still, a timer turns motors and actuators off after 0.1 s; after
// 0.125 s the watchdog restarts the chip, after 0.25 s also where interrupts are off. A bootloader
// of an old Nano or Mega would not come out of a reset by the watchdog: there the restart is a
// jump.

#ifndef TINISCRIPT_BOARDS_WATCHDOG_H_
#define TINISCRIPT_BOARDS_WATCHDOG_H_

#include "../firmware/board.h"

namespace tiniscript {

void watchdog_begin();

// The main loop goes on: it is to be called in every turn.
void watchdog_feed();

// Whether it stood still, since the last question.
bool watchdog_has_stalled();

// Whether the watchdog has restarted the chip, and what ran then; it is told once.
bool watchdog_has_hung(Place* place);

Reset watchdog_reset_cause();

// A number from memory as it was found and from a count of the resets since power-on: another one
// after each reset.
uint32_t watchdog_seed();

}  // namespace tiniscript

#endif  // TINISCRIPT_BOARDS_WATCHDOG_H_
