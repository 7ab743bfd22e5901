// Sends back what comes in, by interrupts alone, and sleeps in between.

#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/sleep.h>

namespace {

volatile uint8_t bytes[256];
volatile uint8_t begin;
volatile uint8_t end;

}  // namespace

ISR(USART_RX_vect) {
  bytes[end++] = UDR0;
  UCSR0B |= _BV(UDRIE0);
}

ISR(USART_UDRE_vect) {
  if (begin == end) {
    UCSR0B &= static_cast<uint8_t>(~_BV(UDRIE0));
  } else {
    UDR0 = bytes[begin++];
  }
}

ISR(USART_TX_vect) { PINB = _BV(PINB0); }

int main() {
  UCSR0A = _BV(U2X0);
  UBRR0 = 16;
  UCSR0B = _BV(RXEN0) | _BV(TXEN0) | _BV(RXCIE0) | _BV(TXCIE0);
  DDRB = _BV(0);
  sei();
  for (;;) sleep_mode();
}
