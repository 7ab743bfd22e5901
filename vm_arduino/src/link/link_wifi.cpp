// WIFI: sets or removes a network and a broker for the robot. Its name and password come covered by
// the seal.

#include "../vm/small.h"
#include "link.h"
#include "port.h"

#ifdef tiniscript_transports

namespace tiniscript {

namespace {

constexpr uint8_t kLastStep = static_cast<uint8_t>(WifiStep::kBrokerTrust);

}  // namespace

uint8_t Link::set_wifi(const uint8_t* payload, uint8_t length) {
  const uint8_t step = payload[kWifiStepAt];
  if (!is_sealed()) return static_cast<uint8_t>(Answer::kNotOwner);
  if (step > kLastStep) return static_cast<uint8_t>(Answer::kBadValue);
  const uint8_t text_bytes = static_cast<uint8_t>(length - kWifiTextAt);
  uint8_t text[kWifiTextBytes];
  copy_bytes(payload + kWifiTextAt, text, text_bytes);
  seal_.cover(receiver_->bytes() + kCounterAt, text, text_bytes);
  const Answer answer = port_set_wifi(static_cast<WifiStep>(step), text, text_bytes);
  for (uint8_t& byte : text) byte = 0;
  if (answer == Answer::kOk) reply_.detail = step;  // the subject of the reply
  return static_cast<uint8_t>(answer);
}

void Link::tell_wifi() {
  const WifiReport report = port_wifi_report(static_cast<WifiStep>(reply_.detail));
  put(static_cast<uint8_t>(report.mode));
  put(static_cast<uint8_t>(report.state));
  put_all(report.address, sizeof report.address);
  put_all(report.network, report.network_bytes);
}

}  // namespace tiniscript

#endif  // tiniscript_transports
