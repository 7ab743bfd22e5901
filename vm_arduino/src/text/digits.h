// Decimal digits of a number, the last one first.

#pragma once

#include <stdint.h>

namespace tiniscript {

// Divides a number by ten. Returns what remains.
inline uint8_t cut_digit(uint32_t* number) {
#ifdef __AVR__
  // In `reader_avr.S`: the compiler's own division takes a divisor of 32 bits.
  register uint32_t rest asm("r18") = *number;
  register uint8_t digit asm("r24");
  asm("%~call tiniscript_divide_10" : "+r"(rest), "=r"(digit) : : "r25");
  *number = rest;
  return digit;
#else
  const uint8_t digit = static_cast<uint8_t>(*number % 10);
  *number /= 10;
  return digit;
#endif
}

}  // namespace tiniscript
