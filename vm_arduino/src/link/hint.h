// What stands for the console on a robot that reads no text: a line is answered with a hint.
//
// Has the interface of `console.h` as far as the link needs it. A line gets no answer if frames
// arrive, if another line came recently, or if it is our own: so nobody who echoes or answers each
// line talks to a robot for ever.

#ifndef TINISCRIPT_LINK_HINT_H_
#define TINISCRIPT_LINK_HINT_H_

#include <stdint.h>

#include "messages.h"
#include "receiver.h"

namespace tiniscript {

class Hint {
 public:
  enum class Act : uint8_t { kNone, kStop, kEnd, kStart };

  void pass(uint16_t passed_ms) {
    left_ms_ = passed_ms < left_ms_ ? static_cast<uint16_t>(left_ms_ - passed_ms) : 0;
  }
  Act turn(Receiver* receiver, bool is_heard);
  bool has_answer() const { return is_due_; }
  uint8_t write(uint8_t* out);

  void discard() {}
  void drop() {}
  void hang_up() {}
  bool is_talking() const { return false; }
  bool is_open() const { return false; }

 private:
  uint16_t left_ms_;  // until a line is answered again
  bool is_due_;
};

}  // namespace tiniscript

#endif  // TINISCRIPT_LINK_HINT_H_
