// What a sketch does with its timers and its ADC, without Arduino: outputs of all timers, and what
// A0 reads over the UART; D7 is high during a conversion. Waits for a low D2 with its pull-up on.

#include <avr/io.h>

int main() {
  PORTD = _BV(2);
  DDRD = _BV(3) | _BV(5) | _BV(6) | _BV(7);
  DDRB = 0x3f;
  while (PIND & _BV(2)) {
    PORTD ^= _BV(7);  // a write to the port, which leaves D2 as it is
  }
  TCCR0A = _BV(COM0A1) | _BV(COM0B1) | _BV(WGM01) | _BV(WGM00);
  TCCR0B = _BV(CS01) | _BV(CS00);
  OCR0A = 63;
  OCR0B = 127;
  TCCR1A = _BV(COM1A1) | _BV(WGM11);  // fast, up to ICR1: a servo's 50 Hz
  TCCR1B = _BV(WGM13) | _BV(WGM12) | _BV(CS11);
  ICR1 = 39999;
  OCR1A = 2999;
  TCCR2A = _BV(COM2B1) | _BV(WGM20);  // phase-correct
  TCCR2B = _BV(CS22);
  OCR2B = 51;
  ADMUX = _BV(REFS0);
  ADCSRA = _BV(ADEN) | _BV(ADPS2) | _BV(ADPS1) | _BV(ADPS0);
  UCSR0A = _BV(U2X0);
  UBRR0 = 16;
  UCSR0B = _BV(TXEN0);
  for (;;) {
    PORTD |= _BV(7);
    ADCSRA |= _BV(ADSC);
    while (ADCSRA & _BV(ADSC)) {
    }
    PORTD &= static_cast<uint8_t>(~_BV(7));
    const uint16_t count = ADC;
    for (uint8_t k = 0; k < 2; k++) {
      while ((UCSR0A & _BV(UDRE0)) == 0) {
      }
      UDR0 = static_cast<uint8_t>(k ? count >> 8 : count);
    }
  }
}
