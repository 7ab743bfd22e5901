// The interrupt for each change of an echo pin.

#pragma once

#include "pins.h"

namespace tiniscript {

struct Echo {
  Pin pin;
};

// The core's driver takes a lock to set an interrupt up, so that is done once, here.
inline void begin_echo(Echo echo, void (*handler)()) {
  begin_input(echo.pin);
  attachInterrupt(echo.pin.number, handler, CHANGE);
  gpio_intr_disable(gpio_of(echo.pin));
}

// A divider is between the pin and the echo, so the pin cannot pull the echo low.
inline void revive(Echo) {}

inline bool release(Echo) { return false; }

// Turns the interrupt on or off. For callers in a critical section.
inline void listen_inside(Echo echo, bool is_on) {
  if (is_on) {
    gpio_intr_enable(gpio_of(echo.pin));
  } else {
    gpio_intr_disable(gpio_of(echo.pin));
  }
}

}  // namespace tiniscript
