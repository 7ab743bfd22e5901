// The address of the robot's MQTT broker, how the robot signs in there, and whom it trusts: kept in
// NVS.
//
// The main loop sets it; the task of the broker uses it.

#pragma once

#include <stddef.h>
#include <stdint.h>

#include "../../link/messages.h"
#include "../../link/port.h"

namespace tiniscript {

// The layout in NVS. Texts end with a 0; without a class there is no broker. With a date, there is
// TLS.
struct BrokerSettings {
  uint8_t address[4];  // where the broker was when a computer looked
  uint16_t port;
  char group[kClassBytes + 1];      // the class
  char name[kBrokerNameBytes + 1];  // of the broker's computer; empty: the address alone
  char user[kNetworkBytes + 1];
  char password[kPasswordBytes + 1];
  uint32_t date;         // as 20261121: when a computer said so
  uint16_t trust_bytes;  // of a certificate in DER
  uint8_t trust[kTrustBytes];

  bool is_set() const { return group[0] != 0; }
  bool is_tls() const { return date != 0; }
  size_t kept_bytes() const { return offsetof(BrokerSettings, trust) + trust_bytes; }
  bool is_sound() const;
};

// The main loop's. `broker_load` reads the data of NVS once.
void broker_load();
bool broker_is_set();
WifiReport broker_report();
Answer broker_set(WifiStep step, const uint8_t* text, uint8_t length);
Answer broker_forget();

// The main loop's: whether there was memory for the broker's task.
void broker_note_memory(bool has_memory);

// The broker's task: whether the settings have changed since the last call; then they are in
// `*broker_settings`.
bool broker_take_change(BrokerSettings* broker_settings);

// The broker's task says whether the robot is connected, or why not.
void broker_note(WifiState wifi_state);

}  // namespace tiniscript
