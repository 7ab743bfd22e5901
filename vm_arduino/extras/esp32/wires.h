// What is wired to the pins of the simulated chip: motors, buzzer, servos, light, button of a kit.
//
// Knows the pins and what drives them. Alone compiled for each robot, so that little is.

#pragma once

#include <stdint.h>

constexpr uint8_t kMaxServos = 8;

// What reaches the parts, from the pins alone.
struct PartOutputs {
  int left;  // a motor's power, -100 to 100
  int right;
  uint32_t hertz;  // of the buzzer; 0: none
  uint8_t servos;
  uint32_t pulse_us[kMaxServos];  // 0: none
};

PartOutputs part_outputs();
bool light_is_on();
void set_button(bool is_down);
