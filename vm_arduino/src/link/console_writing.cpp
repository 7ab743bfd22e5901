// Writes the answers of a conversation in text, a line at a time. Each begins as a comment does: so
// a terminal that echoes starts no conversation.

#include "reads_text.h"

#ifdef tiniscript_reads_text

#include "../text/kit_words.h"
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

const uint8_t kIsOfKit[] tini_progmem = ", kit ";
const uint8_t kHasLevel[] tini_progmem = ", text 1";  // the level of its reader

// Returns what is behind a word in flash whose last letter is marked.
const uint8_t* behind(const uint8_t* word) {
  while ((flash_byte(word++) & kLastLetter) == 0) {
  }
  return word;
}

// A line that is being written. What does not fit is left out.
class Line {
 public:
  explicit Line(uint8_t* out) : out_(out), at_(out), end_(out + kWireBytes - kLineEndBytes) {
    put('/');
    put('/');
    put(' ');
  }

  void put(uint8_t byte) {
    if (at_ != end_) *at_++ = byte;
  }

  void put_text(const uint8_t* text) {
    for (uint8_t letter; (letter = flash_byte(text)) != 0; text++) put(letter);
  }

  // Puts a word in flash whose last letter is marked.
  void put_word(const uint8_t* word) {
    uint8_t letter;
    do {
      letter = flash_byte(word++);
      put(static_cast<uint8_t>(letter & ~kLastLetter));
    } while ((letter & kLastLetter) == 0);
  }

  // Puts a word of the language, or a sign.
  void put_token(uint8_t token) {
    if (token < kFirstWord) return put(token);
    const uint8_t* word = kWords;
    for (; token != kFirstWord; token--) word = behind(word);
    put_word(word);
  }

  // Puts a byte that somebody else has chosen: it may be no sign that a terminal obeys.
  void put_foreign(uint8_t byte) { put(byte < ' ' || byte == 0x7f ? uint8_t{'?'} : byte); }

  void put_hex(uint32_t number, uint8_t digits) {
    while (digits-- != 0) {
      const uint8_t digit = static_cast<uint8_t>(number >> 4 * digits & 15);
      put(static_cast<uint8_t>(digit < 10 ? '0' + digit : 'a' + digit - 10));
    }
  }

  // Puts thousandths as the shortest decimal number.
  void put_number(int32_t value) {
    uint32_t rest = static_cast<uint32_t>(value);
    if (value < 0) {
      put('-');
      rest = 0 - rest;
    }
    uint8_t digits[10];
    uint8_t count = 0;
    do {
      digits[count++] = static_cast<uint8_t>('0' + rest % 10);
      rest /= 10;
    } while (rest != 0 || count < 4);
    uint8_t last = 0;
    while (last < 3 && digits[last] == '0') last++;
    while (count > last) {
      if (count == 3) put('.');
      put(digits[--count]);
    }
  }

  uint8_t length() const { return static_cast<uint8_t>(at_ - out_); }

  uint8_t end() {
    *at_++ = '\r';
    *at_++ = '\n';
    return length();
  }

 private:
  uint8_t* const out_;
  uint8_t* at_;
  uint8_t* const end_;
};

// Returns the word of this number: those of the language, then those of the kit. nullptr: no more.
const uint8_t* word_at(uint8_t number) {
  const uint8_t* word = kWords;
  for (uint8_t token = kFirstWord; token != kWordTask; token++, word = behind(word)) {
    const bool is_alias = token >= kWordEndIf && token <= kWordEnddef;
    if (!is_alias && number-- == 0) return word;
  }
  for (word = robot_words(); flash_byte(word) != 0; word = behind_device(behind(word))) {
    if (number-- == 0) return word;
  }
  return nullptr;
}

}  // namespace

uint8_t Console::write_value(int32_t value, bool is_yes_no, uint8_t* out) {
  Line line(out);
  if (is_yes_no) {
    line.put_token(value != 0 ? kWordTrue : kWordFalse);
  } else {
    line.put_number(value);
  }
  return line.end();
}

tini_noinline uint8_t Console::write(uint8_t* out) {
  Line line(out);
  const Remark remark = remark_;
  remark_ = Remark::kNone;
  switch (remark) {
    case Remark::kMistake:
      line.put_number(reader_.column() * int32_t{1000});
      line.put(':');
      line.put(' ');
      line.put_text(text_of(reader_.problem()));
      break;
    case Remark::kHelp:
      for (const uint8_t* word; (word = word_at(word_at_)) != nullptr; word_at_++) {
        if (line.length() > kWireBytes - kLineEndBytes - kLongestWord) {
          remark_ = Remark::kHelp;
          return line.end();
        }
        line.put_word(word);
        line.put(' ');
      }
      word_at_ = 0;
      break;
    case Remark::kHello: {
      const DeviceInfo& info = port_device_info();
      for (uint8_t k = 0; k < info.name_length; k++) line.put_foreign(info.name[k]);
      if (info.name_length == 0) line.put_hex(port_identity().id, 8);
      line.put_text(kIsOfKit);
      line.put_hex(port_identity().kit, 4);
      line.put_text(kHasLevel);
      break;
    }
    default:
      line.put_text(text_of(remark));
      if (remark == Remark::kWaiting) line.put_token(awaited_);
      if (remark == Remark::kFault) line.put_text(name_of_fault(port_status().fault));
  }
  return line.end();
}

}  // namespace tiniscript

#endif  // tiniscript_reads_text
