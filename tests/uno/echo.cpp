// Sends back what comes in, from kWait ms after its begin: until then bytes pile up.
//
// D8 is high once a byte has had a framing error, D9 once bytes have been lost; D7 while a byte is
// at work.

#include <avr/io.h>
#include <util/delay.h>

int main() {
  UCSR0A = _BV(U2X0);
  UBRR0 = F_CPU / 4 / kBaud / 2 - 1 + (F_CPU / 4 / kBaud) % 2;
  UCSR0B = _BV(RXEN0) | _BV(TXEN0);
  DDRB = 0x03;
  DDRD = _BV(7);
  _delay_ms(kWait);
  for (;;) {
    while ((UCSR0A & _BV(RXC0)) == 0) {
    }
    const uint8_t errors = UCSR0A;
    const uint8_t byte = UDR0;
    PORTD |= _BV(7);
    if (errors & _BV(FE0)) PORTB |= 0x01;
    if (errors & _BV(DOR0)) PORTB |= 0x02;
    while ((UCSR0A & _BV(UDRE0)) == 0) {
    }
    UDR0 = byte;
    PORTD &= static_cast<uint8_t>(~_BV(7));
  }
}
