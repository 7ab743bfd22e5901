// Frames that are damaged on their way, as many as one likes, and the receiver of a robot. None that
// was changed may be accepted, and damage may cost the frame behind it, no other.
//
// A line is a thousand frames, half of them damaged; its seed determines all of it. A request is
// four bytes of length and a letter with what it asks, an answer four bytes of length and what was
// found. `tests/machines/damage.py` is the other side. Ends with its input.

#include <stdint.h>
#include <string.h>

#include <string>
#include <vector>

#include "../../src/link/frames.h"
#include "../../src/link/receiver.h"
#include "../host/wire.h"

using namespace tiniscript;

namespace {

constexpr uint32_t kFrames = 1024;  // of a line
constexpr uint8_t kNumberBytes = 4;
constexpr uint8_t kTypes = 14;  // from 1 on
constexpr const char* kTexts[] = {"OK+LOST", "OK+LOST\r\n", "+DISC:SUCCESS\r\n"};  // of radio modules

// SplitMix64: a generator whose states are the numbers.
class Draw {
 public:
  explicit Draw(uint64_t seed) : state_(seed) {}

  uint64_t next() {
    uint64_t mixed = state_ += 0x9e3779b97f4a7c15;
    mixed = (mixed ^ mixed >> 30) * 0xbf58476d1ce4e5b9;
    mixed = (mixed ^ mixed >> 27) * 0x94d049bb133111eb;
    return mixed ^ mixed >> 31;
  }

  // 0 to `count` - 1
  uint32_t below(size_t count) { return static_cast<uint32_t>((next() >> 32) * count >> 32); }
  char byte() { return static_cast<char>(next()); }

 private:
  uint64_t state_;
};

// A frame as it was sent, from its type to the end of its payload.
struct Sent {
  uint8_t bytes[kWireBytes];
  uint8_t length;
  bool is_damaged;
  bool is_accepted;

  bool is(const uint8_t* other, uint8_t length_of_other) const {
    return length == length_of_other && memcmp(bytes, other, length) == 0;
  }
};

Sent sent[kFrames];
std::string stream;  // what arrives of a line
std::string wrong;   // what must not be, or nothing

// -- what is sent -----------------------------------------------------------------------------------

// Returns a frame on the wire. Its payload begins with its number; in one of four frames it repeats
// few values, so that COBS has much to do.
std::string next_frame(uint32_t number, Draw* draw) {
  uint8_t frame[kWireBytes] = {};
  const uint8_t payload = static_cast<uint8_t>(kNumberBytes + draw->below(kPayloadBytes - kNumberBytes + 1));
  const uint8_t begin = payload_at(static_cast<uint8_t>(kPayloadAt + payload));
  const uint8_t end = static_cast<uint8_t>(begin + payload);
  frame[kTypeAt] = static_cast<uint8_t>(1 + draw->below(kTypes));
  frame[kSeqAt] = static_cast<uint8_t>(draw->byte());
  frame[kEpochAt] = static_cast<uint8_t>(draw->byte());
  memcpy(frame + begin, &number, kNumberBytes);
  const bool repeats = draw->below(4) == 0;
  for (uint8_t k = static_cast<uint8_t>(begin + kNumberBytes); k < end; k++) {
    frame[k] = repeats ? "\0\0\1S\n"[draw->below(5)] : static_cast<uint8_t>(draw->byte());
  }
  Sent* const here = &sent[number];
  here->length = static_cast<uint8_t>(end - kTypeAt);
  here->is_accepted = false;
  memcpy(here->bytes, frame + kTypeAt, here->length);
  const uint8_t size = encode_frame(frame, end);
  return std::string(frame, frame + size);
}

enum class Damage : uint8_t {
  kLost,
  kChanged,
  kBit,
  kZero,  // a framing error
  kDoubled,
  kSwapped,
  kInserted,
  kCut,
  kJoined,
  kBurst,
  kNoise,
  kTalkedOver,
};
constexpr uint8_t kDamages = static_cast<uint8_t>(Damage::kTalkedOver) + 1;

void damage_once(std::string* way, Draw* draw) {
  const size_t at = draw->below(way->size());
  const size_t between = draw->below(way->size() + 1);
  char& byte = (*way)[at];
  switch (static_cast<Damage>(draw->below(kDamages))) {
    case Damage::kLost:
      way->erase(at, 1);
      break;
    case Damage::kChanged:
      byte = static_cast<char>(byte ^ static_cast<char>(1 + draw->below(255)));
      break;
    case Damage::kBit:
      byte = static_cast<char>(byte ^ 1 << draw->below(8));
      break;
    case Damage::kZero:
      byte = 0;
      break;
    case Damage::kDoubled:
      way->insert(at, 1, byte);
      break;
    case Damage::kSwapped:
      if (at + 1 < way->size()) std::swap(byte, (*way)[at + 1]);
      break;
    case Damage::kInserted:
      way->insert(between, 1, draw->byte());
      break;
    case Damage::kCut:
      way->erase(at, 1 + draw->below(19));
      break;
    case Damage::kJoined:
      way->pop_back();
      break;
    case Damage::kBurst:
      for (size_t k = at, end = at + 2 + draw->below(7); k < end && k < way->size(); k++) {
        (*way)[k] = draw->byte();
      }
      break;
    case Damage::kNoise:
      for (uint32_t count = 1 + draw->below(12); count > 0; count--) {
        way->insert(between, 1, draw->byte());
      }
      break;
    case Damage::kTalkedOver:
      way->insert(between, kTexts[draw->below(sizeof kTexts / sizeof *kTexts)]);
      break;
  }
}

// Fills `sent` and `stream`. Returns how many frames are damaged: one to three times, half of them.
uint32_t send_line(uint64_t seed) {
  Draw draw(seed);
  uint32_t damaged = 0;
  stream.clear();
  for (uint32_t number = 0; number < kFrames; number++) {
    const std::string frame = next_frame(number, &draw);
    std::string way = frame;
    if (draw.below(2) == 0) {
      const uint8_t times = "\1\1\2\3"[draw.below(4)];
      for (uint8_t k = 0; k < times && !way.empty(); k++) damage_once(&way, &draw);
    }
    sent[number].is_damaged = way != frame;
    damaged += sent[number].is_damaged;
    stream += way;
  }
  return damaged;
}

// -- what arrives -----------------------------------------------------------------------------------

// Passes the stream to a receiver; calls `found` with each frame that it accepts, from its type on.
template <typename Found>
void receive_line(Found found) {
  Receiver receiver = Receiver();
  uint8_t text;
  for (const char byte : stream) {
    receiver.put(static_cast<uint8_t>(byte), 0);
    while (receiver.has_text() && receiver.take_text(&text)) {
    }
    if (!receiver.has_frame()) continue;
    uint8_t* const bytes = receiver.bytes();
    const uint8_t end = decode_frame(bytes, receiver.length());
    if (end != 0) found(bytes + kTypeAt, static_cast<uint8_t>(end - kTypeAt));
    receiver.release();
  }
}

// Says of the line that was sent what must not be, as `judge` of the tests does.
void judge_line(uint64_t seed) {
  const char* what = nullptr;
  uint32_t next = 0;  // the number that is accepted at the earliest
  receive_line([&](const uint8_t* bytes, uint8_t length) {
    const uint8_t at = static_cast<uint8_t>(payload_at(static_cast<uint8_t>(kTypeAt + length)) - kTypeAt);
    uint32_t number = kFrames;
    if (length >= at + kNumberBytes) memcpy(&number, bytes + at, kNumberBytes);
    if (number >= kFrames || !sent[number].is(bytes, length)) {
      what = "a frame that nobody has sent was accepted";
    } else if (number < next) {
      what = "a frame came twice, or before one that was sent earlier";
    } else {
      sent[number].is_accepted = true;
      next = number + 1;
    }
  });
  for (uint32_t k = 0; k < kFrames; k++) {
    const bool is_clear = !sent[k].is_damaged && (k == 0 || !sent[k - 1].is_damaged);
    if (is_clear && !sent[k].is_accepted) what = "a frame is lost without damage to it or the one before";
  }
  if (what != nullptr) wrong = std::string(what) + ", line " + std::to_string(seed);
}

// -- requests ---------------------------------------------------------------------------------------

uint64_t seed_of(RequestReader* request) {
  const uint64_t high = request->u32();
  return high << 32 | request->u32();
}

// J: the seed of a line, and how many lines: how many frames were damaged, and what was wrong.
void answer_judged(RequestReader* request, Writer* answer) {
  uint64_t seed = seed_of(request);
  uint32_t damaged = 0;
  wrong.clear();
  for (uint32_t lines = request->u32(); lines > 0 && wrong.empty(); lines--, seed++) {
    damaged += send_line(seed);
    judge_line(seed);
  }
  answer->u32(damaged);
  answer->text(wrong);
}

// L: the seed of a line: what arrives, the frames that were sent and which of them are damaged, and
// the frames that are accepted.
void answer_line(RequestReader* request, Writer* answer) {
  send_line(seed_of(request));
  answer->text(stream);
  answer->u32(kFrames);
  for (const Sent& each : sent) {
    answer->u8(each.is_damaged);
    answer->text(std::string(each.bytes, each.bytes + each.length));
  }
  std::vector<std::string> accepted;
  receive_line([&](const uint8_t* bytes, uint8_t length) { accepted.emplace_back(bytes, bytes + length); });
  answer->u32(static_cast<uint32_t>(accepted.size()));
  for (const std::string& each : accepted) answer->text(each);
}

}  // namespace

int main() {
  std::string asked;
  while (next_request(&asked)) {
    RequestReader request(asked);
    Writer said;
    switch (request.u8()) {
      case 'J':
        answer_judged(&request, &said);
        break;
      case 'L':
        answer_line(&request, &said);
        break;
      default:
        return 1;
    }
    send_answer(said);
  }
  return 0;
}
