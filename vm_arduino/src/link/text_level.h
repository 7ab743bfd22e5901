// At which level this robot reads text, as `robots/text_levels.py` numbers them.

#pragma once

#include "../vm/build.h"
#include "messages.h"

namespace tiniscript {

#ifdef tiniscript_without_text
constexpr TextLevel kRobotTextLevel = TextLevel::kNone;
#elif defined(__AVR_ATmega2560__) || defined(tiniscript_like_mega)
constexpr TextLevel kRobotTextLevel = TextLevel::kMega;
#elif defined(ARDUINO_ARCH_ESP32) || defined(tiniscript_like_esp32)
constexpr TextLevel kRobotTextLevel = TextLevel::kEsp32;
#else
constexpr TextLevel kRobotTextLevel = TextLevel::kUno;
#endif

}  // namespace tiniscript
