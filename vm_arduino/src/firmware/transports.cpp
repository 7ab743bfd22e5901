// A robot that is reached over several transports: their bytes, the end of a connection, and the
// robot's radio names.

#include "../vm/build.h"
#include "../vm/small.h"
#include "firmware.h"
#include "persistence.h"
#include "run.h"
#include "state.h"

#ifdef tiniscript_transports

namespace tiniscript {

namespace {

bool is_awaited[kTransports];  // a stop whose bytes are still to come has a mark in the receiver

}  // namespace

void begin_link(uint8_t epoch) { link.begin(epoch); }

void firmware_on_rx_byte(Transport transport, uint8_t byte, uint16_t time_ms) {
  if (link.receiver(transport).put(byte, time_ms)) board_stop();
}

bool firmware_next_tx_byte(Transport transport, uint8_t* byte) {
  return link.next_tx_byte(transport, byte);
}

bool firmware_has_room(Transport transport) { return link.receiver(transport).has_room(); }

// It counts as a mark until its bytes are there.
void firmware_await_stop(Transport transport, bool is_there) {
  bool* const is_marked = &is_awaited[static_cast<uint8_t>(transport)];
  Receiver& receiver = link.receiver(transport);
  if (is_there) port_end();
  if (is_there && !*is_marked) receiver.put_mark();
  if (!is_there && *is_marked) receiver.take_mark();
  *is_marked = is_there;
}

Answer port_may_drive(uint8_t type) { return link.may_drive(type); }

bool port_may_press() { return link.may_press(); }

bool firmware_has_key(Transport transport) { return link.has_key(transport); }

void firmware_on_client_left(Transport transport) {
  is_awaited[static_cast<uint8_t>(transport)] = false;  // the mark goes with the waiting bytes
  if (!link.end_session(transport) || !is_running()) return;
  end_run(State::kStopped);
  link.on_stopped(Cause::kCable);
}

WifiReport port_wifi_report(WifiStep step) { return board_wifi(step); }

Answer port_set_wifi(WifiStep step, const uint8_t* text, uint8_t length) {
  const bool is_kept =
      (step >= WifiStep::kJoin && step <= WifiStep::kForget) || step == WifiStep::kUseBroker;
  if (is_kept && is_driving()) return Answer::kSaving;
  return board_set_wifi(step, text, length);
}

void firmware_wifi_rests(bool is_resting) {
  uint8_t& features = port_identity().more_features;
  features =
      static_cast<uint8_t>(is_resting ? features | kMoreWifiRests : features & ~kMoreWifiRests);
}

bool firmware_radio_name(RadioName* name) {
  if (!has_booted()) return false;
  const uint32_t id = port_identity().id;
  const DeviceInfo& device_info = port_device_info();
  static const char kStart[] = "tini-";
  static const char kDigits[] = "0123456789abcdef";
  *name = RadioName();
  uint8_t length = 0;
  for (; kStart[length] != 0; length++) name->host[length] = kStart[length];
  for (uint8_t shift = 16; shift > 0; length++) {
    shift = static_cast<uint8_t>(shift - 4);
    name->host[length] = kDigits[id >> shift & 0xf];
  }
  for (uint8_t k = 0; k < sizeof name->id - 1; k++) {
    name->id[k] = kDigits[id >> (28 - 4 * k) & 0xf];
  }
  if (device_info.name_length == 0) {
    copy_bytes(name->host, reinterpret_cast<uint8_t*>(name->name), sizeof name->host);
  } else {
    copy_bytes(device_info.name, reinterpret_cast<uint8_t*>(name->name), device_info.name_length);
  }
  return true;
}

}  // namespace tiniscript

#endif
