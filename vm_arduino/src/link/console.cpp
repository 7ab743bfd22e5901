#include "console.h"

#include "../vm/bytecode.h"
#include "../vm/has_tasks.h"
#include "../vm/small.h"
#include "port.h"

#ifndef tiniscript_without_text

namespace tiniscript {

namespace {

constexpr uint16_t kPatienceMs = 60000;  // for the rest of a line with a SETUP word or of a block
constexpr uint8_t kBytesATurn = 8;
// So many mistakes are answered without a pause of this length between two bytes: then something that
// echoes or answers each line is on the other side. The next one is told that.
constexpr uint8_t kMostMistakes = 16;
constexpr uint16_t kPauseMs = 5000;
// Of silence behind bytes that no line end follows: it is told, or they are a line where none ends.
constexpr uint16_t kTailMs = 2000;
constexpr uint16_t kWholeMs = 3000;

// What radio modules say, and words that ask for all others; 0x80 in the last letter of each.
const uint8_t kSpoken[] tini_progmem = {'O', 'K' | 0x80, 'A', 'T' | 0x80,
                                        'E', 'R', 'R', 'O', 'R' | 0x80,
                                        'H', 'E', 'L', 'P' | 0x80,
                                        'A', 'Y', 'U', 'D', 'A' | 0x80, 0};
constexpr uint8_t kChatter = 3;  // so many of them
constexpr uint8_t kAsking = 5;

bool is_latched() { return port_status().state >= State::kStopped; }

}  // namespace

void Console::pass(uint16_t passed_ms, bool has_heard) {
  is_due_ = true;
  if (wait_ms_ != 0) {
    wait_ms_ = passed_ms < wait_ms_ ? static_cast<uint16_t>(wait_ms_ - passed_ms) : 0;
    if (has_heard && wait_ms_ < least_wait_ms_) wait_ms_ = least_wait_ms_;
  }
  ends_ms_ = passed_ms < ends_ms_ ? static_cast<uint16_t>(ends_ms_ - passed_ms) : 0;
  quiet_ms_ = passed_ms < kPatienceMs - quiet_ms_ ? static_cast<uint16_t>(quiet_ms_ + passed_ms)
                                                  : kPatienceMs;
}

void Console::discard() {
  wait_ms_ = least_wait_ms_ = kSilenceMs;
  has_told_ = false;
  begin_silence();
  is_open_ = false;
  refused_ = has_tail_ ? Remark::kPause : Remark::kNone;  // the rest of a line is none
  remark_ = Remark::kNone;
  help_ = nullptr;
  starts_.begin(false);
}

void Console::begin_silence() {
  quiet_ms_ = 0;
  is_silent_ = false;
}

// What is left of a lost program is not run alone.
bool Console::drop() {
  const bool is_lost = is_open_ && (is_waiting_ || reader_.has_setup());
  if (is_lost) {
    is_ignoring_ = true;
    begin_silence();
  }
  is_open_ = false;
  return is_lost;
}

tini_noinline Console::Act Console::turn(Receiver* receiver, bool is_heard) {
  uint8_t byte;
  is_due_ = false;
  if (receiver->take_line_end()) ends_ms_ = kPatienceMs;
  for (uint8_t left = kBytesATurn; left != 0; left--) {
    // A stop does not wait until the answers before it are said.
    has_mark_ = receiver->has_mark();
    if (has_answer() && !has_mark_) return Act::kNone;
    if (!receiver->take_text(&byte)) break;
    has_mark_ = receiver->has_mark();
    if (is_silent_ && byte != kLineEnd) end_silence();
    begin_silence();
    if (byte == kLineStop) {
      receiver->take_mark();
      return is_in_block() ? Act::kEnd : Act::kStop;
    }
    if (byte == kLineCut) {
      const bool is_lost = receiver->take_lost();
      if (is_lost) is_ignoring_ = true;  // the line may have opened a block
      refused_ = Remark::kNone;
      drop();
      if (wait_ms_ == 0 && !starts_.is_chatter()) {
        tell(is_lost ? Remark::kCut : Remark::kNoZero, is_heard);
      }
      has_tail_ = false;
      starts_.begin(false);
      continue;
    }
    const Act act = take(byte, is_heard);
    if (act != Act::kNone) return act;
  }
  if (quiet_ms_ >= kPauseMs) mistakes_ = 0;
  if (quiet_ms_ == kPatienceMs) {
    if (is_open_ && is_patient()) say(Remark::kGivenUp);
    is_open_ = false;
  } else if (quiet_ms_ >= kSilenceMs && !is_silent_) {
    is_silent_ = true;
    fall_silent();
  }
  return has_tail_ ? end_tail(is_heard) : Act::kNone;
}

// A second has passed without a byte.
void Console::fall_silent() {
  is_ignoring_ = false;
  if (is_open_ && is_waiting_) say(Remark::kWaiting);
}

// More has come than the end of a line: what was before goes on only where there is time for that.
void Console::end_silence() {
  refused_ = Remark::kNone;
  if (!is_patient()) is_open_ = false;
  starts_.begin(is_open_);
}

void Console::tell(Remark remark, bool is_heard) {
  if (is_heard) return;
  is_talking_ = true;
  say(remark);
}

Console::Act Console::take(uint8_t byte, bool is_heard) {
  if (byte == kLineEnd) {
    const Act act = end_line(is_heard);
    starts_.begin(is_open_);
    return act;
  }
  has_tail_ = true;
  const uint8_t letters = starts_.put(byte);
  if (letters != 0) start_again(letters, is_heard);
  read(byte);
  return Act::kNone;
}

void Console::read(uint8_t byte) {
  if (refused_ != Remark::kNone || (!is_open_ && !begin(byte))) return;
  reader_.put(byte);
  if (!has_moved_ && !is_ignored() && reader_.wants_room()) has_room();
}

// A start of so many letters begins a program in place of what has come before it.
void Console::start_again(uint8_t letters, bool is_heard) {
  if (is_open_ && !starts_.is_message()) tell(Remark::kStartedAgain, is_heard);
  is_open_ = false;
  refused_ = Remark::kNone;
  while (letters != 0) read(starts_.letter(--letters));
}

// Bytes have come, and no line end. A whole program is taken all the same, where no line has ended for
// a minute: some apps end none.
Console::Act Console::end_tail(bool is_heard) {
  if (quiet_ms_ < kTailMs) return Act::kNone;
  if (is_open_ && ends_ms_ == 0 && reader_.has_setup() && reader_.may_end()) {
    if (quiet_ms_ < kWholeMs) return Act::kNone;
    return end_line(is_heard);
  }
  has_tail_ = false;
  if (!is_waiting_ && !starts_.is_chatter()) tell(Remark::kEnter, is_heard);
  return Act::kNone;
}

// Begins a program in memory that nobody uses.
bool Console::begin(uint8_t byte) {
  uint16_t room;
  image_ = port_text_memory(&room, &has_moved_);
  if (image_ == nullptr) {
    refused_ = Remark::kSaving;
    return false;
  }
  reader_.begin(image_ + kHeaderBytes, room);
  // It no longer knows the mistake of the line before, which a stop behind has kept from being said.
  if (remark_ == Remark::kMistake) remark_ = Remark::kNone;
  is_open_ = true;
  has_lost_ = is_waiting_ = false;
  length_ = 0;
  first_ = byte;
  return true;
}

// Moves the program to where there is room for all of it. False: not now.
bool Console::has_room() {
  if (has_moved_) return true;
  has_lost_ = port_status().saved == Saved::kMemory;
  uint16_t room;
  if (!text_may_drive()) {
    refused_ = Remark::kNotOwner;
  } else if (!reader_.has_setup() && is_latched()) {
    refused_ = Remark::kLatched;
  } else {
    refused_ = Remark::kSaving;
    image_ = port_text_room(&room);
    if (image_ != nullptr) {
      refused_ = Remark::kNone;
      reader_.move(image_ + kHeaderBytes, room);
      has_moved_ = true;
      return true;
    }
  }
  is_open_ = false;
  return false;
}

Console::Act Console::end_line(bool is_heard) {
  has_tail_ = false;
  if (refused_ != Remark::kNone && !is_heard) refuse();
  refused_ = Remark::kNone;
  if (!is_open_) return Act::kNone;
  const Text text = reader_.put(kLineEnd);
  const bool has_setup = reader_.has_setup();
  const bool was_waiting = is_waiting_;
  const uint8_t before = length_;
  length_ = reader_.length();
  is_waiting_ = is_open_ = text == Text::kMore;
  // With a comment behind it S is no typed stop, and stops all the same.
  if (text == Text::kProgram && reader_.is_stop()) return has_mark_ ? Act::kNone : Act::kStop;
  if (is_ignored()) {
    is_open_ = is_waiting_ = false;
    if (wait_ms_ != 0 && text != Text::kNothing && !has_told_) {
      has_told_ = true;
      tell(Remark::kPause, is_heard);
    }
    return Act::kNone;
  }
  switch (text) {
    case Text::kMore:
      awaited_ = reader_.awaited();
      if (reader_.is_stop_behind(before)) return Act::kEnd;
      break;
    case Text::kProgram:
      is_ignoring_ = false;
      is_talking_ = true;
      if (reader_.start() == kStartPing) {
        say(Remark::kHello);
      } else if (has_room()) {
        is_open_ = false;
        return Act::kStart;
      } else {
        refuse();
      }
      break;
    case Text::kProblem:
      is_ignoring_ = has_setup || was_waiting;
      if (!has_mark_ && first_ != '+' && !is_heard && mistakes_ <= kMostMistakes) {
        const uint8_t word = reader_.find_unknown(kSpoken);
        if (word < kChatter) break;
        is_talking_ = true;
        say(mistakes_ == kMostMistakes ? Remark::kMute
            : word < kAsking           ? Remark::kHelp
                                       : Remark::kMistake);
        mistakes_++;
      }
      break;
    case Text::kGoesOn:
    case Text::kNothing:
      break;
  }
  return Act::kNone;
}

// Whether the line is read, and nothing but S does anything.
bool Console::is_ignored() const {
  return wait_ms_ != 0 || (is_ignoring_ && !reader_.has_setup());
}

// Says why the line cannot be read now.
void Console::refuse() {
  is_talking_ = true;
  say(refused_);
  refused_ = Remark::kNone;
}

// Whether there is time for the rest of the line: it begins with a SETUP word, or a block is open.
bool Console::is_patient() {
  return is_waiting_ || reader_.has_setup() || reader_.may_have_setup();
}

}  // namespace tiniscript

#endif  // tiniscript_without_text
