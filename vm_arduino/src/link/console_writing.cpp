// Writes the answers of a conversation in text, a line at a time. Each begins as a comment does: so
// a terminal that echoes starts no conversation.

#include "../text/kit_words.h"
#include "../text/texts.h"
#include "../text/words.h"
#include "../vm/small.h"
#include "console.h"
#include "frames.h"
#include "port.h"

namespace tiniscript {

namespace {

constexpr uint8_t kLineEndBytes = 2;
constexpr uint8_t kLastLetter = 0x80;
constexpr uint8_t kLongestWord = 24;

// From here on words are not said: END_DEF where there are no DEFs, and other spellings.
constexpr uint8_t kSkippedAt = kReadsDefs ? kAliasesAt : kAliasesAt - kEndDefBytes;

}  // namespace

// What does not fit is left out.
tini_noinline void Console::put(uint8_t byte) {
  if (size_ < kWireBytes - kLineEndBytes) out_[size_++] = byte;
}

void Console::begin_line(uint8_t* out) {
  out_ = out;
  size_ = 0;
  put('/');
  put('/');
  put(' ');
}

uint8_t Console::end_answer() {
  uint8_t* const end = out_ + size_;
  end[0] = '\r';
  end[1] = '\n';
  return static_cast<uint8_t>(size_ + kLineEndBytes);
}

tini_noinline void Console::put_text(const uint8_t* text) {
  for (uint8_t code; (code = flash_byte(text)) != 0; text++) put_packed(code);
}

// Calls itself as deep as there are pairs in pairs.
tini_noinline void Console::put_packed(uint8_t code) {
  while (code >= kFirstPair) {
    const uint8_t* const pair = pair_of(code);
    put_packed(flash_byte(pair));
    code = flash_byte(pair + 1);
  }
  put(code);
}

// Puts a word in flash whose last letter is marked. Returns what is behind it.
tini_noinline const uint8_t* Console::put_word(const uint8_t* word) {
  uint8_t letter;
  do {
    letter = flash_byte(word++);
    put(static_cast<uint8_t>(letter & ~kLastLetter));
  } while ((letter & kLastLetter) == 0);
  return word;
}

// Puts a word of the language, or a sign.
void Console::put_token(uint8_t token) {
  if (token < kFirstWord) return put(token);
  const uint8_t* word = kWords;
  for (; token != kFirstWord; token--) {
    while ((flash_byte(word++) & kLastLetter) == 0) {
    }
  }
  put_word(word);
}

tini_noinline void Console::put_digit(uint8_t digit) {
  put(static_cast<uint8_t>(digit < 10 ? '0' + digit : 'a' + digit - 10));
}

// Puts what lies in memory as a hexadecimal number.
void Console::put_hex(const void* bytes, uint8_t count) {
  do {
    const uint8_t byte = static_cast<const uint8_t*>(bytes)[--count];
    put_digit(byte / 16);
    put_digit(byte % 16);
  } while (count != 0);
}

// Puts thousandths as the shortest decimal number. Its digits are made in the last bytes of the
// line, where no number comes.
void Console::put_number(int32_t value) {
  uint32_t rest = static_cast<uint32_t>(value);
  if (value < 0) {
    put('-');
    rest = 0 - rest;
  }
  uint8_t* const point = out_ + kWireBytes - 3;
  uint8_t* behind = point + 3;
  uint8_t* at = behind;
  do {
    *--at = static_cast<uint8_t>('0' + rest % 10);
    rest /= 10;
  } while (rest != 0 || at >= point);
  while (behind != point && behind[-1] == '0') behind--;
  for (; at != behind; at++) {
    if (at == point) put('.');
    put(*at);
  }
}

// Puts words of the robot until the line is full. Returns whether there are more.
bool Console::put_words() {
  for (;;) {
    if (help_ == nullptr) help_ = kWords;
    if (!kReadsDefs && help_ == kWords + kDefAt) help_ += kDefBytes;
    if (help_ == kWords + kSkippedAt) help_ = kWords + kAliasesAt + kAliasBytes;
    if (help_ == kWords + kLaterWordsAt) help_ = robot_words();
    if (flash_byte(help_) == 0) break;
    if (size_ > kWireBytes - kLineEndBytes - kLongestWord) return true;
    help_ = put_word(help_);
    put(' ');
    // Behind a word of the kit there is no letter.
    if (flash_byte(help_) < 'A') help_ = behind_device(help_);
  }
  help_ = nullptr;
  return false;
}

tini_noinline uint8_t Console::write_value(int32_t value, bool is_yes_no, uint8_t* out) {
  begin_line(out);
  if (is_yes_no) {
    put_token(value != 0 ? kWordTrue : kWordFalse);
  } else {
    put_number(value);
  }
  return end_answer();
}

tini_noinline uint8_t Console::write(uint8_t* out) {
  begin_line(out);
  const Remark remark = remark_;
  remark_ = Remark::kNone;
  const uint8_t* text = text_of(remark);
  switch (remark) {
    case Remark::kMistake:
      put_number(reader_.column() * int32_t{1000});
      put(':');
      put(' ');
      text = text_of(reader_.problem());
      break;
    case Remark::kHelp:
      if (put_words()) remark_ = Remark::kHelp;
      break;
    case Remark::kHello: {
      const DeviceInfo& info = port_device_info();
      // A byte that somebody else has chosen: it may be no sign that a terminal obeys.
      for (uint8_t k = 0; k < info.name_length; k++) {
        const uint8_t byte = info.name[k];
        put(byte < ' ' || byte == 0x7f ? uint8_t{'?'} : byte);
      }
      const Identity& identity = port_identity();
      if (info.name_length == 0) put_hex(&identity.id, sizeof identity.id);
      put_text(text);
      put_hex(&identity.kit, sizeof identity.kit);
      text = text_of(Remark::kLevel);
      break;
    }
    default:
      break;
  }
  put_text(text);
  if (remark == Remark::kWaiting) put_token(awaited_);
  if (remark == Remark::kFault) put_text(name_of_fault(port_status().fault));
  return end_answer();
}

}  // namespace tiniscript
