// The reader's words: those of the language and of the kit, in flash, and the names of a program.

#include "kit_words.h"
#include "reader_parts.h"

namespace tiniscript {

namespace {

constexpr uint8_t kLastLetter = 0x80;

}  // namespace

// The word behind the code has ended. It stays there until code is emitted.
void Reader::end_word() {
  buffer_[length_ + letters_ - 1] |= kLastLetter;
  entry_ = kWords;
  uint8_t word = kFirstWord;
  for (; flash_byte(entry_) != 0; word++) {
    if (!matches(true)) continue;
    if (word == kWordAnd) word = token_of(Op::kAnd);
    if (word == kWordOr) word = token_of(Op::kOr);
    token(word);
    return;
  }
  if (!find_in_kit()) find_name();
  token(kNameToken);
}

// Whether the word is the one at `entry_`, which goes behind it.
bool Reader::matches(bool in_flash) {
  const uint8_t* word = buffer_ + length_;
  const uint8_t* entry = entry_;
  bool is_same = true;
  uint8_t letter;
  do {
    letter = in_flash ? flash_byte(entry) : *entry;
    entry++;
    if (is_same && letter != *word++) is_same = false;
  } while ((letter & kLastLetter) == 0);
  entry_ = entry;
  return is_same;
}

bool Reader::is_about(const uint8_t* word) {
  entry_ = word;
  return problem_ == Problem::kUnknownWord && length_ == 0 && matches(true);
}

bool Reader::may_have_setup() const {
  if (state_ != kBegin || buffer_[0] != (letters_ == 2 ? 'S' : 'P')) return false;
  return letters_ == 4 || (letters_ == 2 && (buffer_[1] == 'I' || buffer_[1] == 'B'));
}

bool Reader::find_in_kit() {
  entry_ = robot_words();
  uint8_t sensors = 0;
  uint8_t actuators = 0;
  while (flash_byte(entry_) != 0) {
    const bool is_found = matches(true);
    const uint8_t device = flash_byte(entry_++);
    found_ = static_cast<uint8_t>(kIsSensor | (device & kDeviceIsYesNo));
    number_ = sensors++;
    if ((device & kDeviceIsActuator) != 0) {
      found_ ^= kIsSensor | kIsActuator;
      sensors--;
      number_ = actuators++;
    }
    if (is_found) return true;
    if (device == kDeviceIsActuator) entry_ += kRangeBytes;
  }
  return false;
}

void Reader::find_name() {
  entry_ = names_;
  while (entry_ != end_) {
    const uint8_t info = *entry_++;
    const uint8_t* const facts = entry_;
    found_ = kIsVariable;
    if ((info & kNameYesNo) != 0) found_ = kIsVariable | kIsYesNo;
    number_ = info & (kVariables - 1);
    if ((info & kNameDef) != 0) {
      found_ = kIsDef;
      entry_ += sizeof(Def);
    }
    if (matches(false)) {
      entry_ = facts;
      return;
    }
  }
  found_ = 0;
}

// Adds the word as a name, `more` bytes before its letters.
void Reader::add_name(uint8_t info, uint8_t more) {
  const uint16_t bytes = static_cast<uint16_t>(1 + more + letters_);
  if (!has_room(static_cast<uint16_t>(letters_ + bytes - 1))) return;
  uint8_t* const names = names_ - bytes;
  for (uint8_t* at = stack_ - bytes; at != names; at++) *at = at[bytes];
  stack_ -= bytes;
  names_ = names;
  *names = info;
  const uint8_t* word = buffer_ + length_;
  for (uint8_t* at = names + bytes - letters_; at != names + bytes; at++) *at = *word++;
}

}  // namespace tiniscript
