// MQTT over a connection that never waits.
//
// tiniscript/CLASS/ID           says that the robot is there, or (its last will) that it is not
// tiniscript/CLASS/ID/in/PEER   bytes of a client, which PEER, eight hexadecimal digits, names
// tiniscript/CLASS/ID/out/PEER  bytes for it; none at all: another client has the robot
// tiniscript/CLASS/stop         zeros stop all robots of the class
//
// The link decides who drives: a broker, and anyone who publishes there, is a stranger. A retained
// message is an old one, so none of them is accepted.

#ifdef ARDUINO_ARCH_ESP32

#include <Arduino.h>

#include "broker_line.h"
#include "broker_settings.h"
#include "mqtt.h"
#include "radio.h"
#include "wifi_settings.h"
#include "zero_ended.h"

namespace tiniscript {

namespace {

constexpr uint32_t kAgainMs = 3000;    // between two tries to connect, and up to a second more
constexpr uint32_t kConnectMs = 3000;  // until the broker has let the robot in
constexpr uint32_t kTlsMs = 12000;     // the same with TLS: an ESP32 calculates for seconds
constexpr uint16_t kKeepAliveS = 4;    // 1.5 times that, and the broker tells the last will
constexpr uint32_t kPingMs = 1500;     // of silence of the robot
constexpr uint32_t kSilentMs = 4000;   // of the broker, which answers pings
constexpr uint32_t kPeerMs = 3000;     // of silence after which another client gets the robot
constexpr size_t kPeerDigits = 8;
constexpr size_t kChunk = 256;
constexpr size_t kMinStop = 4;
constexpr char kOnline = '+';
constexpr char kOffline = '-';

enum class Phase : uint8_t { kOff, kConnecting, kGreeting, kSubscribing, kReady };

using Peer = char[kPeerDigits + 1];

BrokerSettings settings;
MqttReader reader;
Phase phase;
uint32_t since_ms;  // of the phase
uint32_t heard_ms;
uint32_t sent_ms;

Peer peer;  // the client that has the robot; empty: none
uint32_t peer_ms;
Peer refused_peer;  // the client to notify that another one has the robot

size_t out_length;
size_t out_sent;
uint8_t out[1024];

Pipe& pipe() { return radio_pipe(Transport::kBroker); }

uint32_t now_ms() { return static_cast<uint32_t>(millis()); }

// A topic of this robot, or of its class.
class Topic {
 public:
  Topic() {
    add("tiniscript/");
    add(settings.group);
    add("/");
  }
  Topic& add(const char* text) {
    while (*text != 0 && length_ < kMqttTopicBytes) text_[length_++] = *text++;
    text_[length_] = 0;
    return *this;
  }
  Topic& add_id() { return add(radio_name().id); }
  const char* text() const { return text_; }

 private:
  char text_[kMqttTopicBytes + 1];
  size_t length_ = 0;
};

// The rest of a topic after `start`, or nullptr.
const char* suffix_after(const char* topic, const char* start) {
  while (*start != 0) {
    if (*topic++ != *start++) return nullptr;
  }
  return topic;
}

bool is_peer(const char* text) {
  size_t length = 0;
  for (; text[length] != 0; length++) {
    const bool is_digit = text[length] >= '0' && text[length] <= '9';
    const bool is_letter = text[length] >= 'a' && text[length] <= 'f';
    if (!is_digit && !is_letter) return false;
  }
  return length == kPeerDigits;
}

bool is_stop(const uint8_t* payload, size_t length) {
  for (size_t k = 0; k < length; k++) {
    if (payload[k] != 0) return false;
  }
  return length >= kMinStop;
}

// The stop in a message of somebody of whom no other one is known. It begins with text, or with
// frames if it has a zero, and ends where a line does. The content of a frame is not a stop of a
// stranger.
StopKind find_stop(const uint8_t* payload, size_t length) {
  bool is_framed = false;
  for (size_t k = 0; k < length; k++) {
    if (payload[k] == 0) is_framed = true;
  }
  StopFinder finder = StopFinder();
  finder.begin(is_framed);
  StopKind strongest = StopKind::kNothing;
  for (size_t k = 0; k < length; k++) {
    const StopKind stop = finder.put(payload[k], 0);
    if (stop > strongest) strongest = stop;
  }
  return finder.is_at_stop() ? StopKind::kStop : strongest;
}

void drop_peer() {
  if (peer[0] == 0) return;
  peer[0] = 0;
  pipe().end_client();
}

void set_phase(Phase next) {
  phase = next;
  since_ms = now_ms();
}

// `state` stays until there is another reason: each of the next tries may end in the same way.
void hang_up(WifiState state = WifiState::kSearching) {
  line_end();
  drop_peer();
  refused_peer[0] = 0;
  out_length = out_sent = 0;
  set_phase(Phase::kOff);
  broker_note(state);
}

// The moment of the next try differs from robot to robot: a broker that is back gets them in turn.
uint32_t retry_delay_ms() {
  uint32_t id_hash = 0;
  for (const char* digit = radio_name().id; *digit != 0; digit++) {
    id_hash = id_hash * 31 + static_cast<uint8_t>(*digit);
  }
  return kAgainMs + id_hash % 1000;
}

void begin() {
  set_phase(Phase::kConnecting);
  if (!line_begin(settings)) hang_up();
  since_ms = now_ms();  // a name may have taken a while
}

void connect() {
  const WifiState wifi_state = line_connect();
  if (wifi_state == WifiState::kSearching) return;
  if (wifi_state != WifiState::kReady)
    return hang_up(wifi_state == WifiState::kOff ? WifiState::kSearching : wifi_state);
  char client[sizeof "tini-" + sizeof(RadioName::id)] = "tini-";
  __builtin_memcpy(client + 5, radio_name().id, sizeof(RadioName::id));
  char will[kNameBytes + 2] = {kOffline};
  __builtin_memcpy(will + 1, radio_name().name, kNameBytes + 1);
  MqttWriter writer(out, sizeof out);
  writer.connect(client, kKeepAliveS, Topic().add_id().text(), will, settings.user,
                 settings.password);
  out_length = writer.length();
  out_sent = 0;
  reader.begin();
  heard_ms = sent_ms = now_ms();
  set_phase(Phase::kGreeting);
}

void subscribe() {
  set_phase(Phase::kSubscribing);
  MqttWriter writer(out, sizeof out);
  writer.subscribe(1, Topic().add_id().add("/in/+").text(), Topic().add("stop").text());
  out_length = writer.length();
  out_sent = 0;
}

// It reports its presence when it hears those to be told.
void announce() {
  set_phase(Phase::kReady);
  broker_note(WifiState::kReady);
  char presence[kNameBytes + 2] = {kOnline};
  __builtin_memcpy(presence + 1, radio_name().name, kNameBytes + 1);
  MqttWriter writer(out, sizeof out);
  writer.publish(Topic().add_id().text(), reinterpret_cast<const uint8_t*>(presence),
                 length_of(presence), true);
  out_length = writer.length();
  out_sent = 0;
}

void pass_on(const uint8_t* bytes, size_t length) {
  for (size_t k = 0; k < length; k++) pipe().put(bytes[k], static_cast<uint16_t>(now_ms()));
}

// A message of a client. A client that has the robot keeps it until it leaves or is silent; a stop
// from anybody is a stop.
void on_peer(const char* sender, const uint8_t* payload, size_t length) {
  const bool is_taken = peer[0] != 0 && !is_same(sender, peer) && now_ms() - peer_ms < kPeerMs;
  if (is_taken) {
    const StopKind stop = is_stop(payload, length) ? StopKind::kStop : find_stop(payload, length);
    if (stop > StopKind::kInFrame) return pipe().stop(stop == StopKind::kOfRun);
    if (length != 0) __builtin_memcpy(refused_peer, sender, sizeof refused_peer);
    return;
  }
  if (length == 0) {  // it leaves
    if (is_same(sender, peer)) drop_peer();
    return;
  }
  if (!is_same(sender, peer)) {
    drop_peer();
    __builtin_memcpy(peer, sender, sizeof peer);
    pipe().begin();
  }
  peer_ms = now_ms();
  pass_on(payload, length);
}

void on_message() {
  if (reader.is_retained()) return;
  if (is_same(reader.topic(), Topic().add("stop").text())) {
    if (is_stop(reader.payload(), reader.length())) pass_on(reader.payload(), reader.length());
    return;
  }
  const char* const sender = suffix_after(reader.topic(), Topic().add_id().add("/in/").text());
  if (sender != nullptr && is_peer(sender)) on_peer(sender, reader.payload(), reader.length());
}

// Returns whether the connection is still there.
bool on_rx_byte(uint8_t byte) {
  switch (reader.take(byte)) {
    case MqttEvent::kNone:
      return true;
    case MqttEvent::kAccepted:
      if (phase != Phase::kGreeting) break;
      subscribe();
      return true;
    case MqttEvent::kSubscribed:
      if (phase != Phase::kSubscribing) break;
      announce();
      return true;
    case MqttEvent::kMessage:  // which may come before the subscription is confirmed
      if (phase < Phase::kSubscribing) break;
      on_message();
      return true;
    case MqttEvent::kRefused:
      hang_up(WifiState::kRefused);
      return false;
    case MqttEvent::kBroken:
      break;
  }
  hang_up();
  return false;
}

void receive() {
  uint8_t bytes[kChunk];
  const int length = line_receive(bytes, sizeof bytes);
  if (length == kEnded) return hang_up();
  if (length == kNothingYet) return;
  heard_ms = now_ms();
  for (int k = 0; k < length; k++) {
    if (!on_rx_byte(bytes[k])) return;
  }
}

// Puts the next packet into `out`.
void write_next() {
  MqttWriter writer(out, sizeof out);
  uint8_t bytes[kChunk];
  size_t length = 0;
  while (peer[0] != 0 && length < sizeof bytes && pipe().take(bytes + length)) length++;
  if (length != 0) {
    writer.publish(Topic().add_id().add("/out/").add(peer).text(), bytes, length, false);
  } else if (refused_peer[0] != 0) {
    writer.publish(Topic().add_id().add("/out/").add(refused_peer).text(), nullptr, 0, false);
    refused_peer[0] = 0;
  } else if (now_ms() - sent_ms >= kPingMs) {
    writer.ping();
  }
  out_length = writer.length();
  out_sent = 0;
}

void say() {
  if (out_sent == out_length && phase == Phase::kReady) write_next();
  if (out_sent == out_length) return;
  const int sent_length = line_send(out + out_sent, out_length - out_sent);
  if (sent_length == kEnded) return hang_up();
  if (sent_length == kNothingYet) return;
  out_sent += static_cast<size_t>(sent_length);
  sent_ms = now_ms();
}

}  // namespace

void broker_turn() {
  if (broker_take_change(&settings)) {
    hang_up();
    since_ms = now_ms() - retry_delay_ms();  // at once
  }
  if (!settings.is_set() || !wifi_is_there()) {
    if (phase != Phase::kOff) hang_up();
    if (!settings.is_set()) broker_note(WifiState::kOff);
    return;
  }
  if (phase == Phase::kOff) {
    if (now_ms() - since_ms >= retry_delay_ms()) begin();
    return;
  }
  const uint32_t waiting_ms = now_ms() - since_ms;
  const uint32_t limit_ms = settings.is_tls() ? kTlsMs : kConnectMs;
  if (phase != Phase::kReady && waiting_ms >= limit_ms) return hang_up();
  if (phase == Phase::kConnecting) return connect();
  receive();
  if (phase != Phase::kOff) say();
  if (phase == Phase::kReady && now_ms() - heard_ms >= kSilentMs) hang_up();
}

}  // namespace tiniscript

#endif  // ARDUINO_ARCH_ESP32
