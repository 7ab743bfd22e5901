// TCP: two clients at once.

#pragma once

#include <stdint.h>

namespace tiniscript {

constexpr uint16_t kNetworkPort = 8473;

}  // namespace tiniscript
