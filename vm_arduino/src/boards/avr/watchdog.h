// The watchdog of the main loop, and the cause of the last reset.
//
// If the main loop hangs, a timer turns motors and actuators off after 0.1 s. The watchdog restarts
// the chip after 0.125 s, or after 0.25 s if interrupts are off. The bootloader of an old Nano or
// Mega would not come out of a watchdog reset, so the restart there is a jump.

#pragma once

#include <avr/wdt.h>

#include "../../firmware/board.h"
#include "clock.h"

namespace tiniscript {

constexpr uint8_t kStallMs = 100;

void watchdog_begin();

// Call it in every turn of the main loop.
tini_always_inline void watchdog_feed() {
  wdt_reset();
  clock.silence_ms = 0;
}

// Whether the main loop has hung since the last call.
bool watchdog_take_stall();

// Whether the watchdog has restarted the chip, and what ran then. Reported once.
bool watchdog_take_hang(Place* place);

Reset watchdog_reset_cause();

// A seed from uninitialised memory and a count of resets since power-on: different after each
// reset.
uint32_t watchdog_seed();

}  // namespace tiniscript
