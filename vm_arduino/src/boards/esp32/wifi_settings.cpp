// Implements `board_set_wifi` and `board_wifi` of `firmware/board.h`, too.
//
// One entry of NVS has all of it, so a power cut leaves the network before or the new one. The
// password leaves this file for the core's WiFi alone.

#ifdef ARDUINO_ARCH_ESP32

#include "wifi_settings.h"

#include <Arduino.h>
#include <ESPmDNS.h>
#include <WiFi.h>

#include "../../firmware/board.h"
#include "broker_settings.h"
#include "kept_settings.h"
#include "radio.h"
#include "tcp_clients.h"
#include "zero_ended.h"

namespace tiniscript {

namespace {

constexpr uint8_t kReady = static_cast<uint8_t>(WifiState::kReady);
constexpr uint32_t kJoinAgainMs = 15000;  // between two tries to join

// As in NVS. Texts end with a 0.
struct Settings {
  WifiMode mode;
  char network[kNetworkBytes + 1];
  char password[kPasswordBytes + 1];

  size_t kept_bytes() const { return sizeof *this; }
  bool is_sound() const {
    return mode <= WifiMode::kAccessPoint && network[kNetworkBytes] == 0 &&
           password[kPasswordBytes] == 0;
  }
};

KeptSettings<Settings> kept("wifi");
Settings wanted;  // the main loop's: what has come so far

uint8_t state;     // a WifiState; these two are written by the network's task
uint32_t address;  // its bytes in their order

// The network's task.
uint32_t tried_ms;
bool is_announced;
Settings used;

void set_state(WifiState found) {
  __atomic_store_n(&state, static_cast<uint8_t>(found), __ATOMIC_RELAXED);
}

void clear(Settings* settings) { __builtin_memset(settings, 0, sizeof *settings); }

Answer set(WifiMode mode) {
  if (wanted.network[0] == 0 || length_of(wanted.password) < kLeastPassword) {
    return Answer::kBadValue;
  }
  wanted.mode = mode;
  const Answer found = kept.keep(wanted);
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

void wifi_load() { kept.load(); }

bool wifi_is_there() { return __atomic_load_n(&state, __ATOMIC_RELAXED) == kReady; }

bool wifi_turn() {
  if (kept.changed(&used)) begin();
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
  report.mode = kept.now().mode;
  report.state = static_cast<WifiState>(__atomic_load_n(&state, __ATOMIC_RELAXED));
  const uint32_t found = __atomic_load_n(&address, __ATOMIC_RELAXED);
  __builtin_memcpy(report.address, &found, sizeof report.address);
  report.network_bytes = static_cast<uint8_t>(length_of(kept.now().network));
  __builtin_memcpy(report.network, kept.now().network, report.network_bytes);
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
      return found == Answer::kOk ? kept.keep(wanted) : found;
    }
    case WifiStep::kBroker:
    case WifiStep::kBrokerUser:
    case WifiStep::kBrokerPassword:
    case WifiStep::kUseBroker:
    case WifiStep::kTellBroker:
    case WifiStep::kBrokerName:
    case WifiStep::kBrokerTls:
    case WifiStep::kBrokerTrust:
      return broker_set(step, text, length);
  }
  return Answer::kOk;
}

}  // namespace tiniscript

#endif  // ARDUINO_ARCH_ESP32
