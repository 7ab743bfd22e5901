// The robot's half of the link on a computer, for tests: many requests to one process, or to a
// library.
//
// A request is four bytes of length and a letter with what it asks; an answer is four bytes of
// length and what was found. `tests/machines/link.py` is the other side. Ends with its input.

#include <stdio.h>

#include <algorithm>

#include "../../src/link/link.h"
#include "../../src/link/seal.h"
#include "../../src/link/siphash.h"
#include "../host/wire.h"
#include "simulated_port.h"

using namespace tiniscript;

namespace {

struct TestedSeal : Seal {
  void set_received_counter(uint32_t counter) { received_counter_ = counter; }
  void set_sent_counter(uint32_t counter) { sent_counter_ = counter; }
};

Receiver receiver;
Link link_half;

// B: switches a robot on.
void answer_begin(RequestReader* request, Writer*) {
  port = SimulatedPort();
  port.room = request->u16();
  port.identity.kit = request->u16();
  port.sensors = request->u8();
  port.actuators = request->u8();
  port.hashes.resize(static_cast<size_t>(port.sensors + port.actuators));
  port.identity.id = 0x54696e69;
  port.identity.reset = Reset::kPower;
  const uint8_t name[] = {'T', 'i', 'n', 'i'};
  port_rename(name, sizeof name);
  receiver = Receiver();
  link_half = Link();
  const uint8_t epoch = request->u8();
  port.identity.nonce = 0x080705fc + epoch;  // another one after a reset, as a board's
  link_half.begin(&receiver, epoch);
  for (uint16_t& hash : port.hashes) hash = request->u16();
  const Bytes words = request->bytes();
  port.words.assign(words.data.get(), words.data.get() + words.length);
  port.log.clear();
}

// S: bytes arrive at a time; the link looks at them after each one, or only at the end. Says what
// it sends and what the robot does.
void answer_step(RequestReader* request, Writer* answer) {
  const uint32_t now_ms = request->u32();
  const uint8_t mode = request->u8();
  const Bytes data = request->bytes();
  port.log.clear();
  std::string sent_bytes;
  for (size_t k = 0; k <= data.length; k++) {
    if (k < data.length && receiver.put(data.data[k], static_cast<uint16_t>(now_ms))) {
      port.log += link_half.stop_is_due() ? "PINS OFF\n" : "the link does not know of a stop\n";
    }
    const bool is_last = k == data.length;
    if (mode == 1 && !is_last) continue;
    link_half.pass_time(static_cast<uint16_t>(now_ms));
    link_half.tick();
    link_half.send_due();
    uint8_t byte = 0;
    for (uint8_t turns = 0; turns < 8; turns++) {
      while ((mode != 2 || is_last) && link_half.next_tx_byte(&byte))
        sent_bytes += static_cast<char>(byte);
      link_half.tick();
      link_half.send_due();
    }
  }
  answer->text(sent_bytes);
  answer->text(port.log);
}

// R: what happens to the robot: its program is done, has a fault, shows something; its button.
void answer_robot(RequestReader* request, Writer* answer) {
  const uint8_t event = request->u8();
  const uint32_t value = request->u32();
  bool is_taken = true;
  switch (event) {
    case 'd':
      port.robot_status.state = State::kIdle;
      link_half.on_done();
      break;
    case 'f':
      port_stop(static_cast<uint8_t>(value));
      link_half.on_faulted();
      break;
    case 's':
      is_taken = link_half.show(static_cast<int32_t>(value), false);
      break;
    case 'b':
      port_stop(0);
      link_half.on_stopped(Cause::kButton);
      break;
    case 'r':
      port_release();
      link_half.cancel_and_detach();
      port_start(false);
      break;
    case 'a':
      port.offset = static_cast<uint16_t>(value);
      break;
    case 'w':
      port.is_busy = value != 0;
      break;
    case 'h':
      is_taken = link_half.confirm_claim();
      break;
    case 'l':
      link_half.expire();
      break;
    case 'o':
      port.identity.features = static_cast<uint8_t>(value);
      port.identity.more_features = static_cast<uint8_t>(value >> 8);
      break;
    case 'k':
      port.is_saving = value != 0;
      break;
    default:
      abort();
  }
  answer->u8(is_taken);
}

// Writes a row: what was found, its length and its first bytes, `max_bytes` of them.
std::string row_of(const char* kind, const uint8_t* bytes, size_t length, size_t max_bytes) {
  char part[40];
  snprintf(part, sizeof part, "%s %zu", kind, length);
  std::string row = part;
  for (size_t k = 0; k < length && k < max_bytes; k++) {
    snprintf(part, sizeof part, " %02x", bytes[k]);
    row += part;
  }
  return row;
}

// Adds the lines of text that are whole to the rows.
void take_lines(std::string* line, std::string* rows) {
  uint8_t byte;
  while (receiver.take_text(&byte)) {
    if (byte == kLineEnd && !line->empty()) {
      const uint8_t* const bytes = reinterpret_cast<const uint8_t*>(line->data());
      *rows += row_of("text", bytes, line->size(), kSmallPacket) + "\n";
    }
    if (byte == kLineStop) continue;  // `test_typed_stops.py` is about these
    if (byte == kLineEnd || byte == kLineCut) {
      line->clear();
    } else {
      *line += static_cast<char>(byte);
    }
  }
}

// I: bytes and times to a receiver alone: what it finds, a line each. A frame is released, and text
// taken, after `delay` more bytes.
void answer_packets(RequestReader* request, Writer* answer) {
  receiver = Receiver();
  std::string rows;
  std::string line;
  const uint8_t delay = request->u8();
  uint8_t remaining = 0;
  for (uint32_t count = request->u32(); count > 0; count--) {
    const uint16_t now_ms = request->u16();
    if (remaining > 0 && --remaining == 0) receiver.release();
    if (remaining == 0) take_lines(&line, &rows);
    const uint8_t byte = request->u8();
    if (receiver.count_zeros(byte, now_ms)) rows += "stop\n";
    receiver.keep_and_find_stop(byte, now_ms);
    if (remaining > 0) continue;
    if (delay == 0) take_lines(&line, &rows);
    if (!receiver.has_frame()) continue;
    rows += row_of("frame", receiver.bytes(), receiver.length(), kPacketBytes);
    rows += decode_frame(receiver.bytes(), receiver.length()) != 0 ? " whole\n" : " damaged\n";
    remaining = static_cast<uint8_t>(delay + 1);
    if (delay == 0) {
      receiver.release();
      remaining = 0;
    }
  }
  take_lines(&line, &rows);
  char row[40];
  snprintf(row, sizeof row, "damaged %u, dropped %u\n", receiver.damaged(), receiver.dropped());
  answer->text(rows + row);
}

// H: a key, and a message: its hash.
void answer_hash(RequestReader* request, Writer* answer) {
  uint8_t key[kKeyBytes];
  for (uint8_t& byte : key) byte = request->u8();
  const Bytes message = request->bytes();
  uint8_t hash[kHashBytes];
  siphash(key, message.data.get(), static_cast<uint8_t>(message.length), hash);
  for (const uint8_t byte : hash) answer->u8(byte);
}

// X: a seal, the counters of both directions, and frames (with their COBS byte): one whose payload
// ends after its `0` and counter are left free, which is closed, and one that is opened. Says the
// closed one, or nothing where no counter is left, and whether the other one is taken.
void answer_seal(RequestReader* request, Writer* answer) {
  uint8_t key[kKeyBytes];
  for (uint8_t& byte : key) byte = request->u8();
  uint8_t challenge[kChallengeBytes];
  for (uint8_t& byte : challenge) byte = request->u8();
  SealOrigin origin = {challenge, 0, 0, 0, 0};
  origin.nonce = request->u32();
  origin.robot_nonce = request->u32();
  origin.epoch = request->u8();
  origin.kind = request->u8();
  TestedSeal seal = TestedSeal();
  seal.begin(key, origin);
  seal.set_received_counter(request->u32());
  seal.set_sent_counter(request->u32());
  const Bytes open_frame = request->bytes();
  const Bytes sealed_frame = request->bytes();
  uint8_t frame[kWireBytes + kTagBytes] = {};
  std::copy(open_frame.data.get(), open_frame.data.get() + open_frame.length, frame);
  std::string closed_frame;
  if (seal.may_close()) {
    const uint8_t end = seal.close(frame, static_cast<uint8_t>(open_frame.length));
    closed_frame.assign(frame, frame + end);
  }
  answer->text(closed_frame);
  answer->u8(seal.open(sealed_frame.data.get(), static_cast<uint8_t>(sealed_frame.length)));
}

// M: the image that the robot holds, and whether it is what a robot may run.
void answer_image(RequestReader*, Writer* answer) { answer->text(port.held_image); }

const Answers answers = {
    {'B', answer_begin},
    {'S', answer_step},
    {'R', answer_robot},
    {'I', answer_packets},
    {'H', answer_hash},
    {'X', answer_seal},
    {'M', answer_image},
};

}  // namespace

// For who loads it as a library: the answer to a request, until the next one.
extern "C" const char* link_answer(const char* request_data, uint32_t length,
                                   uint32_t* answer_length);
extern "C" const char* link_answer(const char* request_data, uint32_t length,
                                   uint32_t* answer_length) {
  static Writer reply;
  reply = Writer();
  if (!answer_request(answers, std::string(request_data, request_data + length), &reply)) abort();
  *answer_length = static_cast<uint32_t>(reply.data().size());
  return reply.data().data();
}

int main() { return answer_all_requests(answers) ? 0 : 1; }
