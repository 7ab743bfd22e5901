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
const uint8_t kTypes[] = {1, 2, 3, 4, 5, 6, 7, 8, 9, 11, 12, 14, 15, 16, 17, 18, 19, 20, 21, 22, 23};
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
std::string next_frame(uint32_t number, Draw* draw, bool may_repeat) {
  uint8_t frame[kWireBytes] = {};
  const uint8_t payload = static_cast<uint8_t>(kNumberBytes + draw->below(kPayloadBytes - kNumberBytes + 1));
  const uint8_t begin = payload_at(static_cast<uint8_t>(kPayloadAt + payload));
  const uint8_t end = static_cast<uint8_t>(begin + payload);
  frame[kTypeAt] = kTypes[draw->below(sizeof kTypes)];
  frame[kSeqAt] = static_cast<uint8_t>(draw->byte());
  frame[kEpochAt] = static_cast<uint8_t>(draw->byte());
  memcpy(frame + begin, &number, kNumberBytes);
  const bool repeats = may_repeat && draw->below(4) == 0;
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

// Fills `sent` and `stream`, which begins with a 0x00 as whoever sends frames does. Returns how many
// frames are damaged: one to three times, half of them or none.
uint32_t send_line(uint64_t seed, bool may_damage = true, bool may_repeat = true) {
  Draw draw(seed);
  uint32_t damaged = 0;
  stream.assign(1, '\0');
  for (uint32_t number = 0; number < kFrames; number++) {
    const std::string frame = next_frame(number, &draw, may_repeat);
    std::string way = frame;
    if (may_damage && draw.below(2) == 0) {
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

// -- typed stops ------------------------------------------------------------------------------------

// How many typed stops a line of frames holds for the receiver, as the link takes them: where bytes
// arrive, or behind a frame that is not whole.
uint32_t count_typed_stops() {
  Receiver receiver = Receiver();
  uint32_t stops = 0;
  uint8_t text;
  for (const char byte : stream) {
    const bool are_zeros = receiver.stops(static_cast<uint8_t>(byte), 0);
    if (receiver.take(static_cast<uint8_t>(byte), 0) && !are_zeros) stops++;
    while (receiver.has_text() && receiver.take_text(&text)) {
    }
    if (!receiver.has_frame()) continue;
    const bool may_stop = receiver.frame_may_stop();
    if (decode_frame(receiver.bytes(), receiver.length()) == 0 && may_stop) stops++;
    receiver.let_frame();
    receiver.release();
  }
  return stops;
}

// A byte and how long nothing came before it.
struct Typed {
  uint8_t byte;
  uint16_t pause_ms;
};

bool is_in(uint8_t byte, const char* some) { return byte != 0 && strchr(some, byte) != nullptr; }

// Whether the last of these bytes ends a typed stop: read backwards from it, unlike `TypedStop`.
bool ends_typed_stop(const std::vector<Typed>& all) {
  size_t at = all.size() - 1;
  if (!is_in(all[at].byte, "\r\n") || all[at].pause_ms >= kSilenceMs) return false;
  // Whether a line begins here: nothing is to be read before `at`.
  const auto begins = [&] {
    if (at == 0 || all[at].pause_ms >= kSilenceMs) return true;
    const uint8_t before = all[at - 1].byte;
    if ((before < ' ' && before != '\t') || before == 0x7f) return true;
    if (before < '@' || before > '~') return false;
    size_t key = at - 1;
    while (key > 0 && all[key].pause_ms < kSilenceMs && all[key - 1].byte >= '0' && all[key - 1].byte < '@') key--;
    return key > 1 && all[key].pause_ms < kSilenceMs && all[key - 1].pause_ms < kSilenceMs &&
           is_in(all[key - 1].byte, "[O") && all[key - 2].byte == 0x1b;
  };
  const auto skip = [&] {
    while (!begins() && is_in(all[at - 1].byte, " \t;")) at--;
  };
  skip();
  const size_t end = at;
  for (const char* letter = "POTS"; *letter != 0; letter++) {
    if (*letter == 'P' && at > 0 && is_in(all[at - 1].byte, "sS")) letter += 3;
    if (begins() || !is_in(all[at - 1].byte, std::string{*letter, static_cast<char>(*letter | 0x20)}.c_str()))
      return false;
    at--;
  }
  if (end == at) return false;
  if (begins()) return true;
  // A key's sequence may end in S itself; a line that has begun behind it is found above.
  skip();
  return begins();
}

const char* const kPrefixes[] = {
    "\r\n", "\r\r", "\n", "\t\t", "5\n", "\x1b[A", "\x1b[1;5C", "\x1bOB", "\b", "\x7f", "(\n", " \n",
    "SI|F(60,80)", "SI|LOOP(3)\n", "F(2,\n", "// x", "S", "STOP", "ST", "\x1b", "\x1b[", ";", " ", "\t", "\n",
};
const char* const kBegins[] = {"\r", "\n", "\r\n", "", "\b", "\x1b", "\x7f", "\x1b[A", "\x1bOD", "\x1b[1;5C"};
const char* const kStops[] = {"S", "s", "STOP", "stop", "StOp", " S", "\tS", ";S", "S;", "S ", " ; STOP ;\t", "  s"};

// So many typed stops behind bytes that are anything: each is seen at its end, or held where it is
// in what began as a frame, until that ends. And what the matcher says of all bytes before it is
// what `ends_typed_stop` says.
void judge_typed(uint64_t seed) {
  Draw draw(seed);
  Receiver receiver = Receiver();
  std::vector<Typed> all;
  uint16_t now_ms = 0;
  const char* what = nullptr;
  bool was_held = false;
  const auto put = [&](uint8_t byte, uint16_t pause_ms) {
    now_ms = static_cast<uint16_t>(now_ms + pause_ms);
    all.push_back({byte, pause_ms});
    was_held = receiver.is_held();
    const bool are_zeros = receiver.stops(byte, now_ms);
    const bool is_stop = receiver.take(byte, now_ms);
    const bool is_typed = ends_typed_stop(all);
    if (is_typed && !is_stop && !receiver.is_held()) what = "a typed stop is not seen";
    if (is_stop && !is_typed && !was_held && !are_zeros) what = "a stop that nobody has typed";
    if (is_stop && receiver.due_stop() == Cause::kNone && !receiver.has_mark()) {
      what = "the link does not know of a stop";
    }
    return is_stop;
  };
  const auto take = [&] {
    uint8_t text;
    while (receiver.take_text(&text)) {
      if (text == kLineStop) receiver.take_mark();
    }
  };
  const bool reads_text = draw.below(4) != 0;   // otherwise its ring is soon full
  const bool reads_frames = draw.below(4) != 0;
  const auto look = [&] {
    if (reads_text) take();
    if (!reads_frames || !receiver.has_frame()) return;
    const bool may_stop = receiver.frame_may_stop();
    if (decode_frame(receiver.bytes(), receiver.length()) == 0 && may_stop) receiver.stop();
    receiver.let_frame();
    receiver.release();
  };
  receiver.keep_line(draw.below(2) == 0);
  for (uint32_t parts = draw.below(6); parts > 0; parts--) {
    if (draw.below(2) == 0) {
      const char* const prefix = kPrefixes[draw.below(sizeof kPrefixes / sizeof *kPrefixes)];
      for (const char* at = prefix; *at != 0; at++) put(static_cast<uint8_t>(*at), 0);
    } else {
      for (uint32_t k = draw.below(80); k > 0; k--) {
        const bool is_odd = draw.below(4) != 0;
        put(static_cast<uint8_t>(is_odd ? "\0\1S\n s;T\r\x1b[OPp\t5"[draw.below(18)] : draw.byte()),
            static_cast<uint16_t>(draw.below(200) == 0 ? 1000 + draw.below(500) : 0));
        look();
      }
    }
    look();
  }
  const uint32_t begin = draw.below(sizeof kBegins / sizeof *kBegins + 2);
  uint16_t pause_ms = 0;
  if (begin < sizeof kBegins / sizeof *kBegins) {
    for (const char* at = kBegins[begin]; *at != 0; at++) put(static_cast<uint8_t>(*at), 0);
    if (*kBegins[begin] == 0) put(0, 0);
  } else {
    pause_ms = static_cast<uint16_t>(kSilenceMs + draw.below(3));
  }
  for (const char* at = kStops[draw.below(sizeof kStops / sizeof *kStops)]; *at != 0; at++) {
    put(static_cast<uint8_t>(*at), pause_ms);
    pause_ms = 0;
    look();
  }
  if (!ends_typed_stop([&] { auto ended = all; ended.push_back({'\n', 0}); return ended; }())) {
    what = "the judge does not see the stop";
  }
  const bool is_stop = put(static_cast<uint8_t>("\r\n"[draw.below(2)]), 0);
  if (!is_stop && !receiver.is_held()) what = "the last stop is not seen";
  if (receiver.is_held()) {  // its packet ends in another way than whole
    const bool is_cut = draw.below(2) == 0;
    bool has_stopped = false;
    for (uint32_t k = is_cut ? 1 : 80 * 4; k > 0 && receiver.is_held(); k--) {
      has_stopped = put(is_cut ? 0 : 1, 0);
    }
    const bool waits = receiver.has_frame() && receiver.frame_may_stop();
    if (receiver.is_held() || (!has_stopped && !waits && reads_frames)) what = "a stop in a frame is forgotten";
  }
  if (receiver.has_frame()) receiver.release();
  take();
  if (receiver.has_mark()) what = "a mark is not among the text";
  if (what != nullptr) wrong = std::string(what) + ", prefix " + std::to_string(seed);
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

// F: the seed of a line, whether frames are damaged and whether some repeat few values, and how many
// lines: how many frames of that kind, and how many typed stops in them.
void answer_false_stops(RequestReader* request, Writer* answer) {
  uint64_t seed = seed_of(request);
  const bool may_damage = request->u8() != 0;
  const bool may_repeat = request->u8() != 0;
  uint32_t stops = 0;
  uint32_t frames = 0;
  for (uint32_t lines = request->u32(); lines > 0; lines--, seed++) {
    const uint32_t damaged = send_line(seed, may_damage, may_repeat);
    frames += may_damage ? damaged : kFrames;
    stops += count_typed_stops();
  }
  answer->u32(frames);
  answer->u32(stops);
}

// T: the seed of a prefix, and how many prefixes: what was wrong.
void answer_typed(RequestReader* request, Writer* answer) {
  uint64_t seed = seed_of(request);
  wrong.clear();
  for (uint32_t prefixes = request->u32(); prefixes > 0 && wrong.empty(); prefixes--, seed++) {
    judge_typed(seed);
  }
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

const Answers answers = {
    {'J', answer_judged},
    {'F', answer_false_stops},
    {'T', answer_typed},
    {'L', answer_line},
};

}  // namespace

int main() { return all_answered(answers) ? 0 : 1; }
