// Implements `board_set_wifi` and `board_wifi` of `firmware/board.h`, too.
//
// One entry of NVS has all of it, so a power cut leaves the network before or the new one. The
// password leaves this file for the core's WiFi alone.

#ifdef ARDUINO_ARCH_ESP32

#include "wifi_settings.h"

#include <Arduino.h>
#include <ESPmDNS.h>
#include <WiFi.h>
#include <esp_attr.h>

#include "../../firmware/board.h"
#include "broker_settings.h"
#include "kept_settings.h"
#include "radio.h"
#include "tcp_clients.h"
#include "watchdog.h"
#include "zero_ended.h"

namespace tiniscript {

namespace {

constexpr uint8_t kReady = static_cast<uint8_t>(WifiState::kReady);
constexpr uint32_t kJoinAgainMs = 15000;  // between two tries to join
constexpr uint32_t kYoungMs = 20000;      // a restart so soon after WiFi began counts
constexpr uint8_t kMaxRestarts = 3;      // in a row: then WiFi rests
constexpr uint8_t kRestsFlag = 0x80;      // flag of a mode

// The layout in NVS. Texts end with a 0.
struct Settings {
  uint8_t kept_mode;
  char network[kNetworkBytes + 1];
  char password[kPasswordBytes + 1];

  WifiMode mode() const { return static_cast<WifiMode>(kept_mode & ~kRestsFlag); }
  bool rests() const { return (kept_mode & kRestsFlag) != 0; }
  size_t kept_bytes() const { return sizeof *this; }
  bool is_sound() const {
    return mode() <= WifiMode::kAccessPoint && network[kNetworkBytes] == 0 &&
           password[kPasswordBytes] == 0;
  }
};

// Why the network has sent the robot away: only these say that the password is another one. The
// core tells them as "disconnected".
constexpr uint8_t kRefusals[] = {15, 202, 203, 204};  // 4-way handshake, authentication, association

// The core's task writes these two.
uint8_t disconnect_reason;  // the last one; 0 since a network was set, or has let the robot in
bool is_associated;         // with the network; an address may still have to come

void on_connected(arduino_event_t*) {
  __atomic_store_n(&is_associated, true, __ATOMIC_RELAXED);
  __atomic_store_n(&disconnect_reason, static_cast<uint8_t>(0), __ATOMIC_RELAXED);
}

void on_disconnected(arduino_event_t* event) {
  __atomic_store_n(&is_associated, false, __ATOMIC_RELAXED);
  __atomic_store_n(&disconnect_reason,
                   static_cast<uint8_t>(event->event_info.wifi_sta_disconnected.reason),
                   __ATOMIC_RELAXED);
}

bool is_refused() {
  const uint8_t last_reason = __atomic_load_n(&disconnect_reason, __ATOMIC_RELAXED);
  for (uint8_t refusal : kRefusals) {
    if (last_reason == refusal) return true;
  }
  return false;
}

// Survives a restart, and has any value after power-on: whether WiFi has begun lately, and how many
// of the starts before have ended in a restart soon after that.
constexpr uint32_t kRecordMagic = 0x5a3c1d00;
constexpr uint32_t kYoungFlag = 0x80;
constexpr uint32_t kRestartMask = 0x7f;
RTC_NOINIT_ATTR uint32_t restart_record;  // changed in a critical section

KeptSettings<Settings> kept_settings("wifi");
Settings new_settings;  // the main loop's: received so far

uint8_t state;     // a WifiState; these two are written by the network's task
uint32_t address;  // its bytes in their order

// The network's task.
uint32_t last_try_ms;
uint32_t start_ms;
bool is_young;
bool is_announced;
bool is_host;  // its access point is there
Settings used_settings;

void set_state(WifiState wifi_state) {
  __atomic_store_n(&state, static_cast<uint8_t>(wifi_state), __ATOMIC_RELAXED);
}

void clear(Settings* settings) { __builtin_memset(settings, 0, sizeof *settings); }

// The network's task.
void set_young(bool is_now_young, uint32_t kept_bits) {
  const CriticalSection critical;
  restart_record = (restart_record & kept_bits) | kRecordMagic | (is_now_young ? kYoungFlag : 0);
  is_young = is_now_young;
}

// The main loop's, after a reset: counts it, and returns whether there were too many.
bool count_restart() {
  const Reset cause = watchdog_reset_cause();
  const bool is_failure = cause == Reset::kBrownOut || cause == Reset::kWatchdog;
  const bool is_known = (restart_record & ~(kYoungFlag | kRestartMask)) == kRecordMagic;
  uint32_t restarts = is_known ? restart_record & kRestartMask : 0;
  if (is_known && is_failure && (restart_record & kYoungFlag) != 0) restarts++;
  const bool is_too_often = restarts >= kMaxRestarts;
  restart_record = kRecordMagic | (is_too_often ? 0 : restarts);
  return is_too_often;
}

// Has the received settings saved: a new beginning.
Answer keep() {
  const Answer answer = kept_settings.keep(new_settings);
  if (answer != Answer::kOk) return answer;
  clear(&new_settings);
  firmware_wifi_rests(false);
  const CriticalSection critical;
  restart_record &= ~kRestartMask;
  return answer;
}

Answer set(WifiMode mode) {
  if (new_settings.network[0] == 0 || length_of(new_settings.password) < kMinPassword) {
    return Answer::kBadValue;
  }
  new_settings.kept_mode = static_cast<uint8_t>(mode);
  return keep();
}

void leave() {
  if (is_announced) MDNS.end();
  is_announced = false;
  __atomic_store_n(&is_associated, false, __ATOMIC_RELAXED);
  WiFi.mode(WIFI_OFF);  // and no more: softAPdisconnect would start an access point first
  set_state(used_settings.rests() ? WifiState::kRests : WifiState::kOff);
  __atomic_store_n(&address, 0U, __ATOMIC_RELAXED);
  set_young(false, kRestartMask);
}

// There may be no memory for it in addition to Bluetooth.
void host() {
  is_host = WiFi.mode(WIFI_AP) && WiFi.softAP(used_settings.network, used_settings.password);
  if (!is_host) set_state(WifiState::kRefused);
}

// The core does not notice an authentication that has ended: its status stays, and `begin` then
// does nothing.
void join_again(wl_status_t status) {
  if (status == WL_CONNECTED) {
    WiFi.reconnect();
  } else {
    WiFi.begin(used_settings.network, used_settings.password);
  }
}

// Whether it is time for the next try, which then counts as made.
bool begin_try() {
  const uint32_t now_ms = static_cast<uint32_t>(millis());
  if (now_ms - last_try_ms < kJoinAgainMs) return false;
  last_try_ms = now_ms;
  return true;
}

void begin() {
  leave();
  if (used_settings.mode() == WifiMode::kOff || used_settings.rests()) return;
  WiFi.setHostname(radio_name().host);
  set_state(WifiState::kSearching);
  __atomic_store_n(&disconnect_reason, static_cast<uint8_t>(0), __ATOMIC_RELAXED);
  last_try_ms = start_ms = static_cast<uint32_t>(millis());
  set_young(true, kRestartMask);
  if (used_settings.mode() == WifiMode::kAccessPoint) {
    host();
  } else {
    WiFi.mode(WIFI_STA);
    // Modem sleep stays on: where Bluetooth is on, too, turning it off ends the chip.
    WiFi.begin(used_settings.network, used_settings.password);
  }
}

void announce() {
  if (is_announced) return;
  is_announced = MDNS.begin(radio_name().host);
  if (!is_announced) return;
  MDNS.setInstanceName(radio_name().name);
  MDNS.addService("tiniscript", "tcp", kNetworkPort);
}

void note_address(const IPAddress& ip_address) {
  uint32_t bytes = 0;
  for (int k = 0; k < 4; k++) bytes |= uint32_t{ip_address[k]} << (8 * k);
  __atomic_store_n(&address, bytes, __ATOMIC_RELAXED);
  set_state(WifiState::kReady);
}

}  // namespace

void wifi_load() {
  WiFi.onEvent(on_connected, ARDUINO_EVENT_WIFI_STA_CONNECTED);
  WiFi.onEvent(on_disconnected, ARDUINO_EVENT_WIFI_STA_DISCONNECTED);
  WiFi.persistent(false);  // the core would keep the password a second time
  WiFi.setAutoReconnect(false);  // it would scan without a pause, despite Bluetooth: we retry
  kept_settings.load();
  Settings settings = kept_settings.current();
  const bool has_restarted_too_often = count_restart();
  if (has_restarted_too_often && settings.mode() != WifiMode::kOff) {
    settings.kept_mode |= kRestsFlag;
    if (kept_settings.keep(settings) != Answer::kOk) kept_settings.use(settings);
  }
  firmware_wifi_rests(kept_settings.current().rests());
}

bool wifi_is_there() { return __atomic_load_n(&state, __ATOMIC_RELAXED) == kReady; }

bool wifi_turn() {
  if (kept_settings.take_change(&used_settings)) begin();
  if (used_settings.mode() == WifiMode::kOff || used_settings.rests()) return false;
  if (is_young && static_cast<uint32_t>(millis()) - start_ms >= kYoungMs) set_young(false, 0);
  if (used_settings.mode() == WifiMode::kAccessPoint) {
    if (!is_host && begin_try()) host();
    if (!is_host) return false;
    announce();
    note_address(WiFi.softAPIP());
    return true;
  }
  const wl_status_t status = WiFi.status();
  const bool is_joined = __atomic_load_n(&is_associated, __ATOMIC_RELAXED);
  if (status == WL_CONNECTED && is_joined) {
    announce();
    note_address(WiFi.localIP());
    return true;
  }
  __atomic_store_n(&address, 0U, __ATOMIC_RELAXED);
  const bool is_sent_away = status == WL_CONNECT_FAILED || is_refused();
  set_state(is_sent_away ? WifiState::kRefused : WifiState::kSearching);
  if (!is_joined && begin_try()) join_again(status);
  return false;
}

WifiReport board_wifi(WifiStep step) {
  if (step > WifiStep::kForget) return broker_report();
  WifiReport report = {};
  report.mode = kept_settings.current().mode();
  report.state = static_cast<WifiState>(__atomic_load_n(&state, __ATOMIC_RELAXED));
  const uint32_t address_bytes = __atomic_load_n(&address, __ATOMIC_RELAXED);
  __builtin_memcpy(report.address, &address_bytes, sizeof report.address);
  report.network_bytes = static_cast<uint8_t>(length_of(kept_settings.current().network));
  __builtin_memcpy(report.network, kept_settings.current().network, report.network_bytes);
  return report;
}

Answer board_set_wifi(WifiStep step, const uint8_t* text, uint8_t length) {
  switch (step) {
    case WifiStep::kTell:
      break;
    case WifiStep::kNetwork:
      clear(&new_settings);
      if (length == 0 || !append(new_settings.network, kNetworkBytes, text, length)) {
        return Answer::kBadValue;
      }
      break;
    case WifiStep::kPassword:
      if (!append(new_settings.password, kPasswordBytes, text, length)) return Answer::kBadValue;
      break;
    case WifiStep::kJoin:
      return set(WifiMode::kStation);
    case WifiStep::kHost:
      return set(WifiMode::kAccessPoint);
    case WifiStep::kForget: {
      clear(&new_settings);
      const Answer answer = broker_forget();
      return answer == Answer::kOk ? keep() : answer;
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
