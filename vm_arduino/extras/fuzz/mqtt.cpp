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

constexpr size_t kMaxBytes = 4096;
constexpr size_t kRoom = 800;

struct Packet {
  MqttEvent event;
  std::string topic;
  std::string payload;
  bool is_retained;

  bool operator==(const Packet& second) const {
    return event == second.event && topic == second.topic && payload == second.payload &&
           is_retained == second.is_retained;
  }
};

std::string bytes_of(Input* input, size_t length) {
  std::string bytes;
  while (bytes.size() < length) bytes.push_back(static_cast<char>(input->u8()));
  return bytes;
}

std::string message(Input* input) {
  std::string topic = bytes_of(input, input->u8() % (kMqttTopicBytes + 4));
  for (char& letter : topic) {
    if (letter == 0) letter = '/';
  }
  const std::string payload = bytes_of(input, input->u16() % (kMqttPayloadBytes + 4));
  uint8_t bytes[kRoom];
  MqttWriter writer(bytes, sizeof bytes);
  writer.publish(topic.c_str(), reinterpret_cast<const uint8_t*>(payload.data()), payload.size(),
                 input->u8() % 2 == 0);
  must(writer.length() == 2 + topic.size() + payload.size() + 2 + (writer.length() > 129));
  return std::string(reinterpret_cast<const char*>(bytes), writer.length());
}

// The next packet of `data` from `offset` on, which goes on after it. False: it is not all there.
bool next_packet(const std::string& data, size_t* offset, Packet* packet) {
  *packet = {MqttEvent::kNone, "", "", false};
  size_t place = *offset;
  if (place == data.size()) return false;
  const uint8_t type = static_cast<uint8_t>(data[place++]);
  size_t length = 0;
  for (int k = 0; true; k++) {
    if (place == data.size()) return false;
    const uint8_t byte = static_cast<uint8_t>(data[place++]);
    length += static_cast<size_t>(byte & 0x7f) << (7 * k);
    if (byte < 0x80) break;
    if (k == 3) {
      *offset = place;
      packet->event = MqttEvent::kBroken;
      return true;
    }
  }
  const bool is_message = type >> 4 == 3;
  const bool is_known = is_message ? (type & 6) == 0 && length >= 2
                                   : (type == 0x20 && length == 2) || (type == 0x90 && length == 4) ||
                                         (type == 0xd0 && length == 0);
  if (!is_known) {
    *offset = place;
    packet->event = MqttEvent::kBroken;
    return true;
  }
  const std::string body = data.substr(place, length);
  if (is_message && body.size() >= 2) {
    const size_t topic = static_cast<size_t>(static_cast<uint8_t>(body[0]) << 8 |
                                             static_cast<uint8_t>(body[1]));
    if (topic > length - 2) {
      *offset = place + 2;
      packet->event = MqttEvent::kBroken;
      return true;
    }
    if (body.size() == length && topic <= kMqttTopicBytes &&
        length - 2 - topic <= kMqttPayloadBytes) {
      *packet = {MqttEvent::kMessage, body.substr(2, topic), body.substr(2 + topic),
                 (type & 1) != 0};
    }
  }
  if (body.size() < length) return false;
  *offset = place + length;
  if (type == 0x20) packet->event = body[1] == 0 ? MqttEvent::kAccepted : MqttEvent::kRefused;
  if (type == 0x90) {
    const std::string grants = body.substr(2);
    const bool are_codes = grants.find_first_not_of(std::string("\0\x80", 2)) == std::string::npos;
    const bool are_all = grants == std::string(2, 0);
    packet->event = !are_codes ? MqttEvent::kBroken
                    : are_all  ? MqttEvent::kSubscribed
                               : MqttEvent::kRefused;
  }
  return true;
}

std::vector<Packet> expected(const std::string& data) {
  std::vector<Packet> packets;
  Packet packet;
  for (size_t offset = 0; next_packet(data, &offset, &packet);) {
    if (packet.event != MqttEvent::kNone) packets.push_back(packet);
  }
  return packets;
}

}  // namespace

int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size) {
  Input input(bytes, size);
  std::string data;
  while (input.has_more() && data.size() < kMaxBytes) {
    const uint8_t event = input.u8();
    data += event < 0x40 ? message(&input) : bytes_of(&input, event % 32);
  }
  static MqttReader reader;
  reader.begin();
  std::vector<Packet> packets;
  for (const char byte : data) {
    Packet packet = {reader.take(static_cast<uint8_t>(byte)), "", "", false};
    if (packet.event == MqttEvent::kNone) continue;
    if (packet.event == MqttEvent::kBroken) reader.begin();
    if (packet.event == MqttEvent::kMessage) {
      must(reader.length() <= kMqttPayloadBytes);
      packet.topic = reader.topic();
      packet.payload.assign(reinterpret_cast<const char*>(reader.payload()), reader.length());
      packet.is_retained = reader.is_retained();
    }
    packets.push_back(packet);
  }
  std::vector<Packet> expected_packets = expected(data);
  for (Packet& packet : expected_packets)
    packet.topic = packet.topic.c_str();  // a topic of ours has no 0 in it
  must(packets == expected_packets);
  return 0;
}
