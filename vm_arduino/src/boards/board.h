// What the sketch asks of the board besides `robot.h`: its clock, its button, its light, its tune.

#ifndef TINISCRIPT_BOARDS_BOARD_H_
#define TINISCRIPT_BOARDS_BOARD_H_

#include <stdint.h>

#include "button.h"

namespace tiniscript {

// All pins but those of the motors: these are low since the reset, and stay it until
// `motors_release`.
void board_begin();

uint32_t board_now_ms();

// Does what is due; to be called all the time.
void board_tick(uint32_t now_ms);

Press board_button(uint32_t now_ms);

// A new program begins: a reading that nobody has fetched is none of its.
void board_forget();

void board_light(bool is_on);

// Plays what says that a program has ended.
void board_finished();

}  // namespace tiniscript

#endif  // TINISCRIPT_BOARDS_BOARD_H_
