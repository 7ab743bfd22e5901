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
    uint64_t bits = state_ += 0x9e3779b97f4a7c15;
    bits = (bits ^ bits >> 30) * 0xbf58476d1ce4e5b9;
    bits = (bits ^ bits >> 27) * 0x94d049bb133111eb;
    return bits ^ bits >> 31;
  }

  // 0 to `count` - 1
  uint32_t number_below(size_t count) {
    return static_cast<uint32_t>((next() >> 32) * count >> 32);
  }
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

  bool is(const uint8_t* other_bytes, uint8_t other_length) const {
    return length == other_length && memcmp(bytes, other_bytes, length) == 0;
  }
};

SentFrame sent_frames[kFrames];
std::string stream;   // what arrives of a line
std::string failure;  // what must not be, or nothing

// -- what is sent -----------------------------------------------------------------------------------

// Returns a frame on the wire. Its payload begins with its number; in one of four frames it repeats
// few values, so that COBS has much to do.
std::string next_frame(uint32_t number, Draw* draw, bool may_repeat) {
  uint8_t frame[kWireBytes] = {};
  const uint8_t payload =
      static_cast<uint8_t>(kNumberBytes + draw->number_below(kPayloadBytes - kNumberBytes + 1));
  const uint8_t start = payload_at(static_cast<uint8_t>(kPayloadAt + payload));
  const uint8_t end = static_cast<uint8_t>(start + payload);
  frame[kTypeAt] = kTypes[draw->number_below(sizeof kTypes)];
  frame[kSeqAt] = static_cast<uint8_t>(draw->byte());
  frame[kEpochAt] = static_cast<uint8_t>(draw->byte());
  memcpy(frame + start, &number, kNumberBytes);
  const bool repeats = may_repeat && draw->number_below(4) == 0;
  for (uint8_t k = static_cast<uint8_t>(start + kNumberBytes); k < end; k++) {
    frame[k] = repeats ? "\0\0\1S\n"[draw->number_below(5)] : static_cast<uint8_t>(draw->byte());
  }
  SentFrame* const sent_frame = &sent_frames[number];
  sent_frame->length = static_cast<uint8_t>(end - kTypeAt);
  sent_frame->is_accepted = false;
  memcpy(sent_frame->bytes, frame + kTypeAt, sent_frame->length);
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

void damage_once(std::string* bytes, Draw* draw) {
  const size_t place = draw->number_below(bytes->size());
  const size_t insert_index = draw->number_below(bytes->size() + 1);
  char& byte = (*bytes)[place];
  switch (static_cast<Damage>(draw->number_below(kDamages))) {
    case Damage::kLost:
      bytes->erase(place, 1);
      break;
    case Damage::kChanged:
      byte = static_cast<char>(byte ^ static_cast<char>(1 + draw->number_below(255)));
      break;
    case Damage::kBit:
      byte = static_cast<char>(byte ^ 1 << draw->number_below(8));
      break;
    case Damage::kZero:
      byte = 0;
      break;
    case Damage::kDoubled:
      bytes->insert(place, 1, byte);
      break;
    case Damage::kSwapped:
      if (place + 1 < bytes->size()) std::swap(byte, (*bytes)[place + 1]);
      break;
    case Damage::kInserted:
      bytes->insert(insert_index, 1, draw->byte());
      break;
    case Damage::kCut:
      bytes->erase(place, 1 + draw->number_below(19));
      break;
    case Damage::kJoined:
      bytes->pop_back();
      break;
    case Damage::kBurst:
      for (size_t k = place, end = place + 2 + draw->number_below(7); k < end && k < bytes->size();
           k++) {
        (*bytes)[k] = draw->byte();
      }
      break;
    case Damage::kNoise:
      for (uint32_t count = 1 + draw->number_below(12); count > 0; count--) {
        bytes->insert(insert_index, 1, draw->byte());
      }
      break;
    case Damage::kTalkedOver:
      bytes->insert(insert_index, kTexts[draw->number_below(sizeof kTexts / sizeof *kTexts)]);
      break;
  }
}

// Fills `sent_frames` and `stream`, which begins with a 0x00 as whoever sends frames does. Returns how many
// frames are damaged: one to three times, half of them or none.
uint32_t send_line(uint64_t seed, bool may_damage = true, bool may_repeat = true) {
  Draw draw(seed);
  uint32_t damaged_count = 0;
  stream.assign(1, '\0');
  for (uint32_t number = 0; number < kFrames; number++) {
    const std::string frame = next_frame(number, &draw, may_repeat);
    std::string damaged_frame = frame;
    if (may_damage && draw.number_below(2) == 0) {
      const uint8_t times = "\1\1\2\3"[draw.number_below(4)];
      for (uint8_t k = 0; k < times && !damaged_frame.empty(); k++)
        damage_once(&damaged_frame, &draw);
    }
    sent_frames[number].is_damaged = damaged_frame != frame;
    damaged_count += sent_frames[number].is_damaged;
    stream += damaged_frame;
  }
  return damaged_count;
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
  const char* problem = nullptr;
  uint32_t least_number = 0;  // the number that is accepted at the earliest
  receive_line([&](const uint8_t* bytes, uint8_t length) {
    const uint8_t payload_start =
        static_cast<uint8_t>(payload_at(static_cast<uint8_t>(kTypeAt + length)) - kTypeAt);
    uint32_t number = kFrames;
    if (length >= payload_start + kNumberBytes)
      memcpy(&number, bytes + payload_start, kNumberBytes);
    if (number >= kFrames || !sent_frames[number].is(bytes, length)) {
      problem = "a frame that nobody has sent was accepted";
    } else if (number < least_number) {
      problem = "a frame came twice, or before one that was sent earlier";
    } else {
      sent_frames[number].is_accepted = true;
      least_number = number + 1;
    }
  });
  for (uint32_t k = 0; k < kFrames; k++) {
    const bool is_clear = !sent_frames[k].is_damaged && (k == 0 || !sent_frames[k - 1].is_damaged);
    if (is_clear && !sent_frames[k].is_accepted)
      problem = "a frame is lost without damage to it or the one before";
  }
  if (problem != nullptr) failure = std::string(problem) + ", line " + std::to_string(seed);
}

// -- typed stops ------------------------------------------------------------------------------------

// How many typed stops a line of frames holds for the receiver, as the link takes them: where bytes
// arrive, or after a frame that is not whole.
uint32_t count_typed_stops() {
  Receiver receiver = Receiver();
  uint32_t stop_count = 0;
  uint8_t text;
  for (const char byte : stream) {
    const bool are_zeros = receiver.count_zeros(static_cast<uint8_t>(byte), 0);
    if (receiver.keep_and_find_stop(static_cast<uint8_t>(byte), 0) && !are_zeros) stop_count++;
    while (receiver.has_text() && receiver.take_text(&text)) {
    }
    if (!receiver.has_frame()) continue;
    const bool may_stop = receiver.frame_may_stop();
    if (decode_frame(receiver.bytes(), receiver.length()) == 0 && may_stop) stop_count++;
    receiver.let_frame();
    receiver.release();
  }
  return stop_count;
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
bool ends_with(const std::string& text, const char* end) {
  const size_t length = strlen(end);
  return text.size() >= length && text.compare(text.size() - length, length, end) == 0;
}

// The bytes without cursor keys, and without the beginning of one.
std::string remove_keys(const std::string& bytes) {
  std::string text;
  for (size_t k = 0; k < bytes.size(); k++) {
    if (bytes[k] != 0x1b) {
      text += bytes[k];
      continue;
    }
    if (k + 1 == bytes.size() || (bytes[k + 1] != '[' && bytes[k + 1] != 'O')) continue;
    for (k++; k + 1 < bytes.size() && bytes[k + 1] >= ' ' && bytes[k + 1] < '@';) k++;
    if (k + 1 < bytes.size() && bytes[k + 1] >= '@' && bytes[k + 1] <= '~') k++;
  }
  return text;
}

std::string lower_case(const std::string& bytes) {
  std::string letters;
  for (const char byte : bytes)
    letters += byte >= 'A' && byte <= 'Z' ? static_cast<char>(byte | 0x20) : byte;
  return letters;
}

// Whether a line of text is a typed stop: of words of S and STOP the last one counts, none in a comment.
Law law_of_line(const std::string& line) {
  std::string letters;
  bool is_deleted = false;  // maybe an S that had made another one one
  char previous = 0;
  for (const char byte : lower_case(line)) {
    if (byte == ' ' || byte == '\t') continue;
    if (byte == '/' && previous == '/') break;
    previous = byte;
    if (byte == '\b' || byte == 0x7f) {
      is_deleted |= letters.size() > 1 && letters.find('s', 1) != std::string::npos;
      if (!letters.empty()) letters.pop_back();
    } else if ((byte >= 'a' && byte <= 'z') || (byte >= '0' && byte <= '9')) {
      letters += byte;
    }
  }
  if (is_deleted) return Law::kEither;
  while (letters.size() > 1 && letters[0] == 's') {
    const size_t word_length = letters.compare(0, 4, "stop") == 0 ? 4 : 1;
    if (word_length == letters.size() || letters[word_length] != 's') break;
    letters.erase(0, word_length);
  }
  for (const char* word : kWords) {
    if (letters == word) return Law::kStop;
  }
  return Law::kNone;
}

// Whether three S or a second STOP end a line that has not ended.
Law law_of_open_line(const std::string& line) {
  std::string letters;
  for (const char byte : lower_case(line)) {
    if (byte != ' ' && byte != '\t') letters += byte;
  }
  if (!ends_with(letters, "sss") && !ends_with(letters, "stopstop")) return Law::kNone;
  if (letters.find_first_of("\b\x7f") != std::string::npos) return Law::kEither;
  return letters.find("//") == std::string::npos ? Law::kStop : Law::kNone;
}

// Whether the part of a frame after its last control byte is one S or STOP, blanks and `;`.
bool is_strict(const std::string& packet) {
  std::string line;
  for (const char byte : lower_case(packet)) {
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
Law law_of(const std::vector<TypedByte>& bytes_so_far, size_t restart, bool is_running) {
  const size_t last_index = bytes_so_far.size() - 1;
  const uint8_t byte = bytes_so_far[last_index].byte;
  size_t silence_start = last_index;  // where the last silence has been
  while (silence_start > 0 && bytes_so_far[silence_start].pause_ms < kSilenceMs) silence_start--;
  size_t packet_start = silence_start;  // where the packet begins
  bool is_framed = false;
  for (size_t k = last_index; k-- > silence_start;) {
    if (bytes_so_far[k].byte != 0) continue;
    packet_start = k + 1;
    is_framed = true;
    break;
  }
  const auto text_between = [&](size_t start, size_t end) {
    std::string part;
    for (size_t k = start; k < end; k++) part += static_cast<char>(bytes_so_far[k].byte);
    return part;
  };
  if (is_framed) {
    size_t end = packet_start;
    while (end < last_index && is_printable(bytes_so_far[end].byte)) end++;
    if (end < last_index) {
      if (end == packet_start || !is_end(bytes_so_far[end].byte)) {  // a frame
        const bool is_held =
            is_end(byte) && is_strict(text_between(std::max(packet_start, restart), last_index));
        return is_held ? Law::kInFrame : Law::kNone;
      }
    } else if (end == packet_start && !is_printable(byte)) {
      return Law::kNone;  // a frame begins, or a 0x00 follows another one
    } else if (byte != 0 && !is_end(byte) && !is_printable(byte)) {
      return Law::kNone;  // it is a frame
    }
  }
  size_t line = last_index;
  while (line > packet_start && !is_end(bytes_so_far[line - 1].byte)) line--;
  const std::string bytes = remove_keys(text_between(std::max(line, restart), last_index));
  const bool is_after_zero = is_framed && line == packet_start;
  // A line of text that has begun before a silence is the same one for some: a control byte in it, say.
  size_t blank_start = line;
  while (line == silence_start && blank_start > 0 && bytes_so_far[blank_start - 1].byte != 0 &&
         !is_end(bytes_so_far[blank_start - 1].byte))
    blank_start--;
  const bool is_new =
      std::all_of(bytes_so_far.begin() + static_cast<long>(blank_start),
                  bytes_so_far.begin() + static_cast<long>(line),
                  [](const TypedByte& typed_byte) { return typed_byte.byte <= ' '; });
  const std::string whole_line = text_between(line, is_end(byte) ? last_index : last_index + 1);
  if (!whole_line.empty() && whole_line.find_first_not_of('\3') == std::string::npos) {
    return is_new ? Law::kWaits : Law::kEither;
  }
  if (byte == 3 && !is_new) return Law::kEither;
  if (is_end(byte)) {
    const Law law = law_of_line(bytes);
    return law == Law::kStop && is_after_zero && !is_strict(bytes) ? Law::kWaits : law;
  }
  if (byte != 0) {
    return is_running ? law_of_open_line(
                            remove_keys(text_between(std::max(line, restart), last_index + 1)))
                      : Law::kNone;
  }
  bool has_begun = false;
  for (const char letter : remove_keys(text_between(line, last_index))) {
    const bool is_skipped = static_cast<uint8_t>(letter) <= ' ' || letter == 0x7f;
    if (!has_begun && is_skipped) continue;
    has_begun = true;
    if (!is_printable(static_cast<uint8_t>(letter))) return Law::kNone;
  }
  const Law law = law_of_line(bytes);
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
const char* const kLineStarts[] = {"\r",   "\n",   "\r\n",   "",       "\b",
                                   "\x1b", "\x7f", "\x1b[A", "\x1bOD", "\x1b[1;5C"};
constexpr uint8_t kFrameStarts = 4;  // the first of these begin a line in a frame, too
constexpr uint8_t kZeroStart = 3;
const char* const kStops[] = {"S", "s", "STOP", "stop", "StOp", " S", "\tS", ";S", "S;", "S ", " ; STOP ;\t", "  s"};
const char* const kLoose[] = {"SS",       "S.",   "Stop.", "stop!",  "S()",     "stop();", "STOP NOW",  "alto", "PARA",
                              "parar",    "pare", "HALT!", "s s s ", "detente", "S;S",     "stopstop;", "S S.", "Stop, now"};

template <typename Item, size_t kCount>
Item pick(const Item (&items)[kCount], Draw* draw) {
  return items[draw->number_below(kCount)];
}

// So many typed stops after bytes that are anything: each byte does what `law_of` says, by a
// receiver and by what an ESP32 has beside it, and the last line stops.
void judge_typed(uint64_t seed) {
  Draw draw(seed);
  Receiver receiver = Receiver();
  StopFinder finder = StopFinder();
  std::vector<TypedByte> typed_bytes;
  size_t restart = 0;
  uint16_t now_ms = 0;
  std::string first_failure;
  bool was_held = false;  // a stop in the frame that has begun
  Law law = Law::kNone;
  const bool is_running = draw.number_below(2) == 0;
  status.state = is_running ? State::kRunning : State::kIdle;
  // Notes what was wrong first, and after which bytes.
  const auto note = [&](const char* complaint) {
    if (!first_failure.empty()) return;
    first_failure = complaint;
    for (size_t k = typed_bytes.size() > 60 ? typed_bytes.size() - 60 : 0; k < typed_bytes.size();
         k++) {
      char part[8];
      snprintf(part, sizeof part, "%s%02x", typed_bytes[k].pause_ms >= kSilenceMs ? " ~" : " ",
               typed_bytes[k].byte);
      first_failure += part;
    }
  };
  const auto put = [&](uint8_t byte, uint16_t pause_ms) {
    const uint8_t previous = typed_bytes.empty() ? 0 : typed_bytes.back().byte;
    const bool may_be_key = previous == 0x1b || previous == '[' || previous == 'O' ||
                            (previous >= ' ' && previous < '@');
    if (may_be_key && pause_ms >= kSilenceMs) {  // a key is not cut by silence
      receiver.put('\n', now_ms);
      finder.put('\n', now_ms);
      typed_bytes.push_back({'\n', 0});
    }
    now_ms = static_cast<uint16_t>(now_ms + pause_ms);
    typed_bytes.push_back({byte, pause_ms});
    if (pause_ms >= kSilenceMs) was_held = false;
    const bool was_waiting = receiver.is_held();
    const bool are_zeros = receiver.count_zeros(byte, now_ms);
    const bool is_stop = receiver.keep_and_find_stop(byte, now_ms);
    const StopKind finder_stop = finder.put(byte, now_ms);
    law = law_of(typed_bytes, restart, is_running);
    if (law == Law::kStop && !is_stop) note("a typed stop is not seen");
    const bool may_wait = law == Law::kInFrame || law == Law::kWaits;
    if (may_wait && !is_stop && !receiver.is_held()) note("a stop that waits is not seen");
    if (law == Law::kNone && is_stop && !was_held) note("a stop that nobody has typed");
    if (law == Law::kNone && receiver.is_held() && !was_waiting)
      note("a stop waits that nobody has typed");
    if (is_stop && receiver.due_stop() == Cause::kNone && !receiver.has_mark()) {
      note("the link does not know of a stop");
    }
    const bool is_urgent = is_stop && byte != 0 && !is_end(byte) && !was_held;
    if (restart == 0 && law != Law::kEither) {
      const bool is_in_frame = law == Law::kInFrame;
      const bool ends_waiting = law == Law::kWaits && (byte == 0 || is_end(byte));
      const StopKind expected_stop = is_urgent ? StopKind::kOfRun
                                     : law == Law::kStop || ends_waiting || are_zeros
                                         ? StopKind::kStop
                                     : is_in_frame ? StopKind::kInFrame
                                                   : StopKind::kNothing;
      if (finder_stop != expected_stop && (is_running || finder_stop != StopKind::kOfRun))
        note("a finder says something else");
    }
    if (is_urgent && is_running) restart = typed_bytes.size();
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
  const bool reads_text = draw.number_below(4) != 0;  // otherwise its ring is soon full
  const bool reads_frames = draw.number_below(4) != 0;
  const auto look = [&] {
    if (reads_text) take();
    if (!reads_frames || !receiver.has_frame()) return;
    const bool may_stop = receiver.frame_may_stop();
    if (decode_frame(receiver.bytes(), receiver.length()) == 0 && may_stop) receiver.stop();
    receiver.let_frame();
    receiver.release();
  };
  for (uint32_t parts = draw.number_below(6); parts > 0; parts--) {
    if (draw.number_below(2) == 0) {
      if (draw.number_below(4) == 0) put(0, 0);
      for (const char* letter = pick(kPrefixes, &draw); *letter != 0; letter++)
        put(static_cast<uint8_t>(*letter), 0);
    } else {
      for (uint32_t k = draw.number_below(80); k > 0; k--) {
        const bool is_odd = draw.number_below(4) != 0;
        put(static_cast<uint8_t>(is_odd ? "\0\1S\n s;T\r\x1b[OPp\t5\3SsS/.\b"[draw.number_below(25)]
                                        : draw.byte()),
            static_cast<uint16_t>(draw.number_below(200) == 0 ? 1000 + draw.number_below(500) : 0));
        look();
      }
    }
    look();
  }
  const uint32_t start = draw.number_below(sizeof kLineStarts / sizeof *kLineStarts + 2);
  const bool is_silent = start >= sizeof kLineStarts / sizeof *kLineStarts;
  uint16_t pause_ms = 0;
  if (is_silent) {
    pause_ms = static_cast<uint16_t>(kSilenceMs + draw.number_below(3));
  } else {
    for (const char* letter = kLineStarts[start]; *letter != 0; letter++)
      put(static_cast<uint8_t>(*letter), 0);
    if (*kLineStarts[start] == 0) put(0, 0);
  }
  const bool is_loose = draw.number_below(2) == 0;
  const std::string spelling = is_loose ? pick(kLoose, &draw) : pick(kStops, &draw);
  const size_t old_restart = restart;
  for (const char letter : spelling) {
    put(static_cast<uint8_t>(letter), pause_ms);
    pause_ms = 0;
    look();
  }
  const bool stopped_early = restart != old_restart;  // it has not waited for its line's end
  const bool ends_with_zero = start == kZeroStart && is_loose && draw.number_below(2) == 0;
  put(ends_with_zero ? 0 : static_cast<uint8_t>("\r\n"[draw.number_below(2)]), 0);
  if (!stopped_early) {
    const bool is_sure = is_silent || start == kZeroStart;
    const bool is_seen = law == Law::kStop || law == Law::kWaits;
    if (is_loose && is_sure && !is_seen) note("the judge does not see the stop");
    if (!is_loose && (is_sure || start < kFrameStarts) && law != Law::kStop &&
        law != Law::kInFrame) {
      note("the judge does not see the strict stop");
    }
  }
  if (law == Law::kInFrame && receiver.is_held()) {  // its packet ends in another way than whole
    const bool is_cut = draw.number_below(2) == 0;
    bool has_stopped = false;
    for (uint32_t k = is_cut ? 1 : 80 * 4; k > 0 && receiver.is_held(); k--) {
      has_stopped = put(is_cut ? 0 : 1, 0);
    }
    const bool is_waiting = receiver.has_frame() && receiver.frame_may_stop();
    if (receiver.is_held() || (!has_stopped && !is_waiting && reads_frames))
      note("a stop in a frame is forgotten");
  }
  if (receiver.has_frame()) receiver.release();
  take();
  if (receiver.has_mark()) note("a mark is not among the text");
  if (!first_failure.empty()) failure = first_failure + ", prefix " + std::to_string(seed);
}

// -- requests ---------------------------------------------------------------------------------------

uint64_t read_seed(RequestReader* request) {
  const uint64_t high = request->u32();
  return high << 32 | request->u32();
}

// J: the seed of a line, and how many lines: how many frames were damaged, and what was wrong.
void answer_judged(RequestReader* request, Writer* answer) {
  uint64_t seed = read_seed(request);
  uint32_t damaged_count = 0;
  failure.clear();
  for (uint32_t lines = request->u32(); lines > 0 && failure.empty(); lines--, seed++) {
    damaged_count += send_line(seed);
    judge_line(seed);
  }
  answer->u32(damaged_count);
  answer->text(failure);
}

// F: the seed of a line, whether frames are damaged and whether some repeat few values, and how many
// lines: how many frames of that kind, and how many typed stops in them.
void answer_false_stops(RequestReader* request, Writer* answer) {
  uint64_t seed = read_seed(request);
  const bool may_damage = request->u8() != 0;
  const bool may_repeat = request->u8() != 0;
  uint32_t stop_count = 0;
  uint32_t frames = 0;
  for (uint32_t lines = request->u32(); lines > 0; lines--, seed++) {
    const uint32_t damaged_count = send_line(seed, may_damage, may_repeat);
    frames += may_damage ? damaged_count : kFrames;
    stop_count += count_typed_stops();
  }
  answer->u32(frames);
  answer->u32(stop_count);
}

// T: the seed of a prefix, and how many prefixes: what was wrong.
void answer_typed(RequestReader* request, Writer* answer) {
  uint64_t seed = read_seed(request);
  failure.clear();
  for (uint32_t prefixes = request->u32(); prefixes > 0 && failure.empty(); prefixes--, seed++) {
    judge_typed(seed);
  }
  answer->text(failure);
}

// L: the seed of a line: what arrives, the frames that were sent and which of them are damaged, and
// the frames that are accepted.
void answer_line(RequestReader* request, Writer* answer) {
  send_line(read_seed(request));
  answer->text(stream);
  answer->u32(kFrames);
  for (const SentFrame& frame : sent_frames) {
    answer->u8(frame.is_damaged);
    answer->text(std::string(frame.bytes, frame.bytes + frame.length));
  }
  std::vector<std::string> accepted;
  receive_line([&](const uint8_t* bytes, uint8_t length) { accepted.emplace_back(bytes, bytes + length); });
  answer->u32(static_cast<uint32_t>(accepted.size()));
  for (const std::string& frame : accepted) answer->text(frame);
}

const Answers answers = {
    {'J', answer_judged},
    {'F', answer_false_stops},
    {'T', answer_typed},
    {'L', answer_line},
};

}  // namespace

int main() { return answer_all_requests(answers) ? 0 : 1; }
