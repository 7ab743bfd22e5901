// The functions that the machine needs of the robot.
//
// Plain functions: each build links one definition of them (a board, a test, a simulation). None of
// them blocks. Numbers are thousandths, TRUE is 1.

#pragma once

#include <stdint.h>

#include "vm/build.h"

namespace tiniscript {

// Sets both motors, -100 to 100 percent.
void robot_motors(int8_t left, int8_t right);

// Turns the motors off: the program has ended or faulted.
void robot_off();

// The number of readings that programs have on a kit with so many sensors: if there is room, those
// of a remote control follow them. A set of readings has 16 bits on an Uno.
constexpr uint8_t kRemoteRoom = kHasRemote ? 8 : 0;
constexpr uint8_t readings_of(uint8_t sensors) {
  return sensors > kRemoteRoom ? sensors : static_cast<uint8_t>(sensors + kRemoteRoom);
}

// Puts a reading into `*value`. False: it is not available yet, and the machine asks again.
bool robot_read(uint8_t sensor, int32_t* value);

// Starts a sound of 31 to 20000 hertz; it ends by itself.
void robot_beep(uint16_t hertz, uint32_t duration_ms);

// Sends a value; `Machine::shown_at` says where its SHOW is. False: there is no room, and the machine
// tries again.
bool robot_show(int32_t value, bool is_yes_no);

// Sets an actuator; the robot rounds and limits the value to its range.
void robot_set(uint8_t actuator, int32_t value);

// Its speed, or turning speed, at a power of 1 to 100 %: hundred thousandths of a centimetre or a
// degree in a second, at most 10^9; 0 or less: it does not move, or does not know. Only a machine
// with moves by distance calls it.
int32_t robot_speed(bool is_turn, uint8_t power);

// For a robot with a disc on each wheel, which measures its moves. If no build defines them, it has
// none.
bool robot_measures();

// Sets both motors, not to 0, until it has gone a way: thousandths of a centimetre, or of a degree
// where the signs differ. It stops by itself; `robot_motors` and `robot_off` end it.
void robot_go(int8_t left, int8_t right, int32_t distance);

// Goes on with that way, which `robot_motors` has ended: with what is left of it now. The distance
// counts as far as the wheels have rolled since then, or would have without other powers.
void robot_go_on(int8_t left, int8_t right);

// Its place on that way; `*rest` is the rest of it, 0 or more. From kStuck on, it is the number of
// a fault.
enum class MoveState : uint8_t { kMoving, kArrived, kStuck = 4, kStuckLeft, kStuckRight };
MoveState robot_move_state(int32_t* remaining);

// The hash of a device of the kit by its number: first all readings, then the actuators.
// `bytecode_spec.md` defines it.
uint16_t robot_device_hash(uint16_t device);

}  // namespace tiniscript
