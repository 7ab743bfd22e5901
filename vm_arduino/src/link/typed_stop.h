// Finds a typed stop in the bytes of a line, whatever its spelling.
//
// Only ASCII letters and digits count, in any case, and nothing behind `//`. Knows no packets and no
// time. `docs/link.md` says which stop counts where.

#ifndef TINISCRIPT_LINK_TYPED_STOP_H_
#define TINISCRIPT_LINK_TYPED_STOP_H_

#include <stdint.h>

namespace tiniscript {

inline bool ends_line(uint8_t byte) { return byte == '\r' || byte == '\n'; }

class TypedStop {
 public:
  // A line begins.
  void begin();

  // Takes a byte that does not end a line.
  void put(uint8_t byte);

  // Whether the line would be a stop if it ended here: one or more S, one or more STOP, STOP NOW, or
  // a word of people who speak Spanish, Portuguese or English.
  bool is_whole() const;

  // Whether it would be one in a packet that is, or was, a frame: one S or STOP, blanks and `;`.
  bool is_strict() const;

  // Whether the byte was the last of three S in a row, or of a second STOP, wherever in a line: these
  // do not wait for its end.
  bool is_urgent() const { return hurry_ == kUrgent; }

 private:
  static constexpr uint8_t kLongest = 7;  // letters of a word: DETENTE
  static constexpr uint8_t kMost = 255;   // letters of a line that are counted

  // How far the line ends like STOP STOP: letters of it, or two S.
  static constexpr uint8_t kUrgent = 8;
  static constexpr uint8_t kTwoS = 9;

  bool is_word() const;

  uint8_t word_[kLongest];  // the first letters and digits of the line, small
  uint8_t count_;           // of them
  uint8_t fit_;             // how many of the first are those of SSS or of STOPSTOP
  uint8_t hurry_;
  uint8_t slashes_;         // in a row; two begin a comment
  bool is_loose_;           // other signs have come than blanks and `;`
};

}  // namespace tiniscript

#endif  // TINISCRIPT_LINK_TYPED_STOP_H_
