// The ways to a robot that is reached over several at once.

#pragma once

#include <stdint.h>

#include "../vm/build.h"

namespace tiniscript {

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

// Whether anyone in a network could reach it: without a key, a client there moves nothing.
inline bool is_network(Transport transport) { return transport >= Transport::kNetwork; }

}  // namespace tiniscript
