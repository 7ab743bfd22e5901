// One entry of NVS has all of it, as with WiFi. The password leaves this file for `broker.cpp`
// alone.

#ifdef ARDUINO_ARCH_ESP32

#include "broker_settings.h"

#include <Arduino.h>
#include <nvs.h>

#include "pins.h"
#include "zero_ended.h"

namespace tiniscript {

namespace {

constexpr char kNamespace[] = "tiniscript";
constexpr char kKey[] = "broker";

BrokerSettings kept;    // written by the main loop, in a critical section
BrokerSettings wanted;  // the main loop's: what has come so far
uint32_t changes;       // of `kept`
uint32_t seen_changes;  // the network's task
uint8_t state;          // a WifiState, written by the network's task

void clear(BrokerSettings* settings) { __builtin_memset(settings, 0, sizeof *settings); }

// A class is a part of topics: nothing in it has a meaning there.
bool is_class(const char* name) {
  for (; *name != 0; name++) {
    const bool is_letter = *name >= 'a' && *name <= 'z';
    const bool is_digit = *name >= '0' && *name <= '9';
    if (!is_letter && !is_digit && *name != '-') return false;
  }
  return true;
}

bool is_sound(const BrokerSettings& settings) {
  return settings.group[kClassBytes] == 0 && settings.user[kNetworkBytes] == 0 &&
         settings.password[kPasswordBytes] == 0 && is_class(settings.group);
}

void use(const BrokerSettings& settings) {
  {
    const CriticalSection critical;
    kept = settings;
  }
  __atomic_store_n(&changes, changes + 1, __ATOMIC_RELEASE);  // it has one writer
}

Answer keep(const BrokerSettings& settings) {
  nvs_handle_t handle;
  const bool is_kept = nvs_open(kNamespace, NVS_READWRITE, &handle) == ESP_OK &&
                       nvs_set_blob(handle, kKey, &settings, sizeof settings) == ESP_OK &&
                       nvs_commit(handle) == ESP_OK;
  if (!is_kept) return Answer::kNotKept;
  use(settings);
  return Answer::kOk;
}

// The address, the port and the class.
bool begin(const uint8_t* text, uint8_t length) {
  clear(&wanted);
  if (length == 0) return true;
  if (length <= kBrokerPlaceBytes) return false;
  __builtin_memcpy(wanted.address, text, sizeof wanted.address);
  wanted.port = static_cast<uint16_t>(text[4] | text[5] << 8);
  return append(wanted.group, kClassBytes, text + kBrokerPlaceBytes,
                static_cast<uint8_t>(length - kBrokerPlaceBytes)) &&
         is_class(wanted.group) && wanted.port != 0;
}

bool take(WifiStep step, const uint8_t* text, uint8_t length) {
  switch (step) {
    case WifiStep::kBroker:
      return begin(text, length);
    case WifiStep::kBrokerUser:
      return append(wanted.user, kNetworkBytes, text, length);
    case WifiStep::kBrokerPassword:
      return append(wanted.password, kPasswordBytes, text, length);
    default:
      return true;
  }
}

}  // namespace

void broker_load() {
  BrokerSettings found;
  size_t length = sizeof found;
  nvs_handle_t handle;
  const bool is_there = nvs_open(kNamespace, NVS_READWRITE, &handle) == ESP_OK &&
                        nvs_get_blob(handle, kKey, &found, &length) == ESP_OK &&
                        length == sizeof found && is_sound(found);
  if (is_there) use(found);
}

WifiReport broker_report() {
  WifiReport report = {};
  report.mode = kept.is_set() ? WifiMode::kStation : WifiMode::kOff;
  report.state = static_cast<WifiState>(__atomic_load_n(&state, __ATOMIC_RELAXED));
  __builtin_memcpy(report.address, kept.address, sizeof report.address);
  report.network_bytes = static_cast<uint8_t>(length_of(kept.group));
  __builtin_memcpy(report.network, kept.group, report.network_bytes);
  return report;
}

Answer broker_set(WifiStep step, const uint8_t* text, uint8_t length) {
  if (!take(step, text, length)) {
    clear(&wanted);
    return Answer::kBadValue;
  }
  if (step != WifiStep::kUseBroker) return Answer::kOk;
  const Answer found = keep(wanted);
  if (found == Answer::kOk) clear(&wanted);
  return found;
}

Answer broker_forget() {
  clear(&wanted);
  return kept.is_set() ? keep(wanted) : Answer::kOk;
}

bool broker_changed(BrokerSettings* found) {
  const uint32_t now = __atomic_load_n(&changes, __ATOMIC_ACQUIRE);
  if (now == seen_changes) return false;
  seen_changes = now;
  const CriticalSection critical;
  *found = kept;
  return true;
}

void broker_note(WifiState found) {
  __atomic_store_n(&state, static_cast<uint8_t>(found), __ATOMIC_RELAXED);
}

}  // namespace tiniscript

#endif  // ARDUINO_ARCH_ESP32
