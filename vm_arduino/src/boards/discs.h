// The slotted discs on both wheels: counts their edges.

#pragma once

#include <stdint.h>

#include "../firmware/board.h"
#include "chip.h"

namespace tiniscript {

// `second` is the pin of its second channel, or kNoPin.
struct Disc {
  Pin pin;
#ifdef __AVR__
  uint8_t interrupt;  // its bit in the mask of the external interrupts
#endif
  Pin second;
};

void discs_begin();
void discs_tick();

}  // namespace tiniscript
