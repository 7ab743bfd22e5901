// The CPU of an AVR, as the firmware sees it. `cpu.h` includes this.
//
// Flash is a separate address space: a table there is read with a special instruction, and any other
// constant takes RAM. GPIOR0 to GPIOR2 are flags and bytes that much of the firmware asks: a bit is
// tested, set and cleared by one instruction each, which no interrupt can split, and a byte takes half
// the flash that one in RAM does. A restart by a jump leaves them: `begin_flags` makes them 0.

#pragma once

#include <avr/pgmspace.h>
#include <stdint.h>

#define tini_progmem __attribute__((progmem))
#define tini_noinline __attribute__((noinline, noclone))
#define tini_noclone __attribute__((noclone))
#define tini_called_by_assembly __attribute__((used, externally_visible, noinline))

namespace tiniscript {

inline uint8_t flash_byte(const uint8_t* address) { return pgm_read_byte(address); }
inline uint16_t flash_word(const uint16_t* address) { return pgm_read_word(address); }
inline int32_t flash_long(const uint8_t* address) {
  return static_cast<int32_t>(pgm_read_dword(address));
}

// Divides a number by ten. Returns the remainder. In `reader_avr.S`: the compiler's own division takes
// a divisor of 32 bits.
inline uint8_t cut_digit(uint32_t* number) {
  register uint32_t rest asm("r18") = *number;
  register uint8_t digit asm("r24");
  asm("%~call tiniscript_cut_digit" : "+r"(rest), "=r"(digit) : : "r25");
  *number = rest;
  return digit;
}

template <class Type>
inline Type* near(Type* object) {
  asm("" : "+r"(object));
  return object;
}

inline void clear(void* start, uint8_t fours) {
  // The compiler's own loop clears one byte at a time or takes more registers.
  asm volatile(
      "1: st %a0+, __zero_reg__\n\tst %a0+, __zero_reg__\n\t"
      "st %a0+, __zero_reg__\n\tst %a0+, __zero_reg__\n\t"
      "dec %1\n\tbrne 1b"
      : "+e"(start), "+r"(fours)
      :
      : "memory");
}

constexpr uint16_t kFlagsAt = 0x3e;        // GPIOR0
constexpr uint16_t kDueSavesAt = 0x4a;     // GPIOR1
constexpr uint16_t kCurrentSaveAt = 0x4b;  // GPIOR2

tini_always_inline volatile uint8_t& all_flags() {
  return *reinterpret_cast<volatile uint8_t*>(kFlagsAt);
}

template <uint16_t kAt>
class QuickByte {
 public:
  tini_always_inline operator uint8_t() const {
    return *reinterpret_cast<uint8_t*>(kAt);
  }
  tini_always_inline void operator=(uint8_t value) {
    *reinterpret_cast<uint8_t*>(kAt) = value;
  }
};

inline void begin_flags() {
  all_flags() = 0;
  QuickByte<kDueSavesAt>() = 0;
  QuickByte<kCurrentSaveAt>() = 0;
}

template <uint8_t kBit>
class FlagAt {
 public:
  tini_always_inline operator bool() const {
    return (all_flags() & kMask) != 0;
  }
  tini_always_inline void operator=(bool is_set) {
    if (is_set) {
      all_flags() |= kMask;
    } else {
      all_flags() &= static_cast<uint8_t>(~kMask);
    }
  }

 private:
  static constexpr uint8_t kMask = 1 << kBit;
};

}  // namespace tiniscript
