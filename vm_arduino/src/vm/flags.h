// Flags and bytes that much of the firmware asks: on the AVR GPIOR0 to GPIOR2.
//
// There a bit is tested, set and cleared by one instruction each, which no interrupt can split, and
// a byte takes half the flash that one in RAM does. Elsewhere they are variables. A restart by a
// jump leaves them: `begin_flags` makes them 0.

#pragma once

#include <stdint.h>

#include "execute_avr.h"
#include "small.h"

namespace tiniscript {

// Who has which bit.
enum class Bit : uint8_t {
  kAttention = tini_attention_bit,
  kReleased,  // boards/motors.cpp
  kSpaced,    // boards/ultrasonic.cpp
  kWhole,     // firmware/program.cpp
  kLow,       // firmware/persistence.cpp
  kPrepared,  // firmware/run.cpp
  kMayStart,  // firmware/run.cpp
  kStartDue,  // firmware/run.cpp
};

#ifdef __AVR__

constexpr uint16_t kFlagsAt = 0x3e;    // GPIOR0
constexpr uint16_t kToKeepAt = 0x4a;   // GPIOR1
constexpr uint16_t kKeepingAt = 0x4b;  // GPIOR2

tini_always_inline volatile uint8_t& all_flags() {
  return *reinterpret_cast<volatile uint8_t*>(kFlagsAt);
}

// A variable of firmware/persistence.cpp.
template <uint16_t kAt>
class QuickByte {
 public:
  tini_always_inline operator uint8_t() const { return *reinterpret_cast<uint8_t*>(kAt); }
  tini_always_inline void operator=(uint8_t value) { *reinterpret_cast<uint8_t*>(kAt) = value; }
};

inline void begin_flags() {
  all_flags() = 0;
  QuickByte<kToKeepAt>() = 0;
  QuickByte<kKeepingAt>() = 0;
}

template <Bit kBit>
class Flag {
 public:
  tini_always_inline operator bool() const { return (all_flags() & kMask) != 0; }
  tini_always_inline void operator=(bool is_set) {
    if (is_set) {
      all_flags() |= kMask;
    } else {
      all_flags() &= static_cast<uint8_t>(~kMask);
    }
  }

 private:
  static constexpr uint8_t kMask = 1 << static_cast<uint8_t>(kBit);
};

#else

constexpr uint8_t kToKeepAt = 0;
constexpr uint8_t kKeepingAt = 1;

template <uint8_t>
class QuickByte {
 public:
  operator uint8_t() const { return value_; }
  void operator=(uint8_t value) { value_ = value; }

 private:
  uint8_t value_;
};

template <Bit>
class Flag {
 public:
  operator bool() const { return is_set_; }
  void operator=(bool is_set) { is_set_ = is_set; }

 private:
  bool is_set_;
};

#endif

}  // namespace tiniscript
