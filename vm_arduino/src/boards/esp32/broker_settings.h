// Where the robot's MQTT broker is, and how the robot signs in there: kept in NVS.
//
// The main loop sets it; the task of the network uses it. The address is one of numbers: a name
// would have the task wait for its resolution, and a stop with it.

#ifndef TINISCRIPT_ESP32_BROKER_SETTINGS_H_
#define TINISCRIPT_ESP32_BROKER_SETTINGS_H_

#include <stdint.h>

#include "../../link/messages.h"
#include "../../link/port.h"

namespace tiniscript {

// As in NVS. Texts end with a 0; without a class there is no broker.
struct BrokerSettings {
  uint8_t address[4];
  uint16_t port;
  char group[kClassBytes + 1];  // the class
  char user[kNetworkBytes + 1];
  char password[kPasswordBytes + 1];

  bool is_set() const { return group[0] != 0; }
};

// The main loop's. `broker_load` reads once what NVS has.
void broker_load();
WifiReport broker_report();
Answer broker_set(WifiStep step, const uint8_t* text, uint8_t length);
Answer broker_forget();

// The network's task: whether the settings have changed since the last call; then they are in
// `*found`.
bool broker_changed(BrokerSettings* found);

// The network's task says whether the robot is connected.
void broker_note(WifiState found);

}  // namespace tiniscript

#endif  // TINISCRIPT_ESP32_BROKER_SETTINGS_H_
