// Writes bytes into the EEPROM as the firmware does, while an interrupt comes at every cycle in turn. Shows on PORTB how
// many writes were ignored, and then on D7 that it has ended.

#include <avr/interrupt.h>
#include <avr/io.h>

#include "../../vm_arduino/src/boards/avr/eeprom.cpp"

ISR(TIMER1_COMPA_vect) { __builtin_avr_delay_cycles(10); }  // longer than EEPE may come after EEMPE

int main() {
  DDRB = 0x3f;
  DDRD = _BV(7);
  TIMSK1 = _BV(OCIE1A);
  sei();
  for (uint8_t delay = 1; delay < kDelays; delay++) {
    TCCR1B = 0;
    TCNT1 = 0;
    OCR1A = delay;
    TIFR1 = _BV(OCF1A);
    TCCR1B = _BV(CS10);  // a count each cycle
    tiniscript::nvm_write(5, delay);
    while (!tiniscript::nvm_is_ready()) {
    }
    if (tiniscript::nvm_read(5) != delay) PORTB++;
  }
  PORTD |= _BV(7);
  for (;;) {
  }
}
