// One entry of NVS has all of it, as with WiFi. The password leaves this file for `broker.cpp`
// alone.

#ifdef ARDUINO_ARCH_ESP32

#include "broker_settings.h"

#include "kept_settings.h"
#include "zero_ended.h"

namespace tiniscript {

namespace {

constexpr uint8_t kDateBytes = 4;

KeptSettings<BrokerSettings> kept_settings("broker");
BrokerSettings new_settings;  // the main loop's: received so far
bool lacks_memory;            // the main loop's: for the broker's task
uint8_t state;                // a WifiState, written by the broker's task

void clear() { __builtin_memset(&new_settings, 0, sizeof new_settings); }

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
  __builtin_memcpy(new_settings.address, text, sizeof new_settings.address);
  new_settings.port = static_cast<uint16_t>(text[4] | text[5] << 8);
  return append(new_settings.group, kClassBytes, text + kBrokerPlaceBytes,
                static_cast<uint8_t>(length - kBrokerPlaceBytes)) &&
         is_class(new_settings.group) && new_settings.port != 0;
}

bool take_date(const uint8_t* text, uint8_t length) {
  if (length != kDateBytes) return false;
  new_settings.date = 0;
  for (uint8_t k = kDateBytes; k > 0; k--) new_settings.date = new_settings.date << 8 | text[k - 1];
  return new_settings.date != 0;
}

bool take_trust(const uint8_t* text, uint8_t length) {
  if (length > kTrustBytes - new_settings.trust_bytes) return false;
  __builtin_memcpy(new_settings.trust + new_settings.trust_bytes, text, length);
  new_settings.trust_bytes = static_cast<uint16_t>(new_settings.trust_bytes + length);
  return true;
}

bool take(WifiStep step, const uint8_t* text, uint8_t length) {
  switch (step) {
    case WifiStep::kBroker:
      return begin(text, length);
    case WifiStep::kBrokerName:
      return append(new_settings.name, kBrokerNameBytes, text, length);
    case WifiStep::kBrokerUser:
      return append(new_settings.user, kNetworkBytes, text, length);
    case WifiStep::kBrokerPassword:
      return append(new_settings.password, kPasswordBytes, text, length);
    case WifiStep::kBrokerTls:
      return take_date(text, length);
    case WifiStep::kBrokerTrust:
      return take_trust(text, length);
    case WifiStep::kUseBroker:
      return new_settings.is_sound();
    default:
      return true;
  }
}

// While its task has not taken the settings, it speaks of those before: it may be looking up a name.
WifiState current_state() {
  if (!kept_settings.current().is_set()) return WifiState::kOff;
  if (lacks_memory) return WifiState::kNoTls;
  if (kept_settings.is_new()) return WifiState::kSearching;
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

void broker_load() { kept_settings.load(); }

bool broker_is_set() { return kept_settings.current().is_set(); }

WifiReport broker_report() {
  const BrokerSettings& settings = kept_settings.current();
  WifiReport report = {};
  report.mode = settings.is_set() ? WifiMode::kStation : WifiMode::kOff;
  report.state = current_state();
  __builtin_memcpy(report.address, settings.address, sizeof report.address);
  report.network_bytes = static_cast<uint8_t>(length_of(settings.group));
  __builtin_memcpy(report.network, settings.group, report.network_bytes);
  return report;
}

Answer broker_set(WifiStep step, const uint8_t* text, uint8_t length) {
  if (!take(step, text, length)) {
    clear();
    return Answer::kBadValue;
  }
  if (step != WifiStep::kUseBroker) return Answer::kOk;
  const Answer answer = kept_settings.keep(new_settings);
  if (answer == Answer::kOk) clear();
  return answer;
}

Answer broker_forget() {
  clear();
  return broker_is_set() ? kept_settings.keep(new_settings) : Answer::kOk;
}

void broker_note_memory(bool has_memory) { lacks_memory = !has_memory; }

// Its remarks on earlier ones end when the main loop learns that it has taken these.
bool broker_take_change(BrokerSettings* broker_settings) {
  if (!kept_settings.is_new()) return false;
  broker_note(WifiState::kSearching);
  return kept_settings.take_change(broker_settings);
}

void broker_note(WifiState wifi_state) {
  __atomic_store_n(&state, static_cast<uint8_t>(wifi_state), __ATOMIC_RELAXED);
}

}  // namespace tiniscript

#endif  // ARDUINO_ARCH_ESP32
