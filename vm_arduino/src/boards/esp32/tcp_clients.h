// TCP: two clients at once.

#ifndef TINISCRIPT_ESP32_TCP_CLIENTS_H_
#define TINISCRIPT_ESP32_TCP_CLIENTS_H_

#include <stdint.h>

namespace tiniscript {

constexpr uint16_t kNetworkPort = 8473;

}  // namespace tiniscript

#endif  // TINISCRIPT_ESP32_TCP_CLIENTS_H_
