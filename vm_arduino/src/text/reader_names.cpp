// The reader's words: those of the language and of the kit, in flash, and the names of a program.

#include "kit_words.h"
#include "reader_parts.h"

namespace tiniscript {

namespace {

constexpr uint8_t kLastLetter = 0x80;

}  // namespace

// The word behind the code has ended. It stays there until code is emitted.
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
  if (!find_in_kit()) find_name();
  token(kNameToken);
}

// Returns the number of the word behind the code in a table in flash, or that of the table's end.
// Its last letter is marked; `unmark` takes that off again.
tini_noinline uint8_t Reader::find(const uint8_t* table, uint8_t unmark) {
  uint8_t* const last = buffer_ + length_ + letters_ - 1;
  *last |= kLastLetter;
  entry_ = table;
  uint8_t number = 0;
  while (flash_byte(entry_) != 0 && !matches(true)) number++;
  *last ^= unmark;
  return number;
}

// The word that is being typed where an instruction may begin, or 0.
uint8_t Reader::open_word() {
  if (place_ != kWord || (state_ != kBegin && state_ != kInstruction)) return 0;
  return static_cast<uint8_t>(kFirstWord + find(kWords, kLastLetter));
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

uint8_t Reader::find_unknown(const uint8_t* table) {
  return problem_ == Problem::kUnknownWord && length_ == 0 ? find(table, 0) : uint8_t{255};
}

bool Reader::may_have_setup() {
  const uint8_t word = state_ == kBegin ? open_word() : uint8_t{0};
  return word >= kWordSi && word <= kWordPing;
}

bool Reader::is_at_stop(uint8_t before) {
  if (length_ == before) {
    const uint8_t word = open_word();
    return word == kWordS || word == kWordStop;
  }
  return is_stop_behind(before) && problem_ == Problem::kNone && place_ <= kComment &&
         place_ != kWord;
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
    if (kReadsDefs && (info & kNameDef) != 0) {
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
