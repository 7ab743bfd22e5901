// Tables that stay in flash.
//
// The AVR has a separate address space for flash: a table there is read with a special instruction,
// and any other constant takes RAM. Other chips need nothing special.

#pragma once

#include <stdint.h>

#ifdef __AVR__
#include <avr/pgmspace.h>
#define tini_progmem __attribute__((progmem))
#else
#define tini_progmem
#endif

namespace tiniscript {

inline uint8_t flash_byte(const uint8_t* address) {
#ifdef __AVR__
  return pgm_read_byte(address);
#else
  return *address;
#endif
}

inline uint16_t flash_word(const uint16_t* address) {
#ifdef __AVR__
  return pgm_read_word(address);
#else
  return *address;
#endif
}

}  // namespace tiniscript
