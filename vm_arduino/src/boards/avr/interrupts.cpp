#ifdef __AVR__

#include "interrupts.h"

// Calls the function at Z; r30 and r31 are saved.
extern "C" void tiniscript_interrupt_frame()
    __attribute__((naked, used, noinline, externally_visible));
void tiniscript_interrupt_frame() {
  asm volatile(
      "push r0\n\tin r0, __SREG__\n\tpush r0\n\tpush r1\n\tclr r1\n\t"
      "push r18\n\tpush r19\n\tpush r20\n\tpush r21\n\tpush r22\n\t"
      "push r23\n\tpush r24\n\tpush r25\n\tpush r26\n\tpush r27\n\t"
      "icall\n\t"
      "pop r27\n\tpop r26\n\tpop r25\n\tpop r24\n\tpop r23\n\t"
      "pop r22\n\tpop r21\n\tpop r20\n\tpop r19\n\tpop r18\n\t"
      "pop r1\n\tpop r0\n\tout __SREG__, r0\n\tpop r0\n\t"
      "pop r31\n\tpop r30\n\treti");
}

#endif  // __AVR__
