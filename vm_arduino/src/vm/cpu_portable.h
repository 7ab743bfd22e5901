// Any CPU but that of an AVR, which needs nothing special. `cpu.h` includes this.

#pragma once

#include <stddef.h>
#include <stdint.h>

#define tini_progmem
#define tini_noinline
#define tini_noclone
#define tini_called_by_assembly

namespace tiniscript {

inline uint8_t flash_byte(const uint8_t* address) { return *address; }
inline uint16_t flash_word(const uint16_t* address) { return *address; }
inline int32_t flash_long(const uint8_t* address) {
  uint32_t value = 0;
  for (uint8_t k = 4; k != 0; k--) value = value << 8 | address[k - 1];
  return static_cast<int32_t>(value);
}

// Divides a number by ten. Returns the remainder.
inline uint8_t cut_digit(uint32_t* number) {
  const uint8_t digit = static_cast<uint8_t>(*number % 10);
  *number /= 10;
  return digit;
}

template <class Type>
inline Type* near(Type* object) {
  return object;
}

inline void clear(void* start, uint8_t fours) { __builtin_memset(start, 0, fours * size_t{4}); }

constexpr uint8_t kDueSavesAt = 0;
constexpr uint8_t kCurrentSaveAt = 1;

template <uint8_t>
class QuickByte {
 public:
  operator uint8_t() const { return value_; }
  void operator=(uint8_t value) { value_ = value; }

 private:
  uint8_t value_;
};

template <uint8_t>
class FlagAt {
 public:
  operator bool() const { return is_set_; }
  void operator=(bool is_set) { is_set_ = is_set; }

 private:
  bool is_set_;
};

}  // namespace tiniscript
