#include "motors.h"

#include "../firmware/board.h"
#include "../vm/flags.h"
#include "kit.h"

#if defined(tiniscript_motors_bridge)
#include "motors_bridge.h"
#elif defined(tiniscript_motors_two_wire)
#include "motors_two_wire.h"
#elif defined(tiniscript_motors_shift_register)
#include "motors_shift_register.h"
#else
#include "motors_servos.h"
#endif

namespace tiniscript {

namespace {

Flag<Bit::kReleased> is_released;

uint8_t size_of(int16_t level) {
  uint8_t size = static_cast<uint8_t>(level);
  if (level < 0) size = static_cast<uint8_t>(-size);
  return size;
}

}  // namespace

#ifdef __AVR__
// Pulls the motor pins low before memory is set up. It is naked because there is no stack frame
// yet; `main` follows it in flash, so it is never called.
extern "C" void tiniscript_motors_low() __attribute__((naked, used, section(".init3")));
void tiniscript_motors_low() { begin_motors(); }
#else
// The Arduino core calls it before it starts the task of setup() and loop().
extern "C" void initVariant() { begin_motors(); }

// In RAM, and by registers alone: in a panic flash may be out of reach.
extern "C" void IRAM_ATTR tiniscript_motors_low() { motors_low(); }
#endif

void board_motors(int16_t left, int16_t right) {
  uint8_t left_level = size_of(left);
  uint8_t right_level = size_of(right);
  const CriticalSection critical;  // a stop comes before or after this block, never inside it
  if (!is_released) left_level = right_level = 0;
  begin_drive((left_level | right_level) != 0);
#ifdef tiniscript_motors_shift_register
  if ((left_level | right_level) != 0) point(left < 0, right < 0);
#endif
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
  const CriticalSection critical;
  is_released = false;
  motors_off();
}

void motors_release() { is_released = true; }

bool motors_are_stopped() { return !is_released; }

}  // namespace tiniscript
