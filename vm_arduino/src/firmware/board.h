// What the firmware asks of the board besides `robot.h` and `nvm.h`.
//
// Plain functions: each build links one definition of them (a board, a test, a simulation). None
// of them waits.

#ifndef TINISCRIPT_FIRMWARE_BOARD_H_
#define TINISCRIPT_FIRMWARE_BOARD_H_

#include <stdint.h>

#include "../link/port.h"

namespace tiniscript {

// The kit that the board is built for, why it began, and a number that is seldom the same twice.
struct Board {
  uint16_t kit;
  uint8_t sensors;
  uint8_t actuators;
  int32_t* readings;  // where the last one of each sensor is kept
  Reset reset;
  uint32_t seed;
  uint32_t max_run_ms;  // the longest run without a tether
};

// A place in a program: the checksum of its image, and the offset of an instruction.
struct Place {
  uint32_t program;
  uint16_t at;
};

// Sets the outputs of the motor driver, -255 to 255, forward where that is more than 0. Turns none
// on while the latch is closed.
void board_motors(int16_t left, int16_t right);

// Closes the latch: motors off, and nothing turns them on before `board_release`.
void board_stop();
void board_release();

// Turns off what a stop turns off besides: yes/no actuators FALSE, servos without pulses. To be
// called while the latch is closed: then no program sets them meanwhile.
void board_actuators_off();

// Whether the main loop stood still, since the last question: the board has turned the motors off.
bool board_has_stalled();

LineErrors board_line_errors();

// Whether the watchdog has ended the last run before this reset, and what ran there: zeros where
// that was nothing. It tells it once.
bool board_has_hung(Place* place);

// A program begins: a reading that nobody has fetched is none of its.
void board_forget();

// Whether there is enough voltage to write what must not be spoilt. Begins a measurement where none
// is under way, and says once what it has found. To be asked in every tick until then: a
// measurement that nobody asks for is given up.
enum class Supply : uint8_t { kMeasuring, kLow, kEnough };
Supply board_supply();

// The light is on while a press of the button would start something.
void board_light(bool is_on);

// What is heard at the end of a program, and when a fault has ended it.
void board_finished();
void board_faulted();

}  // namespace tiniscript

#endif  // TINISCRIPT_FIRMWARE_BOARD_H_
