// A program on a simulated ATmega, for tests and benches: a request in flash, and a UART that writes.
//
// Who builds it writes the request into the built program: `tests/machines/avr.py` and
// `tools/bench/avr_bench.py`. Defines what `../chip/port.h` declares, but for `request_bytes`, in
// the one file of a program that includes it. Ends by sleeping without interrupts: that ends the
// simulator too.

#pragma once

#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/sleep.h>

#include "../../src/vm/cpu.h"
#include "../chip/request.h"
#include "../chip/text.h"

namespace simulated {

constexpr size_t kRequestBytes = 8192;

// It is found by its first bytes and overwritten.
const uint8_t kRequest[kRequestBytes] tini_progmem = {"TiniScript: here is the request"};

tiniscript::Request request(0);

inline void begin() {
  UCSR0A = _BV(U2X0);
  UCSR0B = _BV(TXEN0);
  UBRR0 = 0;
}

// A line of a word and a number.
inline void say(const char* name, int32_t value) {
  tiniscript::put_text(name);
  tiniscript::put(' ');
  tiniscript::put_number(value);
  tiniscript::put('\n');
}

inline void end() {
  tiniscript::put_text("END\n");
  while ((UCSR0A & _BV(TXC0)) == 0) {
  }
  cli();
  sleep_mode();
}

}  // namespace simulated

namespace tiniscript {

uint8_t request_byte(size_t place) {
  return place < simulated::kRequestBytes ? flash_byte(simulated::kRequest + place) : 0;
}

void put(char letter) {
  while ((UCSR0A & _BV(UDRE0)) == 0) {
  }
  UDR0 = static_cast<uint8_t>(letter);
}

}  // namespace tiniscript
