// Interrupts that share one frame: it saves the registers that a function may change.
//
// A frame of its own takes about 60 bytes in each interrupt that calls something. The shared one
// begins 12 cycles later.

#pragma once

#include <avr/interrupt.h>

namespace tiniscript {

// The whole of a naked interrupt: calls `function`.
inline __attribute__((always_inline)) void call_in_frame(void (*function)()) {
  asm volatile(
      "push r30\n\tpush r31\n\t"
      "ldi r30, lo8(gs(%x0))\n\tldi r31, hi8(gs(%x0))\n\t"
      "%~jmp tiniscript_interrupt_frame" ::"i"(function));
}

}  // namespace tiniscript

// Defines the handler of `vector`: it calls `function`, which has neither arguments nor a result.
#define tiniscript_interrupt(vector, function) \
  ISR(vector, ISR_NAKED) { tiniscript::call_in_frame(function); }
