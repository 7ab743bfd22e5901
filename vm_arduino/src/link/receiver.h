// Bytes to items: frames, lines of text, and the run of zeros that stops a robot.
//
// Knows where an item begins and ends; not whether a frame is whole: `frames.h` does. Holds one
// item until it is released; what comes meanwhile is dropped, but for a stop. Means the same as
// `receiver.py`. `put` may be called from an interrupt, everything else from the main loop.

#ifndef TINISCRIPT_LINK_RECEIVER_H_
#define TINISCRIPT_LINK_RECEIVER_H_

#include <stdint.h>

#include "messages.h"

namespace tiniscript {

constexpr uint8_t kItemBytes = kLargestFrame + 1;  // a frame and the first byte of its COBS

enum class Item : uint8_t { kNone, kFrame, kText };

class Receiver {
 public:
  // Takes a byte at the time `now_ms`. Returns whether it completes a run of four zeros, which
  // means stop: then the motors go off there and then. Eight zeros are two stops. A byte that came
  // damaged (a framing error) is 0.
  bool put(uint8_t byte, uint16_t now_ms);

  // The item that waits, its bytes and how many: of a text that is longer than kItemBytes, the
  // first ones, and 255 for what is longer than that.
  Item item() const { return item_; }
  uint8_t* bytes() { return bytes_; }
  uint8_t length() const { return length_; }
  void release() { item_ = Item::kNone; }

  // Whether a stop has arrived since the last `take_stop`.
  bool stop_is_due() const { return stop_is_due_; }
  void take_stop() { stop_is_due_ = false; }

  // How many damaged and dropped items there have been. They begin again at 0.
  uint8_t damaged() const { return damaged_; }
  uint8_t dropped() const { return dropped_; }

 private:
  enum class Place : uint8_t {
    kBegin,      // the next byte begins an item
    kAfterText,  // the same, but for white space
    kBlank,      // after white space, which may begin a frame too
    kHead,       // after the first byte of a frame or of a line of text
    kLine,       // in a line of text, as far as it looks; else in a frame
    kFrame,
    kOther,  // in a line of text, as far as it looks; else in noise
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
  volatile bool stop_is_due_;
  volatile uint8_t damaged_;
  volatile uint8_t dropped_;
  Place place_;
  bool is_dropping_;
  uint8_t zeros_;
  uint8_t length_;
  uint16_t last_ms_;
  uint8_t bytes_[kItemBytes];
};

}  // namespace tiniscript

#endif  // TINISCRIPT_LINK_RECEIVER_H_
