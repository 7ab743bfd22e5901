#include "console.h"

#include "../vm/build.h"
#include "../vm/bytecode.h"
#include "../vm/small.h"
#include "port.h"
#include "run_down.h"

#ifndef tiniscript_without_text

namespace tiniscript {

namespace {

constexpr uint8_t kBytesATurn = 8;
constexpr Remark kWholeProgram = Remark::kOk;  // instead of a report: a whole program has come
// After so many mistakes, answers stop until there is a pause of this length between two bytes: the
// other side echoes or answers each line. The next one is told that.
constexpr uint8_t kMaxMistakes = 16;
constexpr uint16_t kPauseMs = 5000;
// Silence after bytes without a line end: it is reported, or it ends the line if they lack line
// ends.
constexpr uint16_t kTailMs = 2000;
constexpr uint16_t kUnendedMs = 3000;
constexpr uint16_t kBriefMs = 150;  // of silence before a line counts again
constexpr uint8_t kCapital = 0xdf;  // bits of a letter

// Messages of radio modules, and words that ask for all others; 0x80 in the last letter of each.
const uint8_t kSpokenWords[] tini_progmem = {'O', 'K' | 0x80, 'A', 'T' | 0x80, 'E', 'R',        'R',
                                             'O', 'R' | 0x80, 'H', 'E',        'L', 'P' | 0x80, 'A',
                                             'Y', 'U',        'D', 'A' | 0x80, 0};
constexpr uint8_t kChatterCount = 3;  // so many of them
constexpr uint8_t kSpokenCount = 5;

}  // namespace

void Console::pass(uint16_t passed_ms, uint16_t silence_left_ms) {
  is_due_ = true;
  run_down(left_ms_, kTimes, passed_ms);
  if (left_ms_[kWait] == 0 && silence_left_ms <= (is_brief_ ? kSilenceMs - kBriefMs : 0)) {
    is_discarding_ = false;
  }
}

void Console::discard() {
  left_ms_[kWait] = kSilenceMs;
  is_discarding_ = true;
  is_brief_ = has_told_pause_ = is_open_ = false;
  refusal_ = tail_ != Remark::kNone ? Remark::kPause : Remark::kNone;  // the rest of a line is none
  remark_ = Remark::kNone;
  next_help_word_ = nullptr;
}

void Console::begin_silence() {
  left_ms_[kPatience] = kPatienceMs;
  is_silent_ = false;
}

// The rest of a lost program does not run alone.
bool Console::drop() {
  const bool is_lost = is_open_ && (is_waiting_ || reader_.has_setup());
  if (is_lost) {
    is_ignoring_ = true;
    begin_silence();
  }
  is_open_ = false;
  return is_lost;
}

tini_noinline Console::Act Console::turn(Receiver* receiver, bool is_heard, bool may_say) {
  uint8_t byte;
  is_due_ = false;
  for (uint8_t bytes_left = kBytesATurn; bytes_left != 0; bytes_left--) {
    // A stop does not wait until the answers before it are said, nor does anything where they wait for
    // frames: of these the last one is said.
    if (has_answer() && may_say && !receiver->has_mark()) return Act::kNone;
    if (!receiver->take_text(&byte)) {
      if (tail_ != kWholeProgram || left_ms_[kPatience] > kPatienceMs - kUnendedMs) break;
      byte = kLineEnd;
    } else if (byte == kLineEnd) {
      left_ms_[kLineEnds] = kPatienceMs;
    }
    has_mark_ = receiver->has_mark();
    if (kReadsKeys && key_line_.is_empty()) line_patience_ms_ = left_ms_[kPatience];
    if (is_silent_ && byte != kLineEnd) end_silence();
    begin_silence();
    if (byte == kLineStop) {
      receiver->take_mark();
      return is_in_block() ? Act::kEnd : Act::kStop;
    }
    if (byte == kLineCut) {
      // A 0x00 is reported a moment later, unless a client comes.
      tail_ = is_chatter() ? Remark::kNone : Remark::kNoZero;
      drop();
      if (receiver->take_is_lost()) {
        is_ignoring_ = true;  // the line may have opened a block
        tell(Remark::kCut, is_heard);
        tail_ = Remark::kNone;
      }
    } else if (byte == kLineEnd) {
      tail_ = Remark::kNone;
    } else {
      take(byte, is_heard);
      continue;
    }
    const bool holds = kReadsKeys && byte == kLineEnd && take_keys();
    if (kReadsKeys) key_line_.begin();
    const Act act = holds               ? Act::kHold
                    : byte == kLineEnd ? end_line(is_heard)
                                        : Act::kNone;
    refusal_ = Remark::kNone;
    start_column_ = 1;
    if (act != Act::kNone) return act;
  }
  const uint16_t left_ms = left_ms_[kPatience];
  if (left_ms <= kPatienceMs - kPauseMs) mistakes_ = 0;
  if (left_ms == 0) {
    if (is_open_) say(Remark::kGivenUp);
    is_open_ = false;
  } else if (left_ms <= kPatienceMs - kSilenceMs && !is_silent_) {
    is_silent_ = true;
    is_ignoring_ = false;
    if (is_open_ && is_waiting_) say(Remark::kWaiting);
  } else if (tail_ > kWholeProgram &&
             left_ms <= kPatienceMs - (tail_ == Remark::kEnter ? kTailMs : kZeroMs)) {
    end_tail(is_heard);
  }
  return Act::kNone;
}

// No line end has followed, and none may come: some apps send no line ends. If no line has ended
// for a minute, a whole program is accepted all the same, but later. Otherwise it is told.
inline void Console::end_tail(bool is_heard) {
  const Remark tail = tail_;
  tail_ = Remark::kNone;
  if (is_open_) {
    if (reader_.has_setup()) {
      if (left_ms_[kLineEnds] == 0 && reader_.may_end()) {
        tail_ = kWholeProgram;
        return;
      }
    } else if (!is_waiting_) {
      const bool is_message = is_chatter();
      is_open_ = false;
      if (is_message) return;
    }
    if (is_waiting_) return;
  }
  tell(tail, is_heard);
}

// A line goes on after a second of silence, or begins there.
inline void Console::end_silence() {
  refusal_ = Remark::kNone;
  start_column_ = static_cast<uint8_t>(reader_.last_column() + 1);
}

void Console::tell(Remark remark, bool is_heard) {
  if (is_heard) return;
  is_talking_ = true;
  say(remark);
}

// Takes a byte of a line. A start begins a program anew where an unfinished one would go on, and
// after a radio module's message, which has no line end of its own. Of its SETUP word, only the
// length and a letter are compared: the reader knows the others.
inline void Console::take(uint8_t byte, bool is_heard) {
  if (kReadsKeys) key_line_.put(byte);
  tail_ = Remark::kEnter;
  read(byte);
  const uint8_t previous = previous_letter_;
  const uint8_t last_letter = last_letter_;
  if (byte <= ' ') return;
  previous_letter_ = last_letter;
  last_letter_ = byte & kCapital;
  const bool is_ping = previous == 'N';
  if (byte != '|' || !is_open_ || (previous != 'S' && !is_ping)) return;
  if (!is_chatter()) {
    if (!is_waiting_ && start_column_ == 1) return;
    const uint8_t letters = is_ping ? 4 : 2;
    if (static_cast<uint8_t>(reader_.last_column() - start_column_) != letters) return;
    tell(Remark::kStartedAgain, is_heard);
  }
  is_open_ = false;
  if (is_ping) {
    read('P');
    read('I');
  }
  read(previous);
  read(last_letter);
  read(byte);
}

// Whether the line begins with a message of a radio module.
bool Console::is_chatter() {
  return is_open_ && (first_byte_ == '+' || reader_.begins_like('O', 'K'));
}

void Console::read(uint8_t byte) {
  if (refusal_ != Remark::kNone || (!is_open_ && !begin(byte))) return;
  reader_.put(byte);
  if (!has_moved_ && !is_ignored() && reader_.wants_room()) find_room();
}

// Begins a program in unused memory.
bool Console::begin(uint8_t byte) {
  uint16_t room;
  image_ = port_text_memory(&room, &has_moved_);
  if (image_ == nullptr) {
    refusal_ = Remark::kSaving;
    return false;
  }
  reader_.begin(image_ + kHeaderBytes, room);
  // It no longer knows the mistake of the line before, which a stop after it has kept from being said.
  if (remark_ == Remark::kMistake) remark_ = Remark::kNone;
  is_open_ = true;
  is_waiting_ = false;
  length_ = 0;
  first_byte_ = byte;
  return true;
}

// Moves the program to where there is room for all of it. False: not now.
bool Console::find_room() {
  if (has_moved_) return true;
  const bool is_lost = port_status().saved == Saved::kMemory;
  uint16_t room;
  if (!text_may_drive()) {
    refusal_ = Remark::kNotOwner;
  } else if (!reader_.has_setup() && port_is_latched()) {
    refusal_ = Remark::kLatched;
  } else {
    refusal_ = Remark::kSaving;
    image_ = port_text_room(&room);
    if (image_ != nullptr) {
      refusal_ = Remark::kNone;
      reader_.move(image_ + kHeaderBytes, room);
      has_moved_ = true;
      if (is_lost) has_lost_program_ = true;
      return true;
    }
  }
  is_open_ = false;
  return false;
}

inline Console::Act Console::end_line(bool is_heard) {
  if (refusal_ != Remark::kNone && !is_heard) refuse();
  if (!is_open_) return Act::kNone;
  const TextState text = reader_.put(kLineEnd);
  const bool has_setup = reader_.has_setup();
  const bool was_waiting = is_waiting_;
  const uint8_t length_before = length_;
  length_ = reader_.length();
  is_waiting_ = is_open_ = text == TextState::kOpenBlock;
  // With a comment after it, S is no typed stop, but stops all the same.
  if (text == TextState::kProgram && reader_.is_stop()) return has_mark_ ? Act::kNone : Act::kStop;
  if (is_ignored()) {
    is_open_ = is_waiting_ = false;
    if (is_discarding_ && text != TextState::kNothing && !has_told_pause_) {
      has_told_pause_ = true;
      tell(Remark::kPause, is_heard);
    }
    return Act::kNone;
  }
  switch (text) {
    case TextState::kOpenBlock:
      awaited_word_ = reader_.awaited_word();
      if (reader_.is_stop_after(length_before)) return Act::kEnd;
      break;
    case TextState::kProgram:
      is_ignoring_ = false;
      is_talking_ = true;
      if (reader_.start() == kStartPing) {
        say(Remark::kHello);
      } else if (find_room()) {
        is_open_ = false;
        return Act::kStart;
      } else {
        refuse();
      }
      break;
    case TextState::kProblem:
      is_ignoring_ = has_setup || was_waiting;
      if (!has_mark_ && first_byte_ != '+' && !is_heard && mistakes_ <= kMaxMistakes) {
        // after a SETUP word a module's word is a wrong one: it begins no program
        const uint8_t word = has_setup ? kSpokenCount : reader_.find_unknown(kSpokenWords);
        if (word < kChatterCount) break;
        is_talking_ = true;
        say(mistakes_ == kMaxMistakes ? Remark::kMute
            : word < kSpokenCount      ? Remark::kHelp
                                       : Remark::kMistake);
        mistakes_++;
      }
      break;
    case TextState::kOpenLine:
    case TextState::kNothing:
      break;
  }
  return Act::kNone;
}

// Whether the line is read, and no command but S has an effect.
tini_noinline bool Console::is_ignored() const {
  return is_discarding_ || (is_ignoring_ && !reader_.has_setup());
}

// Says why the line cannot be read now.
void Console::refuse() {
  is_talking_ = has_told_pause_ = true;
  say(refusal_);
  refusal_ = Remark::kNone;
}

}  // namespace tiniscript

#endif  // tiniscript_without_text
