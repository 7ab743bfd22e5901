// Frames that are damaged on their way, as many as one likes, and the receiver of a robot. None that
// was changed may be accepted, and damage may cost the frame after it, no other.
//
// A line is a thousand frames, half of them damaged; its seed determines all of it. A request is
// four bytes of length and a letter with what it asks, an answer four bytes of length and what was
// found. `tests/machines/damage.py` is the other side. Ends with its input.

#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <algorithm>
#include <string>
#include <vector>

#include "../../src/boards/esp32/stop_finder.h"
#include "../../src/link/frames.h"
#include "../../src/link/port.h"
#include "../../src/link/receiver.h"
#include "../host/wire.h"

using namespace tiniscript;

namespace {

RobotStatus status;

}  // namespace

// Three S stop what runs before their line ends.
const RobotStatus& tiniscript::port_status() { return status; }

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
struct SentFrame {
  uint8_t bytes[kWireBytes];
  uint8_t length;
  bool is_damaged;
  bool is_accepted;

  bool is(const uint8_t* other, uint8_t length_of_other) const {
    return length == length_of_other && memcmp(bytes, other, length) == 0;
  }
};

SentFrame sent[kFrames];
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
  SentFrame* const here = &sent[number];
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

// Passes the stream to a receiver; calls `on_frame` with each frame that it accepts, from its type on.
template <typename OnFrame>
void receive_line(OnFrame on_frame) {
  Receiver receiver = Receiver();
  uint8_t text;
  for (const char byte : stream) {
    receiver.put(static_cast<uint8_t>(byte), 0);
    while (receiver.has_text() && receiver.take_text(&text)) {
    }
    if (!receiver.has_frame()) continue;
    uint8_t* const bytes = receiver.bytes();
    const uint8_t end = decode_frame(bytes, receiver.length());
    if (end != 0) on_frame(bytes + kTypeAt, static_cast<uint8_t>(end - kTypeAt));
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
// arrive, or after a frame that is not whole.
uint32_t count_typed_stops() {
  Receiver receiver = Receiver();
  uint32_t stops = 0;
  uint8_t text;
  for (const char byte : stream) {
    const bool are_zeros = receiver.count_zeros(static_cast<uint8_t>(byte), 0);
    if (receiver.keep_and_find_stop(static_cast<uint8_t>(byte), 0) && !are_zeros) stops++;
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
struct TypedByte {
  uint8_t byte;
  uint16_t pause_ms;
};

// What a stop may be at a byte. kInFrame: of its frame, if that is not whole. kWaits: where silence follows.
// kEither: the laws leave it open, or it depends on what was deleted.
enum class Law : uint8_t { kNone, kStop, kInFrame, kWaits, kEither };

const char* const kWords[] = {"s", "stop", "stopnow", "alto", "para", "parar", "pare", "detente", "halt"};

bool is_end(uint8_t byte) { return byte == '\r' || byte == '\n'; }
bool is_printable(uint8_t byte) { return byte >= ' ' && byte <= '~'; }
bool ends_with(const std::string& all, const char* end) {
  const size_t length = strlen(end);
  return all.size() >= length && all.compare(all.size() - length, length, end) == 0;
}

// The bytes without cursor keys, and without the beginning of one.
std::string without_keys(const std::string& bytes) {
  std::string found;
  for (size_t k = 0; k < bytes.size(); k++) {
    if (bytes[k] != 0x1b) {
      found += bytes[k];
      continue;
    }
    if (k + 1 == bytes.size() || (bytes[k + 1] != '[' && bytes[k + 1] != 'O')) continue;
    for (k++; k + 1 < bytes.size() && bytes[k + 1] >= ' ' && bytes[k + 1] < '@';) k++;
    if (k + 1 < bytes.size() && bytes[k + 1] >= '@' && bytes[k + 1] <= '~') k++;
  }
  return found;
}

std::string small(const std::string& bytes) {
  std::string found;
  for (const char byte : bytes) found += byte >= 'A' && byte <= 'Z' ? static_cast<char>(byte | 0x20) : byte;
  return found;
}

// Whether a line of text is a typed stop: of words of S and STOP the last one counts, none in a comment.
Law of_line(const std::string& line) {
  std::string letters;
  bool is_deleted = false;  // maybe an S that had made another one one
  char before = 0;
  for (const char byte : small(line)) {
    if (byte == ' ' || byte == '\t') continue;
    if (byte == '/' && before == '/') break;
    before = byte;
    if (byte == '\b' || byte == 0x7f) {
      is_deleted |= letters.size() > 1 && letters.find('s', 1) != std::string::npos;
      if (!letters.empty()) letters.pop_back();
    } else if ((byte >= 'a' && byte <= 'z') || (byte >= '0' && byte <= '9')) {
      letters += byte;
    }
  }
  if (is_deleted) return Law::kEither;
  while (letters.size() > 1 && letters[0] == 's') {
    const size_t first = letters.compare(0, 4, "stop") == 0 ? 4 : 1;
    if (first == letters.size() || letters[first] != 's') break;
    letters.erase(0, first);
  }
  for (const char* word : kWords) {
    if (letters == word) return Law::kStop;
  }
  return Law::kNone;
}

// Whether three S or a second STOP end a line that has not ended.
Law of_unended(const std::string& line) {
  std::string near;
  for (const char byte : small(line)) {
    if (byte != ' ' && byte != '\t') near += byte;
  }
  if (!ends_with(near, "sss") && !ends_with(near, "stopstop")) return Law::kNone;
  if (near.find_first_of("\b\x7f") != std::string::npos) return Law::kEither;
  return near.find("//") == std::string::npos ? Law::kStop : Law::kNone;
}

// Whether the part of a frame after its last control byte is one S or STOP, blanks and `;`.
bool is_strict(const std::string& packet) {
  std::string line;
  for (const char byte : small(packet)) {
    if ((static_cast<uint8_t>(byte) < ' ' && byte != '\t') || byte == 0x7f) {
      line.clear();
    } else if (byte != ' ' && byte != '\t' && byte != ';') {
      line += byte;
    }
  }
  return line == "s" || line == "stop";
}

// What the law says of the last of these bytes, by all of them and no state: see the head of
// `receiver.h`. Bytes before `restart` have stopped what runs.
Law law_of(const std::vector<TypedByte>& all, size_t restart, bool is_running) {
  const size_t last = all.size() - 1;
  const uint8_t byte = all[last].byte;
  size_t quiet = last;  // where the last silence has been
  while (quiet > 0 && all[quiet].pause_ms < kSilenceMs) quiet--;
  size_t text = quiet;  // where the packet begins
  bool is_framed = false;
  for (size_t k = last; k-- > quiet;) {
    if (all[k].byte != 0) continue;
    text = k + 1;
    is_framed = true;
    break;
  }
  const auto between = [&](size_t begin, size_t end) {
    std::string found;
    for (size_t k = begin; k < end; k++) found += static_cast<char>(all[k].byte);
    return found;
  };
  if (is_framed) {
    size_t odd = text;
    while (odd < last && is_printable(all[odd].byte)) odd++;
    if (odd < last) {
      if (odd == text || !is_end(all[odd].byte)) {  // a frame
        const bool is_held = is_end(byte) && is_strict(between(std::max(text, restart), last));
        return is_held ? Law::kInFrame : Law::kNone;
      }
    } else if (odd == text && !is_printable(byte)) {
      return Law::kNone;  // a frame begins, or a 0x00 follows another one
    } else if (byte != 0 && !is_end(byte) && !is_printable(byte)) {
      return Law::kNone;  // it is a frame
    }
  }
  size_t line = last;
  while (line > text && !is_end(all[line - 1].byte)) line--;
  const std::string bytes = without_keys(between(std::max(line, restart), last));
  const bool is_after_zero = is_framed && line == text;
  // A line of text that has begun before a silence is the same one for some: a control byte in it, say.
  size_t before = line;
  while (line == quiet && before > 0 && all[before - 1].byte != 0 && !is_end(all[before - 1].byte)) before--;
  const bool is_new = std::all_of(all.begin() + static_cast<long>(before), all.begin() + static_cast<long>(line),
                                  [](const TypedByte& each) { return each.byte <= ' '; });
  const std::string whole = between(line, is_end(byte) ? last : last + 1);
  if (!whole.empty() && whole.find_first_not_of('\3') == std::string::npos) {
    return is_new ? Law::kWaits : Law::kEither;
  }
  if (byte == 3 && !is_new) return Law::kEither;
  if (is_end(byte)) {
    const Law law = of_line(bytes);
    return law == Law::kStop && is_after_zero && !is_strict(bytes) ? Law::kWaits : law;
  }
  if (byte != 0) {
    return is_running ? of_unended(without_keys(between(std::max(line, restart), last + 1))) : Law::kNone;
  }
  bool has_begun = false;
  for (const char each : without_keys(between(line, last))) {
    const bool is_skipped = static_cast<uint8_t>(each) <= ' ' || each == 0x7f;
    if (!has_begun && is_skipped) continue;
    has_begun = true;
    if (!is_printable(static_cast<uint8_t>(each))) return Law::kNone;
  }
  const Law law = of_line(bytes);
  if (law != Law::kStop) return law;
  if (is_after_zero) return Law::kWaits;
  return is_new ? law : Law::kEither;
}

// What senders send before a line, and what people and modules leave unfinished.
const char* const kPrefixes[] = {
    "\r\n", "\r\r", "\n", "\t\t", "5\n", "\x1b[A", "\x1b[1;5C", "\x1bOB", "\b", "\x7f", "(\n", " \n",
    "SI|F(60,80)", "SI|LOOP(3)\n", "F(2,\n", "// x", "S", "STOP", "ST", "\x1b", "\x1b[", ";", " ", "\t", "\n",
    "OK+CONN", "\xef\xbb\xbf", "u", "+DISC:SUCCESS\r\n", "\3", "SS", "F(1,S S", "/", "NOW", "\xc2\xa1", "alt",
};
const char* const kBegins[] = {"\r", "\n", "\r\n", "", "\b", "\x1b", "\x7f", "\x1b[A", "\x1bOD", "\x1b[1;5C"};
constexpr uint8_t kFresh = 4;  // the first of these begin a line in a frame, too
constexpr uint8_t kZeroBegins = 3;
const char* const kStops[] = {"S", "s", "STOP", "stop", "StOp", " S", "\tS", ";S", "S;", "S ", " ; STOP ;\t", "  s"};
const char* const kLoose[] = {"SS",       "S.",   "Stop.", "stop!",  "S()",     "stop();", "STOP NOW",  "alto", "PARA",
                              "parar",    "pare", "HALT!", "s s s ", "detente", "S;S",     "stopstop;", "S S.", "Stop, now"};

template <typename Item, size_t kCount>
Item one_of(const Item (&some)[kCount], Draw* draw) {
  return some[draw->below(kCount)];
}

// So many typed stops after bytes that are anything: each byte does what `law_of` says, by a
// receiver and by what an ESP32 has beside it, and the last line stops.
void judge_typed(uint64_t seed) {
  Draw draw(seed);
  Receiver receiver = Receiver();
  StopFinder finder = StopFinder();
  std::vector<TypedByte> all;
  size_t restart = 0;
  uint16_t now_ms = 0;
  std::string what;
  bool was_held = false;  // a stop in the frame that has begun
  Law law = Law::kNone;
  const bool is_running = draw.below(2) == 0;
  status.state = is_running ? State::kRunning : State::kIdle;
  // Notes what was wrong first, and after which bytes.
  const auto note = [&](const char* complaint) {
    if (!what.empty()) return;
    what = complaint;
    for (size_t k = all.size() > 60 ? all.size() - 60 : 0; k < all.size(); k++) {
      char part[8];
      snprintf(part, sizeof part, "%s%02x", all[k].pause_ms >= kSilenceMs ? " ~" : " ", all[k].byte);
      what += part;
    }
  };
  const auto put = [&](uint8_t byte, uint16_t pause_ms) {
    const uint8_t before = all.empty() ? 0 : all.back().byte;
    const bool may_be_key = before == 0x1b || before == '[' || before == 'O' || (before >= ' ' && before < '@');
    if (may_be_key && pause_ms >= kSilenceMs) {  // a key is not cut by silence
      receiver.put('\n', now_ms);
      finder.put('\n', now_ms);
      all.push_back({'\n', 0});
    }
    now_ms = static_cast<uint16_t>(now_ms + pause_ms);
    all.push_back({byte, pause_ms});
    if (pause_ms >= kSilenceMs) was_held = false;
    const bool waited = receiver.is_held();
    const bool are_zeros = receiver.count_zeros(byte, now_ms);
    const bool is_stop = receiver.keep_and_find_stop(byte, now_ms);
    const StopKind found = finder.put(byte, now_ms);
    law = law_of(all, restart, is_running);
    if (law == Law::kStop && !is_stop) note("a typed stop is not seen");
    const bool may_wait = law == Law::kInFrame || law == Law::kWaits;
    if (may_wait && !is_stop && !receiver.is_held()) note("a stop that waits is not seen");
    if (law == Law::kNone && is_stop && !was_held) note("a stop that nobody has typed");
    if (law == Law::kNone && receiver.is_held() && !waited) note("a stop waits that nobody has typed");
    if (is_stop && receiver.due_stop() == Cause::kNone && !receiver.has_mark()) {
      note("the link does not know of a stop");
    }
    const bool is_urgent = is_stop && byte != 0 && !is_end(byte) && !was_held;
    if (restart == 0 && law != Law::kEither) {
      const bool is_in_frame = law == Law::kInFrame;
      const bool ends_waiting = law == Law::kWaits && (byte == 0 || is_end(byte));
      const StopKind wanted = is_urgent ? StopKind::kOfRun
                           : law == Law::kStop || ends_waiting || are_zeros ? StopKind::kStop
                           : is_in_frame ? StopKind::kInFrame
                                         : StopKind::kNothing;
      if (found != wanted && (is_running || found != StopKind::kOfRun)) note("a finder says something else");
    }
    if (is_urgent && is_running) restart = all.size();
    was_held = byte != 0 && !is_stop && (was_held || law == Law::kInFrame);
    return is_stop;
  };
  const auto take = [&] {
    uint8_t text;
    while (receiver.take_text(&text)) {
      if (text == kLineStop) receiver.take_mark();
    }
    receiver.take_stop();
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
  for (uint32_t parts = draw.below(6); parts > 0; parts--) {
    if (draw.below(2) == 0) {
      if (draw.below(4) == 0) put(0, 0);
      for (const char* at = one_of(kPrefixes, &draw); *at != 0; at++) put(static_cast<uint8_t>(*at), 0);
    } else {
      for (uint32_t k = draw.below(80); k > 0; k--) {
        const bool is_odd = draw.below(4) != 0;
        put(static_cast<uint8_t>(is_odd ? "\0\1S\n s;T\r\x1b[OPp\t5\3SsS/.\b"[draw.below(25)] : draw.byte()),
            static_cast<uint16_t>(draw.below(200) == 0 ? 1000 + draw.below(500) : 0));
        look();
      }
    }
    look();
  }
  const uint32_t begin = draw.below(sizeof kBegins / sizeof *kBegins + 2);
  const bool is_silent = begin >= sizeof kBegins / sizeof *kBegins;
  uint16_t pause_ms = 0;
  if (is_silent) {
    pause_ms = static_cast<uint16_t>(kSilenceMs + draw.below(3));
  } else {
    for (const char* at = kBegins[begin]; *at != 0; at++) put(static_cast<uint8_t>(*at), 0);
    if (*kBegins[begin] == 0) put(0, 0);
  }
  const bool is_loose = draw.below(2) == 0;
  const std::string spelled = is_loose ? one_of(kLoose, &draw) : one_of(kStops, &draw);
  const size_t restarted = restart;
  for (const char letter : spelled) {
    put(static_cast<uint8_t>(letter), pause_ms);
    pause_ms = 0;
    look();
  }
  const bool is_over = restart != restarted;  // it has not waited for its line's end
  const bool ends_with_zero = begin == kZeroBegins && is_loose && draw.below(2) == 0;
  put(ends_with_zero ? 0 : static_cast<uint8_t>("\r\n"[draw.below(2)]), 0);
  if (!is_over) {
    const bool is_sure = is_silent || begin == kZeroBegins;
    const bool is_seen = law == Law::kStop || law == Law::kWaits;
    if (is_loose && is_sure && !is_seen) note("the judge does not see the stop");
    if (!is_loose && (is_sure || begin < kFresh) && law != Law::kStop && law != Law::kInFrame) {
      note("the judge does not see the strict stop");
    }
  }
  if (law == Law::kInFrame && receiver.is_held()) {  // its packet ends in another way than whole
    const bool is_cut = draw.below(2) == 0;
    bool has_stopped = false;
    for (uint32_t k = is_cut ? 1 : 80 * 4; k > 0 && receiver.is_held(); k--) {
      has_stopped = put(is_cut ? 0 : 1, 0);
    }
    const bool waits = receiver.has_frame() && receiver.frame_may_stop();
    if (receiver.is_held() || (!has_stopped && !waits && reads_frames)) note("a stop in a frame is forgotten");
  }
  if (receiver.has_frame()) receiver.release();
  take();
  if (receiver.has_mark()) note("a mark is not among the text");
  if (!what.empty()) wrong = what + ", prefix " + std::to_string(seed);
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
  for (const SentFrame& each : sent) {
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
