// Interrupts tell the machine that something else needs the processor.
//
// The machine returns at the next jump back. So it may run as long as nothing happens, and the main
// loop costs little. `vm/execute_avr.S` tests the bit.

#pragma once

#include <avr/io.h>

#include "../../vm/execute_avr.h"

namespace tiniscript {

// A byte has arrived, or a millisecond has passed.
inline void call_attention() { GPIOR0 |= 1 << tini_attention_bit; }

// Clears the bit: the main loop now looks at everything.
inline void pay_attention() { GPIOR0 &= static_cast<uint8_t>(~(1 << tini_attention_bit)); }

}  // namespace tiniscript
