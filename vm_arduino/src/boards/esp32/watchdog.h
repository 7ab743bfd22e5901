// The watchdog of the main loop, and the cause of the last reset.
//
// If the main loop hangs, a timer's task turns motors and actuators off after 0.1 s; on an ESP32 it
// runs on the other core. The task watchdog restarts the chip after 1 s, and the core's interrupt
// watchdog after 0.3 s if interrupts are off.

#pragma once

#include <stdint.h>

#include "../../firmware/board.h"

namespace tiniscript {

constexpr uint8_t kStallMs = 100;

void watchdog_begin();
void panic_begin();  // of `panic.cpp`

// Call it at least every 10 ms.
void watchdog_feed();

// Whether the main loop has hung since the last call.
bool watchdog_take_stall();

// Whether a watchdog has restarted the chip, and what ran then. Reported once.
bool watchdog_take_hang(Place* place);

Reset watchdog_reset_cause();

// A seed from the chip's source of random numbers and its address.
uint32_t watchdog_seed();

}  // namespace tiniscript
