// Whether this robot is reached over several transports at once: each has a link of its own then,
// and one of them drives (`links.h`). An ESP32 is; all others have one.

#pragma once

#include <stdint.h>

#ifdef ARDUINO_ARCH_ESP32
#define tiniscript_transports
#endif

namespace tiniscript {

#ifdef tiniscript_transports
constexpr bool kHasTransports = true;
#else
constexpr bool kHasTransports = false;
#endif

// The cable, Bluetooth with a serial port (an ESP32 alone, not its successors), Bluetooth LE, two
// connections in a network, and one client of an MQTT broker.
enum class Transport : uint8_t {
  kCable,
  kSerialPort,
  kLowEnergy,
  kNetwork,
  kSecondNetwork,
  kBroker
};

constexpr uint8_t kTransports = 6;

// Whether whoever is in a network could reach it: what needs no key there moves nothing.
inline bool is_network(Transport transport) { return transport >= Transport::kNetwork; }

}  // namespace tiniscript
