// The interrupt for each change of an echo pin.

#pragma once

#include <avr/io.h>

#include "interrupts.h"
#include "pins.h"

namespace tiniscript {

constexpr uint16_t kGroups = 0x68;    // PCICR
constexpr uint16_t kChanges = 0x6b;   // PCMSK0 to PCMSK2
constexpr uint16_t kExternal = 0x3d;  // EIMSK
constexpr uint8_t kExternalGroup = 3;

// Groups 0 to 2 are pin-change interrupts, group 3 the external ones; `interrupt` is the bit in the
// group's mask.
struct Echo {
  Pin pin;
  uint8_t group;
  uint8_t interrupt;
};

// The robot's header names the vectors, and the handler is theirs.
tini_always_inline void begin_echo(Echo, void (*)()) {}

// Pulls an echo that has been high for too long low, until `release`: many a clone that hangs lets
// go then. Returns whether it was pulled.
tini_always_inline void revive(Echo echo) {
  set_bits(static_cast<uint16_t>(echo.pin.port - 1), echo.pin.mask);  // without pull-up: low
}

tini_always_inline bool release(Echo echo) {
  const uint16_t direction = static_cast<uint16_t>(echo.pin.port - 1);
  if ((register8(direction) & echo.pin.mask) == 0) return false;
  clear_bits(direction, echo.pin.mask);
  return true;
}

// Turns the interrupt on or off. For callers with interrupts off.
tini_always_inline void listen_inside(Echo echo, bool is_on) {
  const uint16_t masks =
      echo.group == kExternalGroup ? kExternal : static_cast<uint16_t>(kChanges + echo.group);
  if (is_on) {
    if (echo.group == kExternalGroup) {
      EICRA = 0x55;  // any edge of INT0 to INT3, as far as there are so many
#ifdef EICRB
      EICRB = 0x55;  // of INT4 to INT7
#endif
      EIFR = echo.interrupt;
    } else {
      PCIFR = static_cast<uint8_t>(1 << echo.group);
      register8(kGroups) |= static_cast<uint8_t>(1 << echo.group);
    }
    register8(masks) |= echo.interrupt;
  } else {
    register8(masks) &= static_cast<uint8_t>(~echo.interrupt);
  }
}

}  // namespace tiniscript
