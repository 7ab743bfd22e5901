// The receiver, the decoder of frames, the link and the reader of text, around a robot that writes
// down what it is asked for (`../link/simulated_port`).
//
// An input is a row of events. Those that begin a frame send it whole: with its number, the epoch
// and a right checksum, or the fuzzer would never get past them. Others are bytes as they are, time
// that passes, and what happens to the robot. A robot with a window looks at every fourth frame and
// at what waits before it.

#include "../../src/link/link.h"

#include <string.h>

#include <string>

#include "../../src/link/frames.h"
#include "../../src/text/kit_words.h"
#include "../../src/vm/crc32.h"
#include "../link/simulated_port.h"
#include "input.h"

using namespace tiniscript;

namespace {

constexpr size_t kMaxEvents = 300;
constexpr uint8_t kReplies = 20;  // turns in which the robot may go on talking

Receiver receiver;
Link link_half;
uint32_t now_ms;
uint8_t seq;
uint8_t epoch;

// What the robot has sent: a row of packets, whose frames are whole.
std::string sent_bytes;

void check_sent() {
  size_t start = 0;
  for (size_t k = 0; k < sent_bytes.size(); k++) {
    if (sent_bytes[k] != 0) continue;
    const std::string packet = sent_bytes.substr(start, k - start);
    start = k + 1;
    if (packet.empty()) continue;
    if (packet.size() > 1 && (packet[1] & kReply) == 0) continue;  // text
    uint8_t bytes[kPacketBytes];
    must(packet.size() <= sizeof bytes);
    memcpy(bytes, packet.data(), packet.size());
    must(decode_frame(bytes, static_cast<uint8_t>(packet.size())) != 0);
    must((bytes[kTypeAt] & kReply) != 0);
    epoch = bytes[kEpochAt];
  }
  sent_bytes.erase(0, start);
}

void turn() {
  for (uint8_t k = 0; k < kReplies; k++) {
    link_half.pass_time(static_cast<uint16_t>(now_ms));
    link_half.tick();
    link_half.send_due();
    uint8_t byte;
    while (link_half.next_tx_byte(&byte)) sent_bytes.push_back(static_cast<char>(byte));
  }
  check_sent();
  must(sent_bytes.size() < 4096);
}

bool is_looking() { return seq % kWindow == 0; }

void arrive(uint8_t byte) {
  const bool is_stop = receiver.put(byte, static_cast<uint16_t>(now_ms));
  must(!is_stop || link_half.stop_is_due());
  if (!is_looking()) return;
  link_half.pass_time(static_cast<uint16_t>(now_ms));
  link_half.tick();
  link_half.send_due();
}

void send_frame(uint8_t type, Input* input) {
  uint8_t frame[kWireBytes] = {};
  uint8_t end = kPayloadAt;
  const uint8_t length = input->u8() % (kPayloadBytes + 1);
  frame[kTypeAt] = type;
  frame[kSeqAt] = ++seq;
  frame[kEpochAt] = epoch;
  if (length > kSmallFrame - kHeadBytes - kCrcBytes) end++;  // the 0 of a large one
  const uint8_t start = end;
  while (end - start < length) frame[end++] = input->u8();
  if (type == static_cast<uint8_t>(Message::kHello) && length != 0) frame[start] = kLinkMajor;
  const uint8_t size = encode_frame(frame, end);
  arrive(0);
  for (uint8_t k = 0; k < size; k++) arrive(frame[k]);
}

void happen(uint8_t event, Input* input) {
  const bool is_running = port.robot_status.state == State::kRunning;
  switch (event % 8) {
    case 0:
      now_ms += input->u8();
      break;
    case 1:
      now_ms += input->u16();
      break;
    case 2:
      if (is_running) {
        port.robot_status.state = State::kIdle;
        link_half.on_done();
      }
      break;
    case 3:
      if (is_running) {
        port_stop(1);
        link_half.on_faulted();
      }
      break;
    case 4:
      if (is_running) link_half.show(input->u16() * 77, input->u8() % 2 == 0);
      break;
    case 5:
      port_stop(0);
      link_half.on_stopped(Cause::kButton);
      break;
    case 6:
      port.is_busy = !port.is_busy;
      break;
    case 7:
      port.is_saving = !port.is_saving;
      break;
  }
}

}  // namespace

int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  Input input(data, size);
  port = SimulatedPort();
  port.room = 389;
  port.sensors = 3;
  port.actuators = 1;
  port.hashes = {1, 2, 3, 4};
  port.words = {0, kKitGoes | kKitTurns};
  receiver = Receiver();
  link_half = Link();
  epoch = input.u8();
  link_half.begin(&receiver, epoch);
  now_ms = 0;
  seq = 0;
  sent_bytes.clear();
  for (size_t k = 0; k < kMaxEvents && input.has_more(); k++) {
    const uint8_t event = input.u8();
    if (event < 0x40) {
      send_frame(event, &input);
    } else if (event < 0x50) {
      happen(event, &input);
    } else {
      for (uint8_t count = event % 64; count > 0 && input.has_more(); count--) arrive(input.u8());
      if (event >= 0xc0) arrive('\n');
    }
    if (!is_looking()) continue;
    turn();
    // whatever came: the motors' pins are off where a stop has not been looked at
    must(receiver.due_stop() == Cause::kNone || port.robot_status.state != State::kRunning);
  }
  return 0;
}
