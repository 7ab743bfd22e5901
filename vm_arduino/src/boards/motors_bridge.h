// Motors driven by an L298N, an L293D or a TB6612. Off: no PWM, both direction pins low.
//
// A motor without a pin for backward has a board that makes it of the one for forward.

#pragma once

#include "kit.h"

namespace tiniscript {

tini_always_inline void begin(Bridge motor) {
  begin_pwm(motor.pwm);
  begin_output(motor.forward, false);
  if (is_there(motor.backward)) begin_output(motor.backward, false);
}

// Uses direct writes only, so that it can run before memory is set up.
tini_always_inline void begin_motors() {
  begin(kLeftMotor);
  begin(kRightMotor);
  if (is_there(kStandby)) begin_output(kStandby, false);
}

tini_always_inline void off(Bridge motor) {
  disconnect_inside(motor.pwm);
  write(motor.forward, false);
  if (is_there(motor.backward)) write(motor.backward, false);
}

tini_always_inline void motors_off() {
  off(kLeftMotor);
  off(kRightMotor);
  if (is_there(kStandby)) write(kStandby, false);
}

tini_always_inline void motors_low() { motors_off(); }

// `level` is 1 to 255.
tini_always_inline void drive(Bridge motor, bool is_backward, uint8_t level) {
  if (is_backward) {
    write(motor.forward, false);
    if (is_there(motor.backward)) write(motor.backward, true);
  } else {
    if (is_there(motor.backward)) write(motor.backward, false);
    write(motor.forward, true);
  }
  connect_inside(motor.pwm, level);
}

tini_always_inline void begin_drive(bool is_on) {
  if (is_there(kStandby)) write(kStandby, is_on);
}

}  // namespace tiniscript
