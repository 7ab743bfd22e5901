// MQTT 3.1.1 as a robot speaks it: writes the packets of a client, and reads those of a broker.
//
// All messages have QoS 0: the link repeats lost ones. Knows no sockets and no time. A message that
// is longer than its room is skipped, whatever its length.

#pragma once

#include <stddef.h>
#include <stdint.h>

namespace tiniscript {

constexpr size_t kMqttTopicBytes = 64;
constexpr size_t kMqttPayloadBytes = 512;

// Writes packets into a room of bytes, whole ones alone.
class MqttWriter {
 public:
  MqttWriter(uint8_t* bytes, size_t room) : bytes_(bytes), room_(room) {}

  // `will` is retained at `topic` when the connection ends without a word. `user` may be empty.
  void connect(const char* client, uint16_t keep_alive_s, const char* topic, const char* will,
               const char* user, const char* password);
  void subscribe(uint16_t id, const char* first, const char* second);
  void publish(const char* topic, const uint8_t* payload, size_t length, bool is_retained);
  void ping();

  size_t length() const { return is_full_ ? 0 : length_; }

 private:
  void byte(uint8_t value);
  void number(size_t value);
  void text(const char* value);
  void head(uint8_t type, size_t length);

  uint8_t* bytes_;
  size_t room_;
  size_t length_ = 0;
  bool is_full_ = false;
};

// kAccepted: the broker has let the client in; kSubscribed: it grants both topics; kRefused: it does
// not.
enum class MqttEvent : uint8_t { kNone, kAccepted, kSubscribed, kRefused, kMessage, kBroken };

// Reads a row of bytes.
class MqttReader {
 public:
  void begin();

  // Takes a byte. kMessage: `topic`, `payload` and `is_retained` are those of a message; kBroken:
  // this is no MQTT.
  MqttEvent take(uint8_t byte);

  const char* topic() const { return topic_; }
  const uint8_t* payload() const { return payload_; }
  size_t length() const { return length_; }
  bool is_retained() const { return (type_ & 0x01) != 0; }

 private:
  enum class Part : uint8_t { kType, kLength, kTopicLength, kTopic, kPayload, kSkip };

  MqttEvent begin_packet();
  MqttEvent take_body(uint8_t byte);
  MqttEvent end_packet();
  MqttEvent end_subscription() const;

  Part part_;
  uint8_t type_;
  uint8_t shift_;        // of the length
  uint32_t bytes_left_;  // bytes of the packet that are still to come
  size_t part_offset_;   // in the part
  size_t topic_bytes_left_;
  size_t length_;
  char topic_[kMqttTopicBytes + 1];
  uint8_t payload_[kMqttPayloadBytes];
};

}  // namespace tiniscript
