// Finds a typed stop in the bytes of a line, whatever its spelling.
//
// Only ASCII letters and digits count, in any case, and none after `//`. Knows no packets and no time.
// `docs/develop/link.md` says which stop counts where.

#pragma once

#include <stdint.h>

namespace tiniscript {

inline bool ends_line(uint8_t byte) { return byte == '\r' || byte == '\n'; }

class TypedStop {
 public:
  // A line begins.
  void begin() {
    count_ = urgency_ = 0;
    is_loose_ = false;
  }

  // Takes a byte that does not end a line.
  void put(uint8_t byte);

  // The kind of stop if the line ended here. kLoose: any number of S and STOP, STOP NOW, or a word
  // of people who speak Spanish, Portuguese or English. kStrict: one S or STOP, blanks and `;`.
  enum Kind : uint8_t { kNone, kLoose, kStrict };
  Kind kind() const;

  // Whether the byte was the last of three S in a row, or of a second STOP, anywhere in a line:
  // these do not wait for its end.
  bool is_urgent() const { return urgency_ == kUrgent; }

 private:
  static constexpr uint8_t kLongest = 7;  // letters of a word: DETENTE

  // Words by their number.
  static constexpr uint8_t kStop = 1;  // S and STOP
  static constexpr uint8_t kNoWord = 9;  // so many there are

  // How far the line ends like STOP STOP: its letters, or two S. Or it ends with a slash, or has a
  // comment.
  static constexpr uint8_t kUrgent = 8;
  static constexpr uint8_t kTwoS = 9;
  static constexpr uint8_t kSlash = 16;
  static constexpr uint8_t kComment = 17;

  void add(uint8_t lower_case);
  uint8_t word() const;

  uint8_t word_[kLongest];  // the letters and digits of the line, small; an S or a STOP before an S is left out
  uint8_t count_;           // of them
  uint8_t urgency_;
  bool is_loose_;           // other signs have come than blanks and `;`, or more than a word
};

}  // namespace tiniscript
