// One entry of NVS has all of it, as with WiFi. The password leaves this file for `broker.cpp`
// alone.

#ifdef ARDUINO_ARCH_ESP32

#include "broker_settings.h"

#include "kept_settings.h"
#include "zero_ended.h"

namespace tiniscript {

namespace {

constexpr uint8_t kDateBytes = 4;

KeptSettings<BrokerSettings> kept("broker");
BrokerSettings wanted;  // the main loop's: received so far
bool lacks_memory;      // the main loop's: for the broker's task
uint8_t state;          // a WifiState, written by the broker's task

void clear() { __builtin_memset(&wanted, 0, sizeof wanted); }

// A class is a part of topics: it has no special characters for them.
bool is_class(const char* name) {
  for (; *name != 0; name++) {
    const bool is_letter = *name >= 'a' && *name <= 'z';
    const bool is_digit = *name >= '0' && *name <= '9';
    if (!is_letter && !is_digit && *name != '-') return false;
  }
  return true;
}

// The address, the port and the class.
bool begin(const uint8_t* text, uint8_t length) {
  clear();
  if (length == 0) return true;
  if (length <= kBrokerPlaceBytes) return false;
  __builtin_memcpy(wanted.address, text, sizeof wanted.address);
  wanted.port = static_cast<uint16_t>(text[4] | text[5] << 8);
  return append(wanted.group, kClassBytes, text + kBrokerPlaceBytes,
                static_cast<uint8_t>(length - kBrokerPlaceBytes)) &&
         is_class(wanted.group) && wanted.port != 0;
}

bool take_date(const uint8_t* text, uint8_t length) {
  if (length != kDateBytes) return false;
  wanted.date = 0;
  for (uint8_t k = kDateBytes; k > 0; k--) wanted.date = wanted.date << 8 | text[k - 1];
  return wanted.date != 0;
}

bool take_trust(const uint8_t* text, uint8_t length) {
  if (length > kTrustBytes - wanted.trust_bytes) return false;
  __builtin_memcpy(wanted.trust + wanted.trust_bytes, text, length);
  wanted.trust_bytes = static_cast<uint16_t>(wanted.trust_bytes + length);
  return true;
}

bool take(WifiStep step, const uint8_t* text, uint8_t length) {
  switch (step) {
    case WifiStep::kBroker:
      return begin(text, length);
    case WifiStep::kBrokerName:
      return append(wanted.name, kBrokerNameBytes, text, length);
    case WifiStep::kBrokerUser:
      return append(wanted.user, kNetworkBytes, text, length);
    case WifiStep::kBrokerPassword:
      return append(wanted.password, kPasswordBytes, text, length);
    case WifiStep::kBrokerTls:
      return take_date(text, length);
    case WifiStep::kBrokerTrust:
      return take_trust(text, length);
    case WifiStep::kUseBroker:
      return wanted.is_sound();
    default:
      return true;
  }
}

// While its task has not taken the settings, it speaks of those before: it may be looking up a name.
WifiState state_now() {
  if (!kept.now().is_set()) return WifiState::kOff;
  if (lacks_memory) return WifiState::kNoTls;
  if (kept.is_new()) return WifiState::kSearching;
  return static_cast<WifiState>(__atomic_load_n(&state, __ATOMIC_RELAXED));
}

}  // namespace

// TLS without a certificate that is trusted would be a connection to anybody, and without a name
// to any computer that the certificate's owner knows.
bool BrokerSettings::is_sound() const {
  const bool has_ends = group[kClassBytes] == 0 && name[kBrokerNameBytes] == 0 &&
                        user[kNetworkBytes] == 0 && password[kPasswordBytes] == 0;
  const bool has_trust = trust_bytes != 0 && name[0] != 0;
  return has_ends && is_class(group) && trust_bytes <= kTrustBytes &&
         (is_tls() ? has_trust : trust_bytes == 0);
}

void broker_load() { kept.load(); }

bool broker_is_set() { return kept.now().is_set(); }

WifiReport broker_report() {
  const BrokerSettings& now = kept.now();
  WifiReport report = {};
  report.mode = now.is_set() ? WifiMode::kStation : WifiMode::kOff;
  report.state = state_now();
  __builtin_memcpy(report.address, now.address, sizeof report.address);
  report.network_bytes = static_cast<uint8_t>(length_of(now.group));
  __builtin_memcpy(report.network, now.group, report.network_bytes);
  return report;
}

Answer broker_set(WifiStep step, const uint8_t* text, uint8_t length) {
  if (!take(step, text, length)) {
    clear();
    return Answer::kBadValue;
  }
  if (step != WifiStep::kUseBroker) return Answer::kOk;
  const Answer answer = kept.keep(wanted);
  if (answer == Answer::kOk) clear();
  return answer;
}

Answer broker_forget() {
  clear();
  return broker_is_set() ? kept.keep(wanted) : Answer::kOk;
}

void broker_note_memory(bool has_memory) { lacks_memory = !has_memory; }

// Its remarks on earlier ones end when the main loop learns that it has taken these.
bool broker_changed(BrokerSettings* broker_settings) {
  if (!kept.is_new()) return false;
  broker_note(WifiState::kSearching);
  return kept.changed(broker_settings);
}

void broker_note(WifiState wifi_state) {
  __atomic_store_n(&state, static_cast<uint8_t>(wifi_state), __ATOMIC_RELAXED);
}

}  // namespace tiniscript

#endif  // ARDUINO_ARCH_ESP32
