// Motors that are continuous-rotation servos. Off: neutral pulses for a second, then none.

#pragma once

#include "kit.h"
#include "servo.h"

namespace tiniscript {

constexpr uint8_t kStillFrames = 50;  // 20 ms each

tini_always_inline void begin_motors() {
  hold_servo_pin_low(kServos[kLeftMotor.number]);
  hold_servo_pin_low(kServos[kRightMotor.number]);
}

// Leaves alone a servo that stands still or is about to.
tini_always_inline void off(TurningServo motor) {
  if (servo_is_held(motor.number)) servo_set(motor.number, motor.still_us, kStillFrames);
}

tini_always_inline void motors_off() {
  off(kLeftMotor);
  off(kRightMotor);
}

#ifndef __AVR__
// Their pins, after a panic.
tini_always_inline void motors_low() {
  disconnect_inside(kServos[kLeftMotor.number]);
  disconnect_inside(kServos[kRightMotor.number]);
}
#endif

// At level 255 the pulse is 510 us longer or shorter.
tini_always_inline void drive(TurningServo motor, bool is_backward, uint8_t level) {
  const uint16_t offset_us = static_cast<uint16_t>(2 * level);
  const bool is_shorter = is_backward != motor.is_reversed;
  servo_set(
      motor.number,
      static_cast<uint16_t>(is_shorter ? motor.still_us - offset_us : motor.still_us + offset_us),
      0);
}

tini_always_inline void begin_drive(bool) {}

}  // namespace tiniscript
