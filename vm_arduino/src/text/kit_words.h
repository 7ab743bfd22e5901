// The functions that the reader of text needs of the robot: the words of its kit, and the language
// of its answers.
//
// Each build links one definition, as of `robot.h`.

#pragma once

#include <stdint.h>

#include "../vm/cpu.h"

namespace tiniscript {

// Bits of what stands after the letters of a device; the reader says with them what a name is.
constexpr uint8_t kIsYesNo = 1;
constexpr uint8_t kIsSensor = 2;
constexpr uint8_t kIsActuator = 4;
constexpr uint8_t kGivesWay = 8;  // a sensor, to a name of the program if it has not been asked before
constexpr uint8_t kRangeBytes = 8;

// Bits after the table.
constexpr uint8_t kKitGoes = 1;
constexpr uint8_t kKitTurns = 2;

// The sensors, the actuators, and then what a remote control says, in flash: the letters of each, 0x80 in the last one; what it
// is; after an actuator that is a number its least and its largest value, thousandths of 32 bits,
// little-endian. A 0 ends the table; after it bits say whether the kit says how fast it goes and
// turns.
const uint8_t* robot_words();

// The language in which a person is answered: both letters of its code, as 0x6573 for es. For a
// robot that texts.cpp does not have, English.
uint16_t robot_language();

// Returns what is after a device, from what it is on.
inline const uint8_t* after_device(const uint8_t* device) {
  const bool has_range = flash_byte(device) == kIsActuator;
  return device + 1 + (has_range ? kRangeBytes : 0);
}

// Whether the kit says how fast it goes or turns.
inline bool robot_has_speed(bool is_turn) {
  const uint8_t* word = robot_words();
  while (flash_byte(word) != 0) {
    while (flash_byte(word++) < 0x80) {
    }
    word = after_device(word);
  }
  return (flash_byte(word + 1) & (is_turn ? kKitTurns : kKitGoes)) != 0;
}

}  // namespace tiniscript
