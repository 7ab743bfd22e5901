// Finds where a program begins anew in bytes of text: at a start, `SI|`, `SB|` or `PING|`.
//
// One counts at the begin of a line that goes on with an unfinished program, behind a second of
// silence there, and anywhere in a line that begins like a radio module's message
// (`OK+CONNSI|F(1,60)`), which has no line end of its own.

#ifndef TINISCRIPT_LINK_START_FINDER_H_
#define TINISCRIPT_LINK_START_FINDER_H_

#include <stdint.h>

namespace tiniscript {

class StartFinder {
 public:
  // A line begins, or goes on behind a second of silence.
  void begin(bool is_unfinished) {
    last_ = 0;
    count_ = 0;
    is_unfinished_ = is_unfinished;
    is_message_ = is_word_ = false;
  }

  // Takes a byte. Returns how many letters of a SETUP word it follows, if it is the `|` of a start
  // that begins a program anew, else 0.
  uint8_t put(uint8_t byte) {
    if (byte == ' ' || byte == '\t') return 0;
    const uint16_t two = static_cast<uint16_t>(last_);
    if (byte == '|') {
      const uint8_t letters = two == kSi || two == kSb ? 2 : last_ == kPing ? 4 : 0;
      return is_message_ || (is_unfinished_ && count_ == letters) ? letters : 0;
    }
    const uint8_t capital = byte & 0xdf;
    const bool is_letter = static_cast<uint8_t>(capital - 'A') < 26;
    const bool is_head = (count_ == 2 && (two == kOk || two == kAt)) || (count_ == 4 && last_ == kErro);
    if (is_head) {
      is_message_ = true;
      is_word_ = is_letter && count_ == 2;
    }
    if (count_ == 0 && byte == '+') is_message_ = true;
    last_ = last_ << 8 | capital;
    if (count_ != 255) count_++;
    return 0;
  }

  // A letter of the SETUP word, from the last one, 0, on.
  uint8_t letter(uint8_t at) const { return static_cast<uint8_t>(last_ >> (8 * at)); }

  // Whether the line begins like a radio module's message, and whether that is no word like ATTACK.
  bool is_message() const { return is_message_; }
  bool is_chatter() const { return is_message_ && !is_word_; }

 private:
  static constexpr uint16_t kSi = 'S' << 8 | 'I';
  static constexpr uint16_t kSb = 'S' << 8 | 'B';
  static constexpr uint16_t kOk = 'O' << 8 | 'K';
  static constexpr uint16_t kAt = 'A' << 8 | 'T';
  static constexpr uint32_t kPing = 0x50494e47;  // PING
  static constexpr uint32_t kErro = 0x4552524f;  // ERRO

  uint32_t last_;  // the last four signs, in capitals
  uint8_t count_;  // of signs in the line
  bool is_unfinished_;
  bool is_message_;
  bool is_word_;
};

}  // namespace tiniscript

#endif  // TINISCRIPT_LINK_START_FINDER_H_
