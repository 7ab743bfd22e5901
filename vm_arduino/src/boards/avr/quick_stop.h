// The motors off, in assembly for the interrupt that sees a stop: it has saved few registers.
//
// The same pins as `motors_off` of the driver.

#pragma once

#include "../../vm/flags.h"
#include "../kit.h"
#include "pins.h"

// Servos that turn have no pins to turn off: they get another pulse.
#if defined(tiniscript_motors_bridge) || defined(tiniscript_motors_two_wire) || \
    defined(tiniscript_motors_shift_register)
#define tiniscript_has_quick_stop
#endif

#ifdef tiniscript_has_quick_stop

namespace tiniscript {

constexpr uint16_t kBitsUntil = 0x40;   // registers with instructions for single bits
constexpr uint16_t kQuickUntil = 0x60;  // registers that `in` and `out` reach
constexpr uint16_t kFirst = 0x20;       // they count from there

// Changes r30. For constant arguments.
tini_always_inline void clear_quickly(uint16_t address, uint8_t mask) {
  if (address < kBitsUntil) {
    asm volatile("cbi %0, %1" ::"I"(address - kFirst), "I"(__builtin_ctz(mask)));
  } else if (address < kQuickUntil) {
    asm volatile("in r30, %0\n\tandi r30, %1\n\tout %0, r30" ::"I"(address - kFirst),
                 "M"(0xff & ~mask)
                 : "r30");
  } else {
    asm volatile("lds r30, %0\n\tandi r30, %1\n\tsts %0, r30" ::"n"(address), "M"(0xff & ~mask)
                 : "r30");
  }
}

tini_always_inline void stop_quickly(Pin pin) {
  if (is_there(pin)) clear_quickly(pin.port, pin.mask);
}

tini_always_inline void stop_quickly(Pwm pwm) {
  if (!is_there(pwm.pin)) return;
  clear_quickly(control_of(pwm), connection_of(pwm));
  stop_quickly(pwm.pin);
}

tini_always_inline void stop_quickly(const Bridge& motor) {
  stop_quickly(motor.pwm);
  stop_quickly(motor.forward);
  stop_quickly(motor.backward);
}

tini_always_inline void stop_quickly(const TwoWire& motor) {
  stop_quickly(motor.forward);
  stop_quickly(motor.backward);
}

tini_always_inline void stop_quickly(const ShieldMotors& motors) {
  stop_quickly(motors.pwm);
  stop_quickly(motors.second);
}

// Closes the latch and turns the motors off. Changes r30 alone; for callers with interrupts off.
tini_always_inline void motors_stop_quickly() {
  clear_quickly(kFlagsAt, 1 << static_cast<uint8_t>(Bit::kReleased));
  stop_quickly(kLeftMotor);
  stop_quickly(kRightMotor);
#ifdef tiniscript_motors_bridge
  stop_quickly(kStandby);
#endif
}

}  // namespace tiniscript

#endif
