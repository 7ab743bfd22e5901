// The reader's characters: lines, their checksums, UTF-8, and where a token ends.

#include "reader.h"

#include "../vm/crc32.h"
#include "reader_parts.h"

namespace tiniscript {

namespace {

constexpr uint8_t kIncompleteUtf8 = 0x80;        // what follows is no ASCII
constexpr uint8_t kUnknownCharacter = 0x81;      // a character that means nothing
constexpr uint8_t kInvalidUtf8 = 0x82;           // no UTF-8
tini_of_defs(constexpr uint8_t kDegree = 0x83;)  // a sign for DEG

// The state of a checksum: nothing has come, all digits have come, or it was a comment.
constexpr uint8_t kNoCheck = 0;
constexpr uint8_t kTilde = 1;
constexpr uint8_t kAllDigits = kTilde + 8;
constexpr uint8_t kCommentAfterAll = 255;

constexpr uint32_t kTooBig = 0x10000000;  // ten times that is more than any number

// Characters of two and three bytes: the first one, the second of three or 0, the last one and how
// many more may follow, and what they are.
const uint8_t kRelatives[] tini_progmem = {
    0xc2, 0x00, 0xa0, 0,    ' ',     0xe2, 0x80, 0x80, 11,   ' ',     0xe2, 0x80,
    0xaf, 0,    ' ',  0xe2, 0x80,    0x90, 5,    '-',  0xe2, 0x88,    0x92, 0,
    '-',  0xe3, 0x80, 0x80, 0,       ' ',  0xef, 0xbb, 0xbf, 0,       ' ',
    tini_of_defs(0xc2, 0x00, 0xb0, 0, kDegree, 0xc2, 0x00, 0xba, 0, kDegree, )  //
    0,
};

// Each sign and its token, or 0 if it may be the first half of another.
const uint8_t kSigns[] tini_progmem = {
    kNewline, kNewline,
    '(',      '(',
    ')',      ')',
    ',',      ',',
    ';',      ';',
    '|',      '|',
    '/',      0,
    '<',      0,
    '>',      0,
    '+',      token_of(Op::kAdd),
    '-',      token_of(Op::kSub),
    '*',      token_of(Op::kMul),
    '%',      token_of(Op::kMod),
    '=',      token_of(Op::kEq),
    tini_of_defs(kDegree, kWordDeg, )  //
    0,
};

}  // namespace

void Reader::begin(uint8_t* buffer, uint16_t room) {
  const bool is_after_cr = is_after_cr_;
  __builtin_memset(static_cast<void*>(this), 0, sizeof *this);
  is_after_cr_ = is_after_cr;
  buffer_ = buffer;
  stack_ = names_ = end_ = buffer + room;
}

tini_noinline TextState Reader::put(uint8_t byte) {
  const bool was_after_cr = is_after_cr_;
  is_after_cr_ = byte == '\r';
  if (byte == '\r') return end_line();
  if (byte == '\n') return was_after_cr ? TextState::kOpenLine : end_line();
  if ((byte & 0xc0) != 0x80 && column_ != 255) column_++;
  if (byte > ' ' && place_ != kComment) last_column_ = column_;
  if (check_ == kNoCheck) {
    if (byte == '~') {
      if (place_ != kComment) take(' ');
      check_ = kTilde;
      return TextState::kOpenLine;
    }
    byte_ = byte;  // a local variable would need a frame
    crc_ = crc32(crc_, &byte_, 1);
  }
  const uint8_t letter = character(byte);
  if (letter != kIncompleteUtf8 && !takes_checksum(letter)) take(letter);
  return TextState::kOpenLine;
}

// Takes what stands after a `~`. Returns whether it did.
bool Reader::takes_checksum(uint8_t letter) {
  if (check_ == kNoCheck || check_ == kCommentAfterAll) return false;
  if (check_ == kAllDigits) {
    if (letter == ' ' || letter == '\t') return true;
  } else {
    uint8_t digit = static_cast<uint8_t>(letter - '0');
    if (digit > 9) {
      digit = static_cast<uint8_t>((letter | 0x20) - 'a');
      digit = digit < 6 ? static_cast<uint8_t>(digit + 10) : uint8_t{255};
    }
    if (digit < 16) {
      const uint8_t highest = static_cast<uint8_t>(crc_ >> 24);
      if (digit != static_cast<uint8_t>(highest / 16)) is_damaged_ = true;
      crc_ <<= 4;
      check_++;
      return true;
    }
  }
  if (place_ != kComment && problem_ == Problem::kNone) {
    token_column_ = column_;
    report(Problem::kChecksum);
  }
  check_ = kCommentAfterAll;
  return false;
}

// Returns an ASCII letter, a space or a dash for its relatives, kOdd, kBroken or kUnfinished.
uint8_t Reader::character(uint8_t byte) {
  const uint8_t lead_byte = lead_byte_;
  const uint8_t second_byte = second_byte_;
  lead_byte_ = 0;
  if (byte < 0x80) {
    if (lead_byte != 0 || (byte < ' ' && byte != '\t' && byte != '\b')) return kInvalidUtf8;
    return byte;
  }
  if (byte >= 0xc0) {
    if (lead_byte != 0 || byte < 0xc2 || byte > 0xf4) return kInvalidUtf8;
    lead_byte_ = byte;
    second_byte_ = 0;
    return kIncompleteUtf8;
  }
  if (lead_byte == 0) return kInvalidUtf8;
  if (second_byte == 0 && lead_byte >= 0xe0) {
    lead_byte_ = lead_byte;
    second_byte_ = byte;
    return kIncompleteUtf8;
  }
  if (lead_byte >= 0xf0) {
    lead_byte_ = 0xe1;  // none of its characters means anything
    return kIncompleteUtf8;
  }
  for (const uint8_t* row = kRelatives; flash_byte(row) != 0; row += 5) {
    const uint8_t offset = static_cast<uint8_t>(byte - flash_byte(row + 2));
    if (lead_byte == flash_byte(row) && second_byte == flash_byte(row + 1) &&
        offset <= flash_byte(row + 3)) {
      if (lead_byte == 0xef && column_ == 1) {
        column_ = 0;  // the byte order mark is no part of the line
        crc_ = 0;
      }
      return flash_byte(row + 4);
    }
  }
  return kUnknownCharacter;
}

TextState Reader::end_line() {
  if (lead_byte_ != 0) take(kInvalidUtf8);
  lead_byte_ = 0;
  const bool is_cut = check_ != kNoCheck && check_ < kAllDigits && place_ != kComment;
  take('\n');
  if (is_cut) report(Problem::kChecksum);
  if (check_ == kAllDigits && is_damaged_) {
    problem_ = Problem::kChecksum;
    token_column_ = 1;
  }
  place_ = kNoToken;
  column_ = 0;
  check_ = kNoCheck;
  is_damaged_ = false;
  crc_ = 0;
  if (problem_ != Problem::kNone) return TextState::kProblem;
  const bool lacks_tasks = wants_tasks();
  if (lacks_tasks) {
    token_column_ = lone_forever_column_;
    lone_forever_column_ = 1;  // in a line before
  }
  if (stack_ != names_) return TextState::kOpenBlock;
  if (lacks_tasks) return TextState::kProblem;
  return state_ == kBegin ? TextState::kNothing : TextState::kProgram;
}

// Takes a character, or '\n' for the end of the line.
void Reader::take(uint8_t letter) {
  if (problem_ != Problem::kNone) return;
  const uint8_t place = place_;
  const uint8_t value = static_cast<uint8_t>(letter - '0');
  uint8_t capital = letter;
  if (static_cast<uint8_t>(letter - 'a') < 26) capital = static_cast<uint8_t>(letter - 0x20);
  const bool is_word = value < 10 || static_cast<uint8_t>(capital - 'A') < 26 || letter == '_';
  if (place == kComment) {
    if (letter != '\n' && letter != kInvalidUtf8) return;
  } else if (place == kWord) {
    if (is_word) {
      add_letter(capital);
      return;
    }
    if ((letter == '\b' || letter == 0x7f) && column_ != 255) {
      // this byte, and the letter that it takes back
      last_column_ = column_ = static_cast<uint8_t>(column_ - 2);
      if (--letters_ == 0) place_ = kNoToken;
      return;
    }
    end_word();
  } else if (place >= kWhole && place <= kPlaces) {
    if (value < 10) {
      digit(value);
      return;
    }
    if (letter == '.' && place == kWhole) {
      place_ = kPoint;
      return;
    }
    const bool may_be_unit = kReadsDefs && (capital == 'C' || capital == 'D');
    if ((is_word && !may_be_unit) || letter == '.' || place == kPoint) {
      report(Problem::kNumber);
      return;
    }
    token(kNumberToken);
  } else if (place != kNoToken) {
    if (place == '/' && letter == '/') {
      last_column_ = static_cast<uint8_t>(column_ - 2);
      place_ = kComment;
      return;
    }
    uint8_t op_token = place;  // is now the opcode
    place_ = kNoToken;
    if (op_token == '/') {
      op_token = token_of(Op::kDiv);
    } else {
      op_token = op_token == '<' ? token_of(Op::kLt) : token_of(Op::kGt);
      bool are_two = true;
      if (letter == '=') {
        op_token++;
      } else if (letter == '>' && place == '<') {
        op_token = token_of(Op::kNe);
      } else {
        are_two = false;
      }
      if (are_two) letter = ' ';
    }
    token(op_token);
  }
  place_ = kNoToken;
  if (letter == ' ' || letter == '\t' || problem_ != Problem::kNone) return;
  if (is_word || letter == '.') token_column_ = column_;
  if (letter == '.' || value < 10) {
    value_ = 0;
    places_ = 3;
    place_ = kPoint;
    if (letter != '.') {
      place_ = kWhole;
      digit(value);
    }
  } else if (is_word && letter != '_') {
    place_ = kWord;
    letters_ = 0;
    add_letter(capital);
  } else {
    sign(letter);
  }
}

// Puts a letter of a word after the code.
void Reader::add_letter(uint8_t letter) {
  if (letters_ == 255) report(Problem::kFull);
  if (has_room(letters_)) buffer_[length_ + letters_++] = letter;
}

void Reader::sign(uint8_t letter) {
  for (const uint8_t* sign = kSigns; flash_byte(sign) != 0; sign += 2) {
    if (flash_byte(sign) != letter) continue;
    const uint8_t token_of_sign = flash_byte(sign + 1);
    // what is wrong at the end of a value or an instruction, is so with what stands before it
    if (token_of_sign != letter || token_of_sign == '(') token_column_ = column_;
    if (token_of_sign == 0) {
      place_ = letter;
    } else {
      token(token_of_sign);
    }
    return;
  }
  token_column_ = column_;
  report(Problem::kCharacter);
}

// Adds a digit to the number, whose places after the third one round it.
void Reader::digit(uint8_t value) {
  if (place_ != kWhole) {
    place_ = kPlaces;
    if (places_ < 0) return;
    places_--;
    if (places_ < 0) {
      if (value >= 5) value_++;
      return;
    }
  }
  scale(value);
}

void Reader::scale(uint8_t digit) {
  if (value_ >= kTooBig) report(Problem::kTooBig);
  value_ = value_ * 10 + digit;
}

}  // namespace tiniscript
