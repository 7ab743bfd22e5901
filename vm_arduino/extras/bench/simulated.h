// What the programs of this folder share: a request in flash, and a UART that writes.
//
// Each `.cpp` here is a program of its own for a simulated ATmega328P; `tools/bench/avr_bench.py`
// builds it, writes the request into it and reads what it says. Ends by sleeping without
// interrupts: that ends the simulator too.

#ifndef TINISCRIPT_BENCH_SIMULATED_H_
#define TINISCRIPT_BENCH_SIMULATED_H_

#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/pgmspace.h>
#include <avr/sleep.h>
#include <stdint.h>

namespace simulated {

constexpr uint16_t kRequestBytes = 1024;

// The bench finds it by its first bytes and overwrites it.
const uint8_t kRequest[kRequestBytes] PROGMEM = {"TiniScript: here is the request"};

uint16_t reading_at = 0;  // of the request

inline uint8_t next_byte() { return pgm_read_byte(kRequest + reading_at++); }

inline uint16_t next_word() {
  const uint16_t low = next_byte();
  return static_cast<uint16_t>(low | static_cast<uint16_t>(next_byte()) << 8);
}

inline uint32_t next_long() {
  const uint32_t low = next_word();
  return low | static_cast<uint32_t>(next_word()) << 16;
}

inline void put(char letter) {
  while ((UCSR0A & _BV(UDRE0)) == 0) {
  }
  UDR0 = static_cast<uint8_t>(letter);
}

inline void put_text(const char* text) {
  while (*text != 0) put(*text++);
}

inline void put_size(uint32_t size) {
  char digits[10];
  uint8_t count = 0;
  do {
    digits[count++] = static_cast<char>('0' + size % 10);
    size /= 10;
  } while (size != 0);
  while (count != 0) put(digits[--count]);
}

inline void put_number(int32_t value) {
  if (value < 0) put('-');
  put_size(value < 0 ? 0 - static_cast<uint32_t>(value) : static_cast<uint32_t>(value));
}

// A line of a word and a number.
inline void say(const char* what, int32_t value) {
  put_text(what);
  put(' ');
  put_number(value);
  put('\n');
}

inline void begin() {
  UCSR0A = _BV(U2X0);
  UCSR0B = _BV(TXEN0);
  UBRR0 = 0;
}

inline void end() {
  put_text("END\n");
  while ((UCSR0A & _BV(TXC0)) == 0) {
  }
  cli();
  sleep_mode();
}

}  // namespace simulated

#endif  // TINISCRIPT_BENCH_SIMULATED_H_
