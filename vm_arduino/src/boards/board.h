// What the sketch asks of the board besides `robot.h`: its pins, its clock, its button, its light.

#ifndef TINISCRIPT_BOARDS_BOARD_H_
#define TINISCRIPT_BOARDS_BOARD_H_

#include <Arduino.h>  // declares setup() and loop()
#include <stdint.h>

namespace tiniscript {

// The kit that programs see: its fingerprint and how many devices it has.
constexpr uint16_t kBoardKit = 0x231b;
constexpr uint8_t kBoardSensors = 3;
constexpr uint8_t kBoardActuators = 0;

// Motors off, then the other pins.
void board_begin();

uint32_t board_now_ms();

// Whether the start button has been pressed since the last question.
bool board_pressed();

void board_light(bool is_on);

}  // namespace tiniscript

#endif  // TINISCRIPT_BOARDS_BOARD_H_
