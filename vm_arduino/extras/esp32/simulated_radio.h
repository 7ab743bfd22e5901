// The radios of a simulated chip: what `core/` declares of Bluetooth and WiFi, and who is on the
// other side.
//
// A client of Bluetooth LE or of a serial port is what a test does; one in a network is a real one,
// on 127.0.0.1. Its functions may be called from any thread.

#pragma once

#include <stdint.h>

#include <string>
#include <vector>

// Bluetooth LE. A client has a number, which is another one's when it has gone; 0xffff: no robot was
// found. Who is sent away has gone after the call in which that was asked.
constexpr uint16_t kNoClient = 0xffff;
uint16_t low_energy_connect();
void low_energy_disconnect(uint16_t client);
bool low_energy_is_there(uint16_t client);
void low_energy_agree(uint16_t client, uint16_t mtu);
void low_energy_subscribe(uint16_t client, bool has_subscribed);
void low_energy_congest(bool is_on);  // its stack takes no notification meanwhile
void low_energy_write(uint16_t client, const std::string& bytes);
std::vector<std::string> low_energy_notifications(uint16_t client);  // since the last call

// Bluetooth with a serial port. Whoever comes while there is a client is sent away by the core.
// One that is stuck takes nothing: `write` of the core waits then.
void serial_port_connect(bool is_there);
bool serial_port_has_client();
void serial_port_write(const std::string& bytes);
void serial_port_stick(bool is_stuck);
std::string serial_port_output();  // since the last call

// WiFi: a network in reach with its password; none if `name` is empty.
void network_in_reach(const std::string& name, const std::string& password);
void network_refuses(uint8_t reason);          // a wrong password
void network_takes(uint16_t byte_limit);       // of what is sent at once; 0: nothing, for now
void network_expires();                        // it sends the robot away: its authentication is over
void network_leases_after(uint32_t lease_ms);  // until whoever has joined has an address
void network_searches(uint32_t search_ms);     // until a network is found, or none
void radio_logs();                             // a library of ESP-IDF tells an error, on UART 0
// Lets the network know a name of a computer; none but "localhost" is known before.
// Looking it up takes `wait_ms`.
void network_name(const std::string& name, const std::string& address, uint16_t wait_ms);
uint16_t network_port();  // on 127.0.0.1; 0: nothing listens

// What the firmware has asked of the radios, for a test to compare.
struct RadioSettings {
  std::string advertised;  // the name in Bluetooth LE
  std::string serial_port;
  std::string host;
  std::string instance;
  std::string service;
  std::string network;  // that it joins or is
  std::string password;
  bool is_access_point;
  uint32_t joins;    // how many times it, or the core for it, has tried
  uint32_t sockets;  // that are open
};
RadioSettings radio_settings();
