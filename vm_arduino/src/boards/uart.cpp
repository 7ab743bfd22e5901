#ifdef ARDUINO

#include "uart.h"

#include <Arduino.h>

#include "../firmware/firmware.h"

#ifdef USART_RX_vect
#define uart_receive_vect USART_RX_vect
#define uart_send_vect USART_UDRE_vect
#else
#define uart_receive_vect USART0_RX_vect
#define uart_send_vect USART0_UDRE_vect
#endif

namespace tiniscript {

void uart_begin(uint32_t baud) {
  UCSR0A = _BV(U2X0);
  UBRR0 = static_cast<uint16_t>((F_CPU / 4 / baud - 1) / 2);  // rounded
  UCSR0C = _BV(UCSZ01) | _BV(UCSZ00);                         // 8N1
  UCSR0B = _BV(RXEN0) | _BV(TXEN0) | _BV(RXCIE0);
}

void uart_tick() { UCSR0B |= _BV(UDRIE0); }

}  // namespace tiniscript

// A byte that came damaged says nothing but that the line is bad: it counts as 0.
ISR(uart_receive_vect) {
  const uint8_t status = UCSR0A;
  const uint8_t byte = UDR0;
  const bool is_damaged = (status & _BV(FE0)) != 0;
  tiniscript::firmware_hear(is_damaged ? 0 : byte, static_cast<uint16_t>(millis()));
}

ISR(uart_send_vect) {
  uint8_t byte = 0;
  if (tiniscript::firmware_say(&byte)) {
    UDR0 = byte;
  } else {
    UCSR0B &= static_cast<uint8_t>(~_BV(UDRIE0));
  }
}

#endif  // ARDUINO
