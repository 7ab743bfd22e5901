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
  uint8_t word = kFirstWord;
  for (const uint8_t* entry = kWords; flash_byte(entry) != 0; word++) {
    if (matches(&entry)) {
      if (word == kWordAnd) word = token_of(Op::kAnd);
      if (word == kWordOr) word = token_of(Op::kOr);
      token(word);
      return;
    }
  }
  if (!find_in_kit()) find_name();
  token(kNameToken);
}

// Whether the word is the one in flash. `*entry` goes behind it.
bool Reader::matches(const uint8_t** entry) const {
  const uint8_t* word = buffer_ + length_;
  bool is_same = true;
  uint8_t letter;
  do {
    letter = flash_byte((*entry)++);
    if (is_same && letter != *word++) is_same = false;
  } while ((letter & kLastLetter) == 0);
  return is_same;
}

bool Reader::find_in_kit() {
  const uint8_t* entry = robot_words();
  uint8_t sensors = 0;
  uint8_t actuators = 0;
  while (flash_byte(entry) != 0) {
    const bool is_found = matches(&entry);
    const uint8_t device = flash_byte(entry++);
    const bool is_actuator = (device & kDeviceIsActuator) != 0;
    if (is_found) {
      found_ = is_actuator ? kIsActuator : kIsSensor;
      number_ = is_actuator ? actuators : sensors;
      found_ = static_cast<uint8_t>(found_ | (device & kDeviceIsYesNo));
      entry_ = entry;
      return true;
    }
    if (is_actuator) {
      actuators++;
    } else {
      sensors++;
    }
    if (device == kDeviceIsActuator) entry += kRangeBytes;
  }
  return false;
}

bool Reader::find_name() {
  const uint8_t* entry = names_;
  while (entry != end_) {
    const uint8_t info = *entry++;
    found_ = kIsVariable;
    if ((info & kNameYesNo) != 0) found_ |= kIsYesNo;
    number_ = info & (kVariables - 1);
    entry_ = entry;
    if ((info & kNameDef) != 0) {
      found_ = kIsDef;
      entry += sizeof(Def);
    }
    const uint8_t* word = buffer_ + length_;
    bool is_same = true;
    uint8_t letter;
    do {
      letter = *entry++;
      if (is_same && letter != *word++) is_same = false;
    } while ((letter & kLastLetter) == 0);
    if (is_same) return true;
  }
  found_ = 0;
  return false;
}

// Adds the word as a name, `more` bytes before its letters.
void Reader::add_name(uint8_t info, uint8_t more) {
  const uint16_t bytes = static_cast<uint16_t>(1 + more + letters_);
  if (!has_room(static_cast<uint16_t>(letters_ + bytes - 1))) return;
  __builtin_memmove(stack_ - bytes, stack_, static_cast<size_t>(names_ - stack_));
  stack_ -= bytes;
  names_ -= bytes;
  uint8_t* at = names_;
  *at++ = info;
  __builtin_memcpy(at + more, buffer_ + length_, letters_);
}

}  // namespace tiniscript
