// The sketch's view of the board beyond `firmware/board.h`: clock and button.

#pragma once

#include <stdint.h>

#include "../firmware/board.h"
#include "button.h"

namespace tiniscript {

// Sets up all pins but those of the motors, which are low since the reset and stay low until
// `motors_release`.
void board_begin();

uint32_t board_now_ms();

// Whether the clock has advanced since the last call, or the button has moved since it was read.
bool board_has_news();

// Does the work that is due; call it after an event: about once a millisecond.
void board_tick(uint32_t now_ms);

Press board_button(uint32_t now_ms);

// True once the radio module's STATE pin was high for 50 ms and then low for 50 ms: the client has
// disconnected. Call it at least every 10 ms. An undriven pin stays high.
bool board_has_disconnected();

// The data with which the firmware begins.
BootInfo board_boot_info();

}  // namespace tiniscript
