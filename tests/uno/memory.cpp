// Writes five bytes into the EEPROM and shows on its pins how long that takes.
//
// D8 is high while the writes go on, D9 from when the interrupt has written two more; D10 once it
// has read one. With kIgnores it takes for granted that a byte is written at once.

#include <avr/eeprom.h>
#include <avr/interrupt.h>
#include <avr/io.h>

namespace {

volatile uint8_t rest = 2;

void put(uint16_t place, uint8_t byte) {
  EEAR = place;
  EEDR = byte;
  EECR |= _BV(EEMPE);
  EECR |= _BV(EEPE);
}

}  // namespace

ISR(EE_READY_vect) {
  if (rest == 0) {
    EECR &= static_cast<uint8_t>(~_BV(EERIE));
    PORTB |= _BV(1);
    return;
  }
  rest--;
  put(static_cast<uint16_t>(10 + rest), 0x77);
}

int main() {
  DDRB = 0x07;
  PORTB |= _BV(0);
  for (uint8_t k = 0; k < 5; k++) {
    while (!kIgnores && (EECR & _BV(EEPE))) {
    }
    put(k, static_cast<uint8_t>(k + 1));
  }
  while (EECR & _BV(EEPE)) {
  }
  PORTB &= static_cast<uint8_t>(~_BV(0));
  EEAR = 2;
  EECR |= _BV(EERE);
  if (EEDR == 3) PORTB |= _BV(2);
  sei();
  EECR |= _BV(EERIE);
  for (;;) {
  }
}
