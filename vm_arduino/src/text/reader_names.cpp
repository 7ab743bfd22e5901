// The reader's words: those of the language and of the kit, in flash, and the names of a program.

#include "../vm/find_word.h"
#include "kit_words.h"
#include "reader_parts.h"

namespace tiniscript {

// The word after the code has ended. It stays there until code is emitted.
void Reader::end_word() {
  uint8_t word = find(kWords, 0);
  if (word != kWordsEnd - kFirstWord) {
    word = static_cast<uint8_t>(word + kFirstWord);
    static_assert(token_of(Op::kOr) - token_of(Op::kAnd) == kWordOr - kWordAnd, "");
    if (word == kWordAnd || word == kWordOr) {
      word = static_cast<uint8_t>(word + token_of(Op::kAnd) - kWordAnd);
    }
    return token(word);
  }
  find_name();
  if (name_kind_ == 0) find_in_kit();
  token(kNameToken);
}

// Returns the number of the word after the code in a table in flash, or that of the table's end.
// Its last letter is marked; `unmark` takes that off again.
uint8_t Reader::find(const uint8_t* table, uint8_t unmark) {
  uint8_t* const word = buffer_ + length_;
  uint8_t* const last_letter = word + letters_ - 1;
  *last_letter |= kLastLetter;
  const uint8_t number = find_word(table, word, letters_);
  *last_letter ^= unmark;
  return number;
}

// The word that is being typed where an instruction may begin, or 0.
uint8_t Reader::open_word() {
  if (place_ != kWord || (state_ != kBegin && state_ != kInstruction)) return 0;
  return static_cast<uint8_t>(kFirstWord + find(kWords, kLastLetter));
}

uint8_t Reader::find_unknown(const uint8_t* table) {
  return problem_ == Problem::kUnknownWord && length_ == 0 ? find(table, 0) : uint8_t{255};
}

void Reader::find_in_kit() {
  const uint8_t* entry = robot_words();
  uint8_t sensors = 0;
  uint8_t actuators = 0;
  while (flash_byte(entry) != 0) {
    const bool is_found = matches(&entry, true);
    const uint8_t device = flash_byte(entry++);
    const uint8_t number = (device & kIsActuator) != 0 ? actuators++ : sensors++;
    if (is_found) {
      name_kind_ = device;
      number_ = number;
      entry_ = entry;
      return;
    }
    if (device == kIsActuator) entry += kRangeBytes;
  }
}

// Notes that the sensor that was named has been asked, and returns its bit.
SensorBits Reader::ask() {
  const SensorBits bit = static_cast<SensorBits>(SensorBits{1} << number_);
  if (kHasRemote) asked_sensors_ |= bit;
  return bit;
}

// Takes the word as a name of the program, if it may be one. From then on, the remote control's
// reading of this name counts as asked. False: it is taken.
bool Reader::take_word() {
  const SensorBits asked_before = asked_sensors_;
  return name_kind_ == 0 ||
         (kHasRemote && (name_kind_ & kGivesWay) != 0 && (ask() & asked_before) == 0);
}

void Reader::find_name() {
  const uint8_t* entry = names_;
  name_kind_ = 0;
  while (entry != end_) {
    const uint8_t info = *entry++;
    const uint8_t* const data = entry;
    const bool is_def = kReadsDefs && (info & kNameDef) != 0;
    if (is_def) entry += sizeof(Def);
    if (!matches(&entry, false)) continue;
    entry_ = data;
    number_ = info & (kVariables - 1);
    name_kind_ = kIsVariable;
    if ((info & kNameYesNo) != 0) name_kind_ = kIsVariable | kIsYesNo;
    if (is_def) name_kind_ = kIsDef;
    // the values of the DEF that is open lie below it
    if (kReadsDefs && (info & kNameOfDef) != 0 && data > reinterpret_cast<uint8_t*>(def_)) {
      name_kind_ = kIsOfOtherDef;
    }
    return;
  }
}

// Adds the word as a name, `data_bytes` bytes before its letters.
void Reader::add_name(uint8_t info, uint8_t data_bytes) {
  // At the begin of an instruction only blocks wait: those that are counted, and a DEF.
  static_assert((kBlocks + 1) * sizeof(Block) <= 255, "what waits is copied at once");
  const uint16_t bytes = static_cast<uint16_t>(1 + data_bytes + letters_);
  if (!has_room(static_cast<uint16_t>(letters_ + bytes - 1))) return;
  uint8_t* const new_stack = stack_ - bytes;
  copy_bytes(stack_, new_stack, static_cast<uint8_t>(names_ - stack_));
  stack_ = new_stack;
  names_ -= bytes;
  *names_ = info;
  copy_bytes(buffer_ + length_, names_ + 1 + data_bytes, letters_);
}

}  // namespace tiniscript
