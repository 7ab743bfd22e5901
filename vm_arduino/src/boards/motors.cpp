#include "motors.h"

#include "../robot.h"
#include "kit.h"

#if defined(tiniscript_motors_bridge)
#include "motors_bridge.h"
#elif defined(tiniscript_motors_two_wire)
#include "motors_two_wire.h"
#else
#include "motors_servos.h"
#endif

namespace tiniscript {

namespace {

volatile bool is_released;

// The power that PWM has, 0 to 255: 2.55 for each percent.
uint8_t level_of(int8_t power) {
  uint8_t percent = static_cast<uint8_t>(power < 0 ? -power : power);
  if (percent > 100) percent = 100;
  return static_cast<uint8_t>(percent * 653u >> 8);
}

}  // namespace

// The motor pins are low before memory is set up, and before anything else happens. There is no
// stack frame yet, and `main` follows behind: so it is naked, and nobody calls it.
extern "C" void tiniscript_motors_low() __attribute__((naked, used, section(".init3")));
void tiniscript_motors_low() { begin_motors(); }

void robot_motors(int8_t left, int8_t right) {
  const uint8_t left_level = level_of(left);
  const uint8_t right_level = level_of(right);
  const NoInterrupts quiet;  // a stop comes before this or after it, not in between
  if (!is_released || (left_level | right_level) == 0) {
    motors_off();
    return;
  }
  begin_drive();
  if (left_level == 0) {
    off(kLeftMotor);
  } else {
    drive(kLeftMotor, left < 0, left_level);
  }
  if (right_level == 0) {
    off(kRightMotor);
  } else {
    drive(kRightMotor, right < 0, right_level);
  }
}

void motors_stop() {
  const NoInterrupts quiet;
  is_released = false;
  motors_off();
}

void motors_release() { is_released = true; }

bool motors_are_stopped() { return !is_released; }

}  // namespace tiniscript
