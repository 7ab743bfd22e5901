// The clock: milliseconds and microseconds from timer 0, which also makes PWM.
//
// Replaces `init`, `millis` and `micros` of the Arduino core, as far as a robot needs them, in less
// flash and with a shorter interrupt. So this folder has its own `main`, which calls `setup` and
// `loop` as that of the core does.

#pragma once

#include <stdint.h>

#include "pins.h"

namespace tiniscript {

// The state of the clock. The interrupt of timer 0 advances it every 1.024 ms, sometimes by 2 ms.
struct Clock {
  union {
    uint32_t now_ms;
    uint16_t low_16_ms;  // reading all of it takes longer
    uint8_t low_8_ms;
  };
  uint8_t turns;       // overflows of the timer
  uint8_t fraction;    // in 125ths of a millisecond
  uint8_t silence_ms;  // approximate time since the main loop last fed the watchdog
};

extern volatile Clock clock;

uint32_t clock_ms();

// The lowest 8 bits, read with one instruction; the lowest 16, for callers with interrupts off.
tini_always_inline uint8_t clock_8_ms() { return clock.low_8_ms; }
tini_always_inline uint16_t clock_16_ms() { return clock.low_16_ms; }

// Microseconds in steps of 4; they wrap around after 65 ms. The second one is for callers with
// interrupts off.
uint16_t clock_us();

tini_always_inline uint16_t clock_us_inside() {
  uint8_t turns = clock.turns;
  const uint8_t count = TCNT0;
  if ((TIFR0 & 1 << TOV0) != 0 && count != 0xff) turns++;  // an overflow whose interrupt is pending
  return static_cast<uint16_t>((turns << 8 | count) << 2);
}

}  // namespace tiniscript
