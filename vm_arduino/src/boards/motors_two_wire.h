// Motors driven by a chip with two inputs for each, such as a DRV8833 or an L9110. Off: both low.

#pragma once

#include "kit.h"

namespace tiniscript {

tini_always_inline void begin_motors() {
  begin_pwm(kLeftMotor.forward);
  begin_pwm(kLeftMotor.backward);
  begin_pwm(kRightMotor.forward);
  begin_pwm(kRightMotor.backward);
}

tini_always_inline void off(TwoWire motor) {
  disconnect_inside(motor.forward);
  disconnect_inside(motor.backward);
}

tini_always_inline void motors_off() {
  off(kLeftMotor);
  off(kRightMotor);
}

tini_always_inline void motors_low() { motors_off(); }

tini_always_inline void drive(TwoWire motor, bool is_backward, uint8_t level) {
  if (is_backward) {
    disconnect_inside(motor.forward);
    connect_inside(motor.backward, level);
  } else {
    disconnect_inside(motor.backward);
    connect_inside(motor.forward, level);
  }
}

tini_always_inline void begin_drive(bool) {}

}  // namespace tiniscript
