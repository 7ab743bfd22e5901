#ifdef ARDUINO_ARCH_ESP32

#include "mqtt.h"

#include "zero_ended.h"

namespace tiniscript {

namespace {

constexpr uint8_t kConnect = 0x10;
constexpr uint8_t kConnack = 0x20;
constexpr uint8_t kPublish = 0x30;
constexpr uint8_t kSubscribe = 0x82;
constexpr uint8_t kSuback = 0x90;
constexpr uint8_t kPing = 0xc0;
constexpr uint8_t kPingResp = 0xd0;

constexpr uint8_t kQos = 0x06;
constexpr uint8_t kRetain = 0x01;
constexpr uint8_t kClean = 0x02;
constexpr uint8_t kWill = 0x04;
constexpr uint8_t kWillRetain = 0x20;
constexpr uint8_t kHasPassword = 0x40;
constexpr uint8_t kHasUser = 0x80;
constexpr uint8_t kNotGranted = 0x80;
constexpr size_t kGrants = 2;  // after the number of the request, for each topic
constexpr uint8_t kLastShift = 21;  // a length has four bytes at most

}  // namespace

void MqttWriter::byte(uint8_t value) {
  if (length_ == room_) {
    is_full_ = true;
  } else {
    bytes_[length_++] = value;
  }
}

void MqttWriter::number(size_t value) {
  byte(static_cast<uint8_t>(value >> 8));
  byte(static_cast<uint8_t>(value));
}

void MqttWriter::text(const char* value) {
  number(length_of(value));
  for (; *value != 0; value++) byte(static_cast<uint8_t>(*value));
}

void MqttWriter::head(uint8_t type, size_t length) {
  byte(type);
  for (; length > 0x7f; length >>= 7) byte(static_cast<uint8_t>(length | 0x80));
  byte(static_cast<uint8_t>(length));
}

void MqttWriter::connect(const char* client, uint16_t keep_alive_s, const char* topic,
                         const char* will, const char* user, const char* password) {
  const bool has_user = user[0] != 0;
  size_t length = 10 + 2 + length_of(client) + 2 + length_of(topic) + 2 + length_of(will);
  if (has_user) length += 2 + length_of(user) + 2 + length_of(password);
  head(kConnect, length);
  text("MQTT");
  byte(4);  // 3.1.1
  byte(static_cast<uint8_t>(kClean | kWill | kWillRetain |
                            (has_user ? kHasUser | kHasPassword : 0)));
  number(keep_alive_s);
  text(client);
  text(topic);
  text(will);
  if (!has_user) return;
  text(user);
  text(password);
}

void MqttWriter::subscribe(uint16_t id, const char* first, const char* second) {
  head(kSubscribe, 2 + 2 + length_of(first) + 1 + 2 + length_of(second) + 1);
  number(id);
  text(first);
  byte(0);
  text(second);
  byte(0);
}

void MqttWriter::publish(const char* topic, const uint8_t* payload, size_t length,
                         bool is_retained) {
  head(static_cast<uint8_t>(kPublish | (is_retained ? kRetain : 0)), 2 + length_of(topic) + length);
  text(topic);
  for (size_t k = 0; k < length; k++) byte(payload[k]);
}

void MqttWriter::ping() { head(kPing, 0); }

void MqttReader::begin() { part_ = Part::kType; }

MqttEvent MqttReader::take(uint8_t byte) {
  switch (part_) {
    case Part::kType:
      type_ = byte;
      bytes_left_ = 0;
      shift_ = 0;
      part_ = Part::kLength;
      return MqttEvent::kNone;
    case Part::kLength:
      bytes_left_ |= static_cast<uint32_t>(byte & 0x7f) << shift_;
      if ((byte & 0x80) == 0) return begin_packet();
      if (shift_ == kLastShift) return MqttEvent::kBroken;
      shift_ = static_cast<uint8_t>(shift_ + 7);
      return MqttEvent::kNone;
    default:
      return take_body(byte);
  }
}

// Messages that a broker may send to this client. It has asked for QoS 0.
MqttEvent MqttReader::begin_packet() {
  part_offset_ = 0;
  length_ = 0;
  topic_bytes_left_ = 0;
  topic_[0] = 0;
  const bool is_message = (type_ & 0xf0) == kPublish;
  if (is_message) {
    if ((type_ & kQos) != 0 || bytes_left_ < 2) return MqttEvent::kBroken;
    part_ = Part::kTopicLength;
    return MqttEvent::kNone;
  }
  const bool is_known = (type_ == kConnack && bytes_left_ == 2) ||
                        (type_ == kSuback && bytes_left_ == 2 + kGrants) ||
                        (type_ == kPingResp && bytes_left_ == 0);
  if (!is_known) return MqttEvent::kBroken;
  part_ = Part::kPayload;
  return bytes_left_ == 0 ? end_packet() : MqttEvent::kNone;
}

MqttEvent MqttReader::take_body(uint8_t byte) {
  bytes_left_--;
  switch (part_) {
    case Part::kTopicLength:
      topic_bytes_left_ = topic_bytes_left_ << 8 | byte;
      if (++part_offset_ < 2) break;
      if (topic_bytes_left_ > bytes_left_) return MqttEvent::kBroken;
      part_offset_ = 0;
      part_ = topic_bytes_left_ > kMqttTopicBytes ? Part::kSkip : Part::kTopic;
      if (part_ == Part::kTopic && topic_bytes_left_ == 0) part_ = Part::kPayload;
      break;
    case Part::kTopic:
      topic_[part_offset_++] = static_cast<char>(byte);
      topic_[part_offset_] = 0;
      if (--topic_bytes_left_ == 0) part_ = Part::kPayload;
      break;
    case Part::kPayload:
      if (length_ == kMqttPayloadBytes) {
        part_ = Part::kSkip;
      } else {
        payload_[length_++] = byte;
      }
      break;
    default:
      break;
  }
  return bytes_left_ == 0 ? end_packet() : MqttEvent::kNone;
}

MqttEvent MqttReader::end_packet() {
  const bool is_whole = part_ == Part::kPayload;
  part_ = Part::kType;
  if ((type_ & 0xf0) == kPublish) return is_whole ? MqttEvent::kMessage : MqttEvent::kNone;
  if (type_ == kSuback) return end_subscription();
  if (type_ != kConnack) return MqttEvent::kNone;
  return payload_[1] == 0 ? MqttEvent::kAccepted : MqttEvent::kRefused;
}

// We asked for QoS 0: a broker grants that or nothing.
MqttEvent MqttReader::end_subscription() const {
  const uint8_t* const grants = payload_ + 2;
  for (size_t k = 0; k < kGrants; k++) {
    if (grants[k] != 0 && grants[k] != kNotGranted) return MqttEvent::kBroken;
  }
  const bool are_granted = grants[0] == 0 && grants[1] == 0;
  return are_granted ? MqttEvent::kSubscribed : MqttEvent::kRefused;
}

}  // namespace tiniscript

#endif  // ARDUINO_ARCH_ESP32
