// Interrupts notify the machine of an event: other code needs the processor.
//
// The machine returns at the next jump back. So the machine may run until something happens, and
// the main loop costs little. `vm/execute_avr.S` tests the bit.

#pragma once

#include <avr/io.h>

#include "../../vm/layout_avr.h"

namespace tiniscript {

// A byte has arrived, or a millisecond has passed.
inline void signal_event() { GPIOR0 |= 1 << tini_event_bit; }

// The main loop now checks everything: interrupts have brought the work to do.
inline void poll_events() { GPIOR0 &= static_cast<uint8_t>(~(1 << tini_event_bit)); }

}  // namespace tiniscript
