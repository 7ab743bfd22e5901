// Writes the answers of a conversation in text, a line at a time. Each begins as a comment does: so
// a terminal that echoes starts no conversation.

#include "../text/kit_words.h"
#include "../text/unpacked.h"
#include "../text/words.h"
#include "../vm/build.h"
#include "../vm/cpu.h"
#include "../vm/find_word.h"
#include "../vm/small.h"
#include "console.h"
#include "frames.h"
#include "port.h"
#include "text_level.h"

#ifndef tiniscript_without_text

namespace tiniscript {

namespace {

constexpr uint8_t kLineEndBytes = 2;
constexpr uint8_t kLongestWord = 24;

// The words from here on are not listed: END_DEF on robots without DEFs, and other spellings.
constexpr uint8_t kSkippedAt = kReadsDefs ? kAliasesAt : kAliasesAt - kEndDefBytes;

// Nor are those of tasks and moves by distance on robots without them, and of later versions.
constexpr uint8_t kListEnd = kReadsDefs ? kLaterWordsAt : kTaskWordsAt;

// The line that is written, and its bytes so far. Valid only while it is written.
uint8_t* line;
uint8_t size;

// Text that does not fit is left out.
tini_noinline void put(uint8_t byte) {
  if (size < kWireBytes - kLineEndBytes) line[size++] = byte;
}

tini_noinline void begin_line(uint8_t* out) {
  line = out;
  size = 0;
  put('/');
  put('/');
  put(' ');
}

tini_noinline uint8_t finish_line() {
  uint8_t* const end = line + size;
  end[0] = '\r';
  end[1] = '\n';
  return static_cast<uint8_t>(size + kLineEndBytes);
}

// Sends a word in flash whose last letter is marked. Returns the address after it.
const uint8_t* put_word(const uint8_t* word) {
  uint8_t letter;
  do {
    letter = flash_byte(word++);
    put(static_cast<uint8_t>(letter & ~kLastLetter));
  } while ((letter & kLastLetter) == 0);
  return word;
}

// Puts a word of the language, or a sign.
tini_noinline void put_token(uint8_t token) {
  if (token < kFirstWord) return put(token);
  const uint8_t* word = kWords;
  for (; token != kFirstWord; token--) {
    while ((flash_byte(word++) & kLastLetter) == 0) {
    }
  }
  put_word(word);
}

tini_noinline void put_digit(uint8_t digit) {
  put(static_cast<uint8_t>(digit < 10 ? '0' + digit : 'a' + digit - 10));
}

// Sends data in memory as a hexadecimal number.
tini_noinline void put_hex(const void* bytes, uint8_t count) {
  do {
    const uint8_t byte = static_cast<const uint8_t*>(bytes)[--count];
    put_digit(byte / 16);
    put_digit(byte % 16);
  } while (count != 0);
}

// Puts thousandths as the shortest decimal number. Its digits are made in the last bytes of the
// line, where no number comes.
tini_noinline void put_number(int32_t value) {
  uint32_t remaining = static_cast<uint32_t>(value);
  if (value < 0) {
    put('-');
    remaining = 0 - remaining;
  }
  uint8_t* const point = line + kWireBytes - 3;
  uint8_t* end = point + 3;
  uint8_t* cursor = end;
  do {
    *--cursor = static_cast<uint8_t>('0' + cut_digit(&remaining));
  } while (remaining != 0 || cursor >= point);
  while (end != point && end[-1] == '0') end--;
  for (; cursor != end; cursor++) {
    if (cursor == point) put('.');
    put(*cursor);
  }
}

constexpr Remark kLevel = kRobotTextLevel == TextLevel::kMega    ? Remark::kLevelMega
                          : kRobotTextLevel == TextLevel::kEsp32 ? Remark::kLevelEsp32
                                                                 : Remark::kLevelUno;

}  // namespace

// Puts words of the robot until the line is full. Returns whether there are more.
bool Console::put_words() {
  const uint8_t* word = next_help_word_;
  if (word == nullptr) word = kWords;
  next_help_word_ = nullptr;
  for (;;) {
    if (!kReadsDefs && word == kWords + kDefAt) word += kDefBytes;
    if (word == kWords + kSkippedAt) word = kWords + kAliasesAt + kAliasBytes;
    if (word == kWords + kListEnd) word = robot_words();
    if (flash_byte(word) == 0) return false;
    if (size > kWireBytes - kLineEndBytes - kLongestWord) break;
    word = put_word(word);
    put(' ');
    // After a word of the kit there is no letter.
    if (flash_byte(word) < 'A') word = after_device(word);
  }
  next_help_word_ = word;
  return true;
}

uint8_t Console::write_value(int32_t value, bool is_yes_no, uint8_t* out) {
  begin_line(out);
  if (is_yes_no) {
    put_token(value != 0 ? kWordTrue : kWordFalse);
  } else {
    put_number(value);
  }
  return finish_line();
}

tini_noinline uint8_t Console::write(uint8_t* out) {
  begin_line(out);
  const Remark remark = remark_;
  remark_ = Remark::kNone;
  uint8_t text = text_of(remark);
  switch (remark) {
    case Remark::kMistake: {
      const Problem problem = reader_.problem();
      const bool is_range = problem == Problem::kRange;
      put_number(is_range ? reader_.value() : reader_.column() * int32_t{1000});
      put(':');
      put(' ');
      if (is_range) put_number(reader_.limit(0));
      text = text_of(problem);
      break;
    }
    case Remark::kHelp:
      if (put_words()) remark_ = Remark::kHelp;
      break;
    case Remark::kHello: {
      const DeviceInfo& info = port_device_info();
      // A byte from another user: it may not be a control character for a terminal.
      for (uint8_t k = 0; k < info.name_length; k++) {
        const uint8_t byte = info.name[k];
        put(byte < ' ' || byte == 0x7f ? uint8_t{'?'} : byte);
      }
      const Identity& identity = port_identity();
      if (info.name_length == 0) put_hex(&identity.id, sizeof identity.id);
      put_text<put>(text);
      put_hex(&identity.kit, sizeof identity.kit);
      text = text_of(kLevel);
      break;
    }
    case Remark::kLatched:
      // No client has stopped it.
      if (port_status().state == State::kFaulted) text = text_of(Remark::kFailed);
      break;
    default:
      break;
  }
  put_text<put>(text);
  if (text == text_of(Problem::kRange)) put_number(reader_.limit(4));
  if (remark == Remark::kWaiting) put_token(awaited_word_);
  // A program for the button that another one replaces is not reported.
  if (remark == Remark::kLost || remark == Remark::kOkButton) has_lost_program_ = false;
  if (remark_ == Remark::kNone && has_lost_program_) remark_ = Remark::kLost;
  if (remark == Remark::kFault) put_text<put>(name_of_fault(port_status().fault));
  return finish_line();
}

}  // namespace tiniscript

#endif  // tiniscript_without_text
