// Implements `board_set_wifi` and `board_wifi` of `firmware/board.h`, too.
//
// One entry of NVS has all of it, so a power cut leaves the network before or the new one. The
// password leaves this file for the core's WiFi alone.

#ifdef ARDUINO_ARCH_ESP32

#include "wifi_settings.h"

#include <Arduino.h>
#include <ESPmDNS.h>
#include <WiFi.h>
#include <nvs.h>

#include "../../firmware/board.h"
#include "broker_settings.h"
#include "pins.h"
#include "radio.h"
#include "tcp_clients.h"
#include "zero_ended.h"

namespace tiniscript {

namespace {

constexpr char kNamespace[] = "tiniscript";
constexpr char kKey[] = "wifi";
constexpr uint32_t kJoinAgainMs = 15000;  // between two tries to join

// As in NVS. Texts end with a 0.
struct Settings {
  WifiMode mode;
  char network[kNetworkBytes + 1];
  char password[kPasswordBytes + 1];
};

Settings kept;     // written by the main loop, in a critical section
Settings wanted;   // the main loop's: what has come so far
uint32_t changes;  // of `kept`

uint8_t state;     // a WifiState; these two are written by the network's task
uint32_t address;  // its bytes in their order

// The network's task.
uint32_t seen_changes;
uint32_t tried_ms;
bool is_announced;
Settings used;

void set_state(WifiState found) {
  __atomic_store_n(&state, static_cast<uint8_t>(found), __ATOMIC_RELAXED);
}

void clear(Settings* settings) { __builtin_memset(settings, 0, sizeof *settings); }

bool is_sound(const Settings& settings) {
  return settings.mode <= WifiMode::kAccessPoint && settings.network[kNetworkBytes] == 0 &&
         settings.password[kPasswordBytes] == 0;
}

void use(const Settings& settings) {
  {
    const CriticalSection critical;
    kept = settings;
  }
  __atomic_store_n(&changes, changes + 1, __ATOMIC_RELEASE);  // it has one writer
}

Answer keep(const Settings& settings) {
  nvs_handle_t handle;
  const bool is_kept = nvs_open(kNamespace, NVS_READWRITE, &handle) == ESP_OK &&
                       nvs_set_blob(handle, kKey, &settings, sizeof settings) == ESP_OK &&
                       nvs_commit(handle) == ESP_OK;
  if (!is_kept) return Answer::kNotKept;
  use(settings);
  return Answer::kOk;
}

Answer set(WifiMode mode) {
  if (wanted.network[0] == 0 || length_of(wanted.password) < kLeastPassword) {
    return Answer::kBadValue;
  }
  wanted.mode = mode;
  const Answer found = keep(wanted);
  if (found == Answer::kOk) clear(&wanted);
  return found;
}

void leave() {
  if (is_announced) MDNS.end();
  is_announced = false;
  WiFi.disconnect(true);
  WiFi.softAPdisconnect(true);
  WiFi.mode(WIFI_OFF);
  set_state(WifiState::kOff);
  __atomic_store_n(&address, 0U, __ATOMIC_RELAXED);
}

void begin() {
  {
    const CriticalSection critical;
    used = kept;
  }
  leave();
  WiFi.persistent(false);  // the core would keep the password a second time
  if (used.mode == WifiMode::kOff) return;
  WiFi.setHostname(radio_name().host);
  set_state(WifiState::kSearching);
  tried_ms = static_cast<uint32_t>(millis());
  if (used.mode == WifiMode::kAccessPoint) {
    WiFi.mode(WIFI_AP);
    WiFi.softAP(used.network, used.password);
  } else {
    WiFi.mode(WIFI_STA);
    WiFi.setSleep(false);  // a stop would wait for the next beacon
    WiFi.begin(used.network, used.password);
  }
}

void announce() {
  if (is_announced) return;
  is_announced = MDNS.begin(radio_name().host);
  if (!is_announced) return;
  MDNS.setInstanceName(radio_name().name);
  MDNS.addService("tiniscript", "tcp", kNetworkPort);
}

void note_address(const IPAddress& found) {
  uint32_t bytes = 0;
  for (int k = 0; k < 4; k++) bytes |= uint32_t{found[k]} << (8 * k);
  __atomic_store_n(&address, bytes, __ATOMIC_RELAXED);
  set_state(WifiState::kReady);
}

}  // namespace

void wifi_load() {
  Settings found;
  size_t length = sizeof found;
  nvs_handle_t handle;
  const bool is_there = nvs_open(kNamespace, NVS_READWRITE, &handle) == ESP_OK &&
                        nvs_get_blob(handle, kKey, &found, &length) == ESP_OK &&
                        length == sizeof found && is_sound(found);
  if (is_there) use(found);
}

bool wifi_turn() {
  const uint32_t now = __atomic_load_n(&changes, __ATOMIC_ACQUIRE);
  if (now != seen_changes) {
    seen_changes = now;
    begin();
  }
  if (used.mode == WifiMode::kOff) return false;
  if (used.mode == WifiMode::kAccessPoint) {
    announce();
    note_address(WiFi.softAPIP());
    return true;
  }
  const wl_status_t status = WiFi.status();
  if (status == WL_CONNECTED) {
    announce();
    note_address(WiFi.localIP());
    return true;
  }
  __atomic_store_n(&address, 0U, __ATOMIC_RELAXED);
  set_state(status == WL_CONNECT_FAILED ? WifiState::kRefused : WifiState::kSearching);
  const uint32_t now_ms = static_cast<uint32_t>(millis());
  if (now_ms - tried_ms >= kJoinAgainMs) {
    tried_ms = now_ms;
    WiFi.begin(used.network, used.password);
  }
  return false;
}

WifiReport board_wifi(WifiStep step) {
  if (step > WifiStep::kForget) return broker_report();
  WifiReport report = {};
  report.mode = kept.mode;
  report.state = static_cast<WifiState>(__atomic_load_n(&state, __ATOMIC_RELAXED));
  const uint32_t found = __atomic_load_n(&address, __ATOMIC_RELAXED);
  __builtin_memcpy(report.address, &found, sizeof report.address);
  report.network_bytes = static_cast<uint8_t>(length_of(kept.network));
  __builtin_memcpy(report.network, kept.network, report.network_bytes);
  return report;
}

Answer board_set_wifi(WifiStep step, const uint8_t* text, uint8_t length) {
  switch (step) {
    case WifiStep::kTell:
      break;
    case WifiStep::kNetwork:
      clear(&wanted);
      if (length == 0 || !append(wanted.network, kNetworkBytes, text, length)) {
        return Answer::kBadValue;
      }
      break;
    case WifiStep::kPassword:
      if (!append(wanted.password, kPasswordBytes, text, length)) return Answer::kBadValue;
      break;
    case WifiStep::kJoin:
      return set(WifiMode::kStation);
    case WifiStep::kHost:
      return set(WifiMode::kAccessPoint);
    case WifiStep::kForget: {
      clear(&wanted);
      const Answer found = broker_forget();
      return found == Answer::kOk ? keep(wanted) : found;
    }
    case WifiStep::kBroker:
    case WifiStep::kBrokerUser:
    case WifiStep::kBrokerPassword:
    case WifiStep::kUseBroker:
    case WifiStep::kTellBroker:
      return broker_set(step, text, length);
  }
  return Answer::kOk;
}

}  // namespace tiniscript

#endif  // ARDUINO_ARCH_ESP32
