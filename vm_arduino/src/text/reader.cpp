// The reader's characters: lines, their checksums, UTF-8, and where a token ends.

#include "reader.h"

#include "../vm/crc32.h"
#include "reader_parts.h"

namespace tiniscript {

namespace {

// Where a byte stands. The signs that may be the first half of another stand for themselves.
enum Place : uint8_t { kBetween, kWord, kComment, kWhole, kPoint, kPlaces };

constexpr uint8_t kUnfinished = 0;
constexpr uint8_t kOdd = 1;  // a character that means nothing

// Of a checksum: nothing has come, all digits have come, what came was a comment.
constexpr uint8_t kNoCheck = 0;
constexpr uint8_t kTilde = 1;
constexpr uint8_t kAllDigits = kTilde + 8;
constexpr uint8_t kCommentAfterAll = 255;

constexpr uint32_t kLargestWhole = 2147483;

}  // namespace

void Reader::begin(uint8_t* buffer, uint16_t room) {
  const bool is_after_cr = is_after_cr_;
  __builtin_memset(static_cast<void*>(this), 0, sizeof *this);
  is_after_cr_ = is_after_cr;
  buffer_ = buffer;
  stack_ = names_ = end_ = buffer + room;
}

void Reader::report(Problem problem) {
  if (problem_ != Problem::kNone) return;
  problem_ = problem;
  problem_column_ = token_column_;
}

Text Reader::put(uint8_t byte) {
  const bool was_after_cr = is_after_cr_;
  is_after_cr_ = byte == '\r';
  if (byte == '\r') return end_line();
  if (byte == '\n') return was_after_cr ? Text::kGoesOn : end_line();
  if ((byte & 0xc0) != 0x80 && column_ != 255) column_++;
  if (check_ == kNoCheck) {
    if (byte == '~') {
      if (place_ != kComment) take(' ');
      check_ = kTilde;
      return Text::kGoesOn;
    }
    crc_ = crc32(crc_, &byte, 1);
  }
  const uint8_t letter = character(byte);
  if (letter != kUnfinished && !checks(letter)) take(letter);
  return Text::kGoesOn;
}

// Takes what stands behind a `~`. Returns whether it did.
bool Reader::checks(uint8_t letter) {
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
      if (digit != static_cast<uint8_t>(crc_ >> 24) >> 4) is_damaged_ = true;
      crc_ <<= 4;
      check_++;
      return true;
    }
  }
  token_column_ = column_;
  if (place_ != kComment) report(Problem::kChecksum);
  check_ = kCommentAfterAll;
  return false;
}

// Returns an ASCII letter, a space or a dash for its relatives, kOdd, or kUnfinished.
uint8_t Reader::character(uint8_t byte) {
  if (left_ == 0) {
    if (byte == '\v' || byte == '\f') return ' ';
    if (byte != 0 && byte < 0x80) return byte;
    left_ = static_cast<uint8_t>(1 + (byte >= 0xe0) + (byte >= 0xf0));
    lead_ = byte;
    second_ = 0;
    if (byte >= 0xc2 && byte <= 0xf4) return kUnfinished;
  } else if ((byte & 0xc0) == 0x80) {
    bool is_right = true;
    if (second_ == 0) {
      second_ = byte;
      if (lead_ == 0xe0) is_right = byte >= 0xa0;
      if (lead_ == 0xed) is_right = byte < 0xa0;
      if (lead_ == 0xf0) is_right = byte >= 0x90;
      if (lead_ == 0xf4) is_right = byte < 0x90;
    }
    if (is_right) {
      if (--left_ != 0) return kUnfinished;
      if (lead_ == 0xc2 && byte == 0xa0) return ' ';
      if (lead_ == 0xe2 && second_ == 0x80) {
        if (byte <= 0x8b || byte == 0xaf) return ' ';
        if (byte >= 0x90 && byte <= 0x95) return '-';
      }
      if (lead_ == 0xe2 && second_ == 0x88 && byte == 0x92) return '-';
      if (lead_ == 0xe3 && second_ == 0x80 && byte == 0x80) return ' ';
      if (lead_ == 0xef && second_ == 0xbb && byte == 0xbf) {
        if (column_ == 1) {  // the byte order mark is no part of the line
          column_ = 0;
          crc_ = 0;
        }
        return ' ';
      }
      return kOdd;
    }
  }
  left_ = 0;
  token_column_ = column_;
  report(Problem::kCharacter);
  return kOdd;
}

Text Reader::end_line() {
  if (left_ != 0) report(Problem::kCharacter);
  const bool is_cut = check_ != kNoCheck && check_ < kAllDigits && place_ != kComment;
  take('\n');
  if (is_cut) report(Problem::kChecksum);
  if (check_ == kAllDigits && is_damaged_) {
    problem_ = Problem::kChecksum;
    problem_column_ = 1;
  }
  place_ = kBetween;
  left_ = 0;
  column_ = 0;
  check_ = kNoCheck;
  is_damaged_ = false;
  crc_ = 0;
  if (problem_ != Problem::kNone) return Text::kProblem;
  if (stack_ != names_) return Text::kMore;
  return state_ == kBegin ? Text::kNothing : Text::kProgram;
}

// Takes a character, or '\n' for the end of the line.
void Reader::take(uint8_t letter) {
  if (problem_ != Problem::kNone) return;
  const uint8_t value = static_cast<uint8_t>(letter - '0');
  uint8_t capital = letter;
  if (static_cast<uint8_t>(letter - 'a') < 26) capital = static_cast<uint8_t>(letter - 0x20);
  const bool is_digit = value < 10;
  const bool is_word =
      is_digit || static_cast<uint8_t>(capital - 'A') < 26 || letter == '_';
  const uint8_t place = place_;
  switch (place) {
    case kBetween:
      break;
    case kWord:
      if (is_word) {
        add_letter(capital);
        return;
      }
      end_word();
      break;
    case kComment:
      if (letter != '\n') return;
      break;
    case kWhole:
    case kPoint:
    case kPlaces:
      if (is_digit) {
        digit(value);
        return;
      }
      if (letter == '.' && place == kWhole) {
        place_ = kPoint;
        return;
      }
      if (is_word || letter == '.' || place == kPoint) {
        report(Problem::kNumber);
        return;
      }
      token(kNumberToken);
      break;
    default: {
      bool are_two = place != '/';
      uint8_t op = place == '<' ? token_of(Op::kLt) : token_of(Op::kGt);
      if (!are_two) {
        if (letter == '/') {
          place_ = kComment;
          return;
        }
        op = token_of(Op::kDiv);
      } else if (letter == '=') {
        op++;
      } else if (letter == '>' && place == '<') {
        op = token_of(Op::kNe);
      } else {
        are_two = false;
      }
      place_ = kBetween;
      token(op);
      if (are_two) return;
    }
  }
  place_ = kBetween;
  if (letter == ' ' || letter == '\t') return;
  token_column_ = column_;
  if (is_digit || letter == '.') {
    value_ = 0;
    rest_ = 0;
    places_ = 0;
    place_ = is_digit ? kWhole : kPoint;
    if (is_digit) digit(value);
  } else if (is_word && letter != '_') {
    place_ = kWord;
    letters_ = 0;
    add_letter(capital);
  } else {
    sign(letter);
  }
}

// Puts a letter of a word behind the code.
void Reader::add_letter(uint8_t letter) {
  if (letters_ == 255) report(Problem::kFull);
  if (has_room(letters_)) buffer_[length_ + letters_++] = letter;
}

void Reader::sign(uint8_t letter) {
  uint8_t op = byte_of(Op::kAdd);
  switch (letter) {
    case '/':
    case '<':
    case '>':
      place_ = letter;
      return;
    case '(':
    case ')':
    case ',':
    case ';':
    case '|':
    case '\n':
      token(letter);
      return;
    case '=':
      op = byte_of(Op::kEq);
      break;
    case '+':
      break;
    case '-':
      op = byte_of(Op::kSub);
      break;
    case '*':
      op = byte_of(Op::kMul);
      break;
    case '%':
      op = byte_of(Op::kMod);
      break;
    default:
      report(Problem::kCharacter);
      return;
  }
  token(static_cast<uint8_t>(kBinary | op));
}

// Adds a digit to the number, whose places behind the third one round it.
void Reader::digit(uint8_t value) {
  if (place_ == kWhole) {
    if (value_ <= kLargestWhole) value_ = value_ * 10 + value;
    return;
  }
  place_ = kPlaces;
  if (places_ < 3) {
    rest_ = static_cast<uint16_t>(rest_ * 10 + value);
    places_++;
  } else if (places_ == 3) {
    places_++;
    if (value >= 5) rest_++;
  }
}

}  // namespace tiniscript
