// The owners of the flags that much of the firmware checks.

#pragma once

#include <stdint.h>

#include "cpu.h"
#include "layout_avr.h"

namespace tiniscript {

enum class Bit : uint8_t {
  kEvent = tini_event_bit,
  kReleased,  // boards/motors.cpp
  kSpaced,    // boards/ultrasonic.cpp
  kWhole,     // firmware/program.cpp
  kLow,       // firmware/persistence.cpp
  kPrepared,  // firmware/run.cpp
  kMayStart,  // firmware/run.cpp
  kStartDue,  // firmware/run.cpp
};

template <Bit kBit>
using Flag = FlagAt<static_cast<uint8_t>(kBit)>;

}  // namespace tiniscript
