#ifdef __AVR__

#include "interrupts.h"

// Calls the function at Z; r30 and r31 are saved. At `tiniscript_interrupt_rest` r24, SREG and r22
// are saved too, and r24 and r22 are the function's arguments.
extern "C" void tiniscript_interrupt_frame()
    __attribute__((naked, used, noinline, externally_visible));
void tiniscript_interrupt_frame() {
  asm volatile(
      "push r24\n\tin r24, __SREG__\n\tpush r24\n\tpush r22\n"
      ".global tiniscript_interrupt_rest\n"
      "tiniscript_interrupt_rest:\n\t"
      "push r0\n\tpush r1\n\tclr r1\n\t"
      "push r18\n\tpush r19\n\tpush r20\n\tpush r21\n\t"
      "push r23\n\tpush r25\n\tpush r26\n\tpush r27\n\t"
      "icall\n\t"
      "pop r27\n\tpop r26\n\tpop r25\n\tpop r23\n\t"
      "pop r21\n\tpop r20\n\tpop r19\n\tpop r18\n\t"
      "pop r1\n\tpop r0\n\t"
      "pop r22\n\tpop r24\n\tout __SREG__, r24\n\tpop r24\n\t"
      "pop r31\n\tpop r30\n\treti");
}

#endif  // __AVR__
