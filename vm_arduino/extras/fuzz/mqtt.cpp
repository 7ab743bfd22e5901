// The reader of an ESP32 for what a broker says, beside a second one that has all bytes at hand.
//
// An input is a row of events: messages that the robot's own writer makes, and bytes as they are.
// After each input both have to have found the same.

#include "../../src/boards/esp32/mqtt.h"

#include <string.h>

#include <string>
#include <vector>

#include "input.h"

using namespace tiniscript;

namespace {

constexpr size_t kMostBytes = 4096;
constexpr size_t kRoom = 800;

struct Packet {
  MqttEvent event;
  std::string topic;
  std::string payload;
  bool is_retained;

  bool operator==(const Packet& other) const {
    return event == other.event && topic == other.topic && payload == other.payload &&
           is_retained == other.is_retained;
  }
};

std::string bytes_of(Input* input, size_t length) {
  std::string found;
  while (found.size() < length) found.push_back(static_cast<char>(input->u8()));
  return found;
}

std::string message(Input* input) {
  std::string topic = bytes_of(input, input->u8() % (kMqttTopicBytes + 4));
  for (char& each : topic) {
    if (each == 0) each = '/';
  }
  const std::string payload = bytes_of(input, input->u16() % (kMqttPayloadBytes + 4));
  uint8_t bytes[kRoom];
  MqttWriter writer(bytes, sizeof bytes);
  writer.publish(topic.c_str(), reinterpret_cast<const uint8_t*>(payload.data()), payload.size(),
                 input->u8() % 2 == 0);
  must(writer.length() == 2 + topic.size() + payload.size() + 2 + (writer.length() > 129));
  return std::string(reinterpret_cast<const char*>(bytes), writer.length());
}

// The next packet of `data` from `at` on, which goes on after it. False: it is not all there.
bool next_packet(const std::string& data, size_t* at, Packet* found) {
  *found = {MqttEvent::kNone, "", "", false};
  size_t place = *at;
  if (place == data.size()) return false;
  const uint8_t type = static_cast<uint8_t>(data[place++]);
  size_t length = 0;
  for (int k = 0; true; k++) {
    if (place == data.size()) return false;
    const uint8_t byte = static_cast<uint8_t>(data[place++]);
    length += static_cast<size_t>(byte & 0x7f) << (7 * k);
    if (byte < 0x80) break;
    if (k == 3) {
      *at = place;
      found->event = MqttEvent::kBroken;
      return true;
    }
  }
  const bool is_message = type >> 4 == 3;
  const bool is_known = is_message ? (type & 6) == 0 && length >= 2
                                   : (type == 0x20 && length == 2) || (type == 0x90 && length == 4) ||
                                         (type == 0xd0 && length == 0);
  if (!is_known) {
    *at = place;
    found->event = MqttEvent::kBroken;
    return true;
  }
  const std::string body = data.substr(place, length);
  if (is_message && body.size() >= 2) {
    const size_t topic = static_cast<size_t>(static_cast<uint8_t>(body[0]) << 8 |
                                             static_cast<uint8_t>(body[1]));
    if (topic > length - 2) {
      *at = place + 2;
      found->event = MqttEvent::kBroken;
      return true;
    }
    if (body.size() == length && topic <= kMqttTopicBytes &&
        length - 2 - topic <= kMqttPayloadBytes) {
      *found = {MqttEvent::kMessage, body.substr(2, topic), body.substr(2 + topic),
                (type & 1) != 0};
    }
  }
  if (body.size() < length) return false;
  *at = place + length;
  if (type == 0x20) found->event = body[1] == 0 ? MqttEvent::kAccepted : MqttEvent::kRefused;
  if (type == 0x90) {
    const std::string grants = body.substr(2);
    const bool are_codes = grants.find_first_not_of(std::string("\0\x80", 2)) == std::string::npos;
    const bool are_all = grants == std::string(2, 0);
    found->event = !are_codes ? MqttEvent::kBroken
                   : are_all  ? MqttEvent::kSubscribed
                              : MqttEvent::kRefused;
  }
  return true;
}

std::vector<Packet> expected(const std::string& data) {
  std::vector<Packet> all;
  Packet found;
  for (size_t at = 0; next_packet(data, &at, &found);) {
    if (found.event != MqttEvent::kNone) all.push_back(found);
  }
  return all;
}

}  // namespace

int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size) {
  Input input(bytes, size);
  std::string data;
  while (input.has_more() && data.size() < kMostBytes) {
    const uint8_t event = input.u8();
    data += event < 0x40 ? message(&input) : bytes_of(&input, event % 32);
  }
  static MqttReader reader;
  reader.begin();
  std::vector<Packet> all;
  for (const char each : data) {
    Packet found = {reader.take(static_cast<uint8_t>(each)), "", "", false};
    if (found.event == MqttEvent::kNone) continue;
    if (found.event == MqttEvent::kBroken) reader.begin();
    if (found.event == MqttEvent::kMessage) {
      must(reader.length() <= kMqttPayloadBytes);
      found.topic = reader.topic();
      found.payload.assign(reinterpret_cast<const char*>(reader.payload()), reader.length());
      found.is_retained = reader.is_retained();
    }
    all.push_back(found);
  }
  std::vector<Packet> others = expected(data);
  for (Packet& each : others) each.topic = each.topic.c_str();  // a topic of ours has no 0 in it
  must(all == others);
  return 0;
}
