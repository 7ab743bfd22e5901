// At which level this robot reads text, as `robots/text_levels.py` numbers them.

#pragma once

#include "../vm/build.h"
#include "messages.h"

namespace tiniscript {

constexpr TextLevel kRobotTextLevel = !kHasText                         ? TextLevel::kNone
                                      : kRobotSize == RobotSize::kMega  ? TextLevel::kMega
                                      : kRobotSize == RobotSize::kEsp32 ? TextLevel::kEsp32
                                                                        : TextLevel::kUno;

}  // namespace tiniscript
