// Finds a typed stop in the bytes of a connection: a line of blanks, `;` and one S or STOP.
//
// Such a line begins at power-on, behind CR, LF, 0x00, another control byte but tab, 0x7f, a whole
// cursor-key sequence, or a second of silence, whatever the bytes around it are. Knows no packets
// and no time.

#ifndef TINISCRIPT_LINK_TYPED_STOP_H_
#define TINISCRIPT_LINK_TYPED_STOP_H_

#include <stdint.h>

#include "../vm/flash.h"
#include "../vm/small.h"

namespace tiniscript {

inline bool ends_line(uint8_t byte) { return byte == '\r' || byte == '\n'; }

class TypedStop {
 public:
  // A line begins.
  void begin() { place_ = kBegin; }

  // Takes a byte. Returns whether it ends a line that stops.
  bool put(uint8_t byte) {
    static const uint8_t kWord[] tini_progmem = {'s', 't', 'o', 'p'};
    const uint8_t place = place_;
    if ((byte < ' ' && byte != '\t') || byte == 0x7f) {
      const bool is_stop = is_whole() && ends_line(byte);
      place_ = byte == kEscapeByte ? kEscape : kBegin;
      return is_stop;
    }
    const uint8_t small = byte | 0x20;
    uint8_t next = kOther;
    if (place == kEscape && (byte == '[' || byte == 'O')) {
      next = kSequence;
    } else if (place == kSequence) {
      if (byte >= '@' && byte < 0x80) next = kBegin;
      if (byte >= '0' && byte < '@') next = kSequence;
    } else if (byte == ' ' || byte == '\t' || byte == ';') {
      if (place == kLetter || place == kStop) next = kStop;
      if (place == kBegin || place == kEscape) next = kBegin;
    } else if (place < kStop && small == flash_byte(kWord + place)) {
      next = static_cast<uint8_t>(place + 1);
    } else if (place == kEscape && small == 's') {
      next = kLetter;
    }
    place_ = next;
    return false;
  }

  // Whether the line would stop if it ended here.
  bool is_whole() const {
    const uint8_t place = *const_cast<const volatile uint8_t*>(&place_);
    return place == kLetter || place == kStop;
  }

 private:
  static constexpr uint8_t kEscapeByte = 0x1b;

  // The places up to kStop count the letters of STOP.
  static constexpr uint8_t kBegin = 0;     // nothing but blanks and `;`
  static constexpr uint8_t kLetter = 1;    // S
  static constexpr uint8_t kStop = 4;      // STOP, or a blank behind the word
  static constexpr uint8_t kOther = 5;     // this line stops nothing
  static constexpr uint8_t kEscape = 6;    // behind ESC
  static constexpr uint8_t kSequence = 7;  // in the sequence of a key

  uint8_t place_;
};

}  // namespace tiniscript

#endif  // TINISCRIPT_LINK_TYPED_STOP_H_
