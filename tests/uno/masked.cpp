// Keeps interrupts off: for kProgram cycles in its program, for kInterrupt in an interrupt, which
// then lets others in and keeps them out again for kLater.

#include <avr/interrupt.h>
#include <avr/io.h>

ISR(TIMER0_OVF_vect) {
  __builtin_avr_delay_cycles(kInterrupt);
  sei();
  __builtin_avr_nop();
  cli();
  __builtin_avr_delay_cycles(kLater);
}

int main() {
  TCCR0B = _BV(CS01);  // an interrupt each 128 us
  TIMSK0 = _BV(TOIE0);
  sei();
  for (;;) {
    cli();
    __builtin_avr_delay_cycles(kProgram);
    sei();
    __builtin_avr_delay_cycles(100);
  }
}
