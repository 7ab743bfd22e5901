// The UART of an AVR. A byte comes in at `uart_receive_vect`, below `receive`: that looks for a stop
// (`tiniscript_on_zero`), and then `receive` gives the byte to the firmware (`take`).

#ifdef __AVR__

#include "../uart.h"

#include <avr/interrupt.h>
#include <avr/io.h>

#include "../../firmware/firmware.h"
#include "../../firmware/one_line.h"
#include "../../firmware/state.h"
#include "../../link/link_avr.h"
#include "../../link/messages.h"
#include "../kit.h"
#include "clock.h"
#include "events.h"
#include "interrupts.h"
#include "quick_stop.h"

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

constexpr uint8_t kListening = _BV(RXEN0) | _BV(TXEN0) | _BV(RXCIE0);  // UCSR0B

// A byte under way is over after this many turns of timer 0 (about 1 ms each). A line that is low
// in all of them, with no byte received, is held low.
constexpr uint8_t kLowTurns = static_cast<uint8_t>(10000 / kBaud + 3);

#ifdef tiniscript_has_quick_stop

// A zero has arrived: turns the motors off if it completes a run of them that stops the robot, as
// `Receiver::count_zeros` finds it. Changes r24, r30 and r31 alone; for callers with interrupts off.
extern "C" void tiniscript_on_zero() __attribute__((naked, used, noinline, externally_visible));
void tiniscript_on_zero() {
  asm volatile(
      "lds r30, %[receiver] + %[zeros]\n\tinc r30\n\tsts %[receiver] + %[zeros], r30\n\t"
      "cpi r30, %[run]\n\tbreq 2f\n"
      "1: ret\n"
      "2: lds r30, %[now]\n\tlds r31, %[receiver] + %[last]\n\tsub r30, r31\n\t"
      "lds r31, %[now] + 1\n\tlds r24, %[receiver] + %[last] + 1\n\tsbc r31, r24\n\t"
      "subi r30, lo8(%[silence])\n\tsbci r31, hi8(%[silence])\n\tbrcc 1b"
      :
      : [receiver] "i"(&receiver), [zeros] "n"(Receiver::Layout::zeros_at()),
        [last] "n"(Receiver::Layout::last_ms_at()), [now] "i"(&clock), [run] "M"(kStopZeros),
        [silence] "n"(kSilenceMs)
      : "r24", "r30", "r31");
  motors_stop_quickly();
  asm volatile("ret");
}

tini_always_inline void look_for_stop() { tiniscript_on_zero(); }

// A byte that a stop was looked for in.
tini_always_inline void take(uint8_t byte) { firmware_take_rx_byte(byte, clock_16_ms()); }

#else

tini_always_inline void look_for_stop() {}
tini_always_inline void take(uint8_t byte) { firmware_on_rx_byte(byte, clock_16_ms()); }

#endif

volatile uint8_t framing;
volatile uint8_t overrun;
// Whether the line was high since the reset or since it was last held low; otherwise it has no
// sender. A USB chip without its cable holds the line low for good, and the button must still work.
volatile bool was_high;
uint8_t low_turns;  // since the last byte with a framing error

// Enables the interrupt of timer 0 that checks the line. It is on only after a framing error. Its
// flag has been set for long: it comes at once, and that one does not count. Clearing the flag
// would cost an instruction, and in simavr also the overflow of the clock if that is pending.
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
  if (low_turns <= kLowTurns) return;
  look_for_stop();
  take(0);
  if (low_turns < kLowTurns + kStopZeros) return;
  was_high = false;
  leave_line();
}

}  // namespace

void uart_begin(uint32_t baud) {
  begin_pull_up(kReceive);  // stays high if unconnected
  UCSR0A = _BV(U2X0);
  UBRR0 = static_cast<uint16_t>((F_CPU / 4 / baud - 1) / 2);  // rounded
  UCSR0C = _BV(UCSZ01) | _BV(UCSZ00);                         // 8N1
  UCSR0B = kListening;
}

void uart_tick() {
  if (is_high(kReceive)) was_high = true;
}

void uart_send() {
  if (firmware_has_tx_byte()) UCSR0B |= _BV(UDRIE0);
}

LineErrors uart_errors() { return {framing, overrun}; }

namespace {

// The work that follows the look for a stop. A byte with a framing error is 0 here: only that the
// line is bad is known.
void receive(uint8_t byte, uint8_t status) {
  low_turns = 0;
  if ((status & (_BV(DOR0) | _BV(FE0))) != 0) {
    if ((status & _BV(DOR0)) != 0) overrun = static_cast<uint8_t>(overrun + 1);
    if ((status & _BV(FE0)) != 0) {
      framing = static_cast<uint8_t>(framing + 1);
      watch_line();
    }
  }
  signal_event();
  take(byte);
}

}  // namespace

}  // namespace tiniscript

// Looks for a stop before it saves the registers that the rest may change.
ISR(uart_receive_vect, ISR_NAKED) {
  asm volatile(
      "push r30\n\tpush r31\n\tpush r24\n\tin r24, __SREG__\n\tpush r24\n\tpush r22\n\t"
      "lds r22, %[status]\n\tlds r24, %[data]\n\t"
      "sbrc r22, %[framing]\n\tclr r24\n\t"
#ifdef tiniscript_has_quick_stop
      "tst r24\n\tbrne 1f\n\t"
      "%~call tiniscript_on_zero\n\tclr r24\n"
      "1: "
#endif
      "ldi r30, lo8(gs(%x[rest]))\n\tldi r31, hi8(gs(%x[rest]))\n\t"
      "%~jmp tiniscript_interrupt_rest"
      :
      : [status] "n"(_SFR_MEM_ADDR(UCSR0A)), [data] "n"(_SFR_MEM_ADDR(UDR0)), [framing] "I"(FE0),
        [rest] "i"(tiniscript::receive));
}

// Two discs come before a stop, too: there it comes in before this interrupt is over.
#ifdef tiniscript_discs
#define tini_let_stop_in "sei\n\t"
#else
#define tini_let_stop_in ""
#endif

// Does `firmware_next_tx_byte`; in assembly, because a stop waits for it. If no bytes are left, its
// own interrupt is switched off.
ISR(uart_send_vect, ISR_NAKED) {
  using namespace tiniscript;
  asm volatile(
      "push r30\n\tpush r31\n\tin r30, __SREG__\n\tpush r30\n\t"
      "lds r30, %[link] + %[left]\n\tsubi r30, 1\n\tbrcs 1f\n\tsts %[link] + %[left], r30\n\t"
      "lds r30, %[link] + %[sent]\n\tinc r30\n\tsts %[link] + %[sent], r30\n\tldi r31, 0\n\t"
      "subi r30, lo8(-(%[link] + %[out] - 1))\n\tsbci r31, hi8(-(%[link] + %[out] - 1))\n\t"
      "ld r30, Z\n\t" tini_let_stop_in
      "sts %[data], r30\n\trjmp 2f\n"
      "1: ldi r30, %[listening]\n\tsts %[control], r30\n"
      "2: pop r30\n\tout __SREG__, r30\n\tpop r31\n\tpop r30\n\treti"
      :
      : [link] "i"(&link), [left] "n"(Link::Layout::bytes_left_at()),
        [sent] "n"(Link::Layout::sent_at()), [out] "n"(Link::Layout::out_at()),
        [data] "n"(_SFR_MEM_ADDR(UDR0)), [control] "n"(_SFR_MEM_ADDR(UCSR0B)),
        [listening] "M"(static_cast<int>(kListening)));
}

tiniscript_interrupt(TIMER0_COMPB_vect, tiniscript::look_at_line)

#endif  // __AVR__
