#ifdef __AVR__

#include "../uart.h"

#include <avr/interrupt.h>
#include <avr/io.h>

#include "../../firmware/firmware.h"
#include "../../link/messages.h"
#include "attention.h"
#include "clock.h"
#include "interrupts.h"
#include "../kit.h"

#ifdef USART_RX_vect
#define uart_receive_vect USART_RX_vect
#define uart_send_vect USART_UDRE_vect
#else
#define uart_receive_vect USART0_RX_vect
#define uart_send_vect USART0_UDRE_vect
#endif

namespace tiniscript {

namespace {

#ifdef __AVR_ATmega2560__
constexpr Pin kReceive = {kPortE, 1 << 0};
#else
constexpr Pin kReceive = {kPortD, 1 << 0};
#endif

// A byte under way is over after this many turns of timer 0 (about 1 ms each). A line that is low
// in all of them, with no byte received, is held low.
constexpr uint8_t kHeldTurns = static_cast<uint8_t>(10000 / kBaud + 3);

volatile uint8_t framing;
volatile uint8_t overrun;
// Whether the line was high since the reset or since it was last held low; otherwise it has no
// sender. A USB chip without its cable holds the line low for good, and the button must still work.
volatile bool was_high;
uint8_t low_turns;  // since the last byte with a framing error

// Enables the interrupt of timer 0 that checks the line. It is on only after a framing error. Its
// flag has been set for long: it comes at once, and that one does not count. Clearing the flag would
// cost an instruction, and in simavr also the overflow of the clock if that is pending.
tini_always_inline void watch_line() {
  low_turns = static_cast<uint8_t>(-1);
  if (!was_high) return;
  TIMSK0 |= _BV(OCIE0B);
}

tini_always_inline void leave_line() { TIMSK0 &= static_cast<uint8_t>(~_BV(OCIE0B)); }

// The interrupt of timer 0.
void look_at_line() {
  if (is_high(kReceive)) return leave_line();
  low_turns = static_cast<uint8_t>(low_turns + 1);
  if (low_turns <= kHeldTurns) return;
  firmware_on_rx_byte(0, clock_16_ms());
  if (low_turns < kHeldTurns + kStopRun) return;
  was_high = false;
  leave_line();
}

}  // namespace

void uart_begin(uint32_t baud) {
  begin_pull_up(kReceive);  // stays high if nothing is connected
  UCSR0A = _BV(U2X0);
  UBRR0 = static_cast<uint16_t>((F_CPU / 4 / baud - 1) / 2);  // rounded
  UCSR0C = _BV(UCSZ01) | _BV(UCSZ00);                         // 8N1
  UCSR0B = _BV(RXEN0) | _BV(TXEN0) | _BV(RXCIE0);
}

void uart_tick() {
  if (is_high(kReceive)) was_high = true;
}

void uart_send() {
  if (firmware_has_tx_byte()) UCSR0B |= _BV(UDRIE0);
}

LineErrors uart_errors() { return {framing, overrun}; }

namespace {

// A byte with a framing error counts as 0: only that the line is bad is known.
void receive() {
  const uint8_t status = UCSR0A;
  uint8_t byte = UDR0;
  low_turns = 0;
  if ((status & (_BV(DOR0) | _BV(FE0))) != 0) {
    if ((status & _BV(DOR0)) != 0) overrun = static_cast<uint8_t>(overrun + 1);
    if ((status & _BV(FE0)) != 0) {
      framing = static_cast<uint8_t>(framing + 1);
      byte = 0;
      watch_line();
    }
  }
  call_attention();
  firmware_on_rx_byte(byte, clock_16_ms());
}

}  // namespace

}  // namespace tiniscript

tiniscript_interrupt(uart_receive_vect, tiniscript::receive)

    tiniscript_interrupt(TIMER0_COMPB_vect, tiniscript::look_at_line)

        ISR(uart_send_vect) {
  uint8_t byte = 0;
  if (tiniscript::firmware_next_tx_byte(&byte)) {
    UDR0 = byte;
  } else {
    UCSR0B &= static_cast<uint8_t>(~_BV(UDRIE0));
  }
}

#endif  // __AVR__
