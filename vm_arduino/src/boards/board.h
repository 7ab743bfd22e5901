// What the sketch asks of the board besides what the firmware does: its clock and its button.

#ifndef TINISCRIPT_BOARDS_BOARD_H_
#define TINISCRIPT_BOARDS_BOARD_H_

#include <stdint.h>

#include "../firmware/board.h"
#include "button.h"

namespace tiniscript {

// All pins but those of the motors: these are low since the reset, and stay it until
// `motors_release`.
void board_begin();

uint32_t board_now_ms();

// Does what is due; to be called all the time.
void board_tick(uint32_t now_ms);

Press board_button(uint32_t now_ms);

// The radio module's STATE pin says that nobody is connected any more: it was high for 50 ms, and
// then low for 50 ms. A pin that nothing drives stays high.
bool board_has_disconnected();

// What the firmware is told of the board.
Board board_told();

}  // namespace tiniscript

#endif  // TINISCRIPT_BOARDS_BOARD_H_
