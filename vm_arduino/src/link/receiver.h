// Splits bytes into items: frames, lines of text, and the run of zeros that stops a robot.
//
// Knows where an item begins and ends; `frames.h` checks whether a frame is whole. Holds one item
// until it is released; anything but a stop that arrives meanwhile is dropped. Matches
// `receiver.py`. `put` may be called from an interrupt, everything else from the main loop.

#ifndef TINISCRIPT_LINK_RECEIVER_H_
#define TINISCRIPT_LINK_RECEIVER_H_

#include <stdint.h>

#include "messages.h"

namespace tiniscript {

constexpr uint8_t kItemBytes = kLargestFrame + 1;  // a frame and its first COBS byte

enum class Item : uint8_t { kNone, kFrame, kText };

class Receiver {
 public:
  // Takes a byte at the time `now_ms`. Returns whether it completes a run of four zeros, the stop
  // sequence: the motors then go off at once. Eight zeros are two stops. A byte with a framing
  // error is 0.
  bool put(uint8_t byte, uint16_t now_ms);

  // The waiting item, its bytes and their number. For a text longer than kItemBytes: its first
  // bytes, and a length of at most 255.
  Item item() const { return item_; }
  uint8_t* bytes() { return bytes_; }
  uint8_t length() const { return length_; }
  void release() { item_ = Item::kNone; }

  // Bytes of an unfinished item may be read up to `length`. `has_begun` says whether another item
  // has begun since the last call: call it before `length`. An item that begins between the two
  // calls counts as begun, too.
  bool has_begun() {
    if (!has_begun_) return false;
    has_begun_ = false;
    return true;
  }

  // Whether a stop has arrived since the last `take_stop`.
  bool stop_is_due() const { return stop_is_due_; }
  void take_stop() { stop_is_due_ = false; }

  // The number of damaged and dropped items. It wraps around to 0.
  uint8_t damaged() const { return damaged_; }
  uint8_t dropped() const { return dropped_; }

 private:
  enum class Place : uint8_t {
    kBegin,      // the next byte begins an item
    kAfterText,  // the same, except for white space
    kBlank,      // after white space; a frame may also begin
    kHead,       // after the first byte of a frame or a line of text
    kLine,       // probably in a line of text, otherwise in a frame
    kFrame,
    kOther,  // probably in a line of text, otherwise in noise
    kText,
    kSkip,  // in noise, up to the next 0x00
  };

  bool take(uint8_t byte, uint16_t now_ms);
  bool zero();
  void cut();
  void begin(uint8_t byte);
  void go_on(uint8_t byte);
  void skip();
  void drop();
  void add(uint8_t byte);
  void end(Item item);

  volatile Item item_;
  volatile bool has_begun_;
  volatile bool stop_is_due_;
  volatile uint8_t damaged_;
  volatile uint8_t dropped_;
  Place place_;
  bool is_dropping_;
  uint8_t zeros_;
  volatile uint8_t length_;
  uint16_t last_ms_;
  uint8_t bytes_[kItemBytes];
};

}  // namespace tiniscript

#endif  // TINISCRIPT_LINK_RECEIVER_H_
