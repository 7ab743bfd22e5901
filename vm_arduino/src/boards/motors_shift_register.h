// Motors driven by L293Ds whose directions are in a 74HC595, as on the shield HW-130. Off: no PWM.
//
// A stop turns only the PWM off, so it is as quick as with other drivers; the directions stay.

#pragma once

#include "kit.h"

namespace tiniscript {

namespace {

uint8_t directions;  // content of the register; 0 until a motor has been turned on

}  // namespace

tini_always_inline void begin(ShieldMotors motors) {
  begin_pwm(motors.pwm);
  if (is_there(motors.second.pin)) begin_pwm(motors.second);
}

// Uses direct writes only, so that it can run before memory is set up.
tini_always_inline void begin_motors() {
  begin(kLeftMotor);
  begin(kRightMotor);
  begin_output(kDirections.enable, true);
  begin_output(kDirections.latch, false);
  begin_output(kDirections.data, false);
  begin_output(kDirections.clock, false);
}

tini_always_inline void off(ShieldMotors motors) {
  disconnect_inside(motors.pwm);
  if (is_there(motors.second.pin)) disconnect_inside(motors.second);
}

tini_always_inline void motors_off() {
  off(kLeftMotor);
  off(kRightMotor);
}

// Puts the bits into the register, the highest first, and shows them at its outputs. Each write
// takes two cycles or more, 125 ns; a 74HC595 wants at most 30 ns between any two of these edges.
tini_always_inline void shift_out(uint8_t bits) {
  for (uint8_t bits_left = 8; bits_left != 0; bits_left--) {
    write(kDirections.data, (bits & 0x80) != 0);
    write(kDirections.clock, true);
    bits = static_cast<uint8_t>(bits << 1);
    write(kDirections.clock, false);
  }
  write(kDirections.latch, true);
  write(kDirections.latch, false);
}

// No motor has power while its direction changes.
tini_always_inline void point(bool is_left_backward, bool is_right_backward) {
  const uint8_t left = is_left_backward ? kLeftMotor.backward : kLeftMotor.forward;
  const uint8_t right = is_right_backward ? kRightMotor.backward : kRightMotor.forward;
  const uint8_t new_directions = left | right;
  if (new_directions == directions) return;
  directions = new_directions;
  motors_off();
  shift_out(new_directions);
  write(kDirections.enable, false);
}

// `level` is 1 to 255.
tini_always_inline void drive(ShieldMotors motors, bool, uint8_t level) {
  connect_inside(motors.pwm, level);
  if (is_there(motors.second.pin)) connect_inside(motors.second, level);
}

tini_always_inline void begin_drive(bool) {}

}  // namespace tiniscript
