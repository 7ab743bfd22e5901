// Finds stops in the bytes of a client: typed ones and runs of four zeros.
//
// For code that sees bytes which the receiver does not get: a radio's task and the broker's. It has
// the receiver's modes and laws (`../../link/receiver.h`), but none of its packets. It knows
// neither whether a program runs nor whether a frame is whole.

#pragma once

#include <stdint.h>

#include "../../link/key_sequence.h"
#include "../../link/typed_stop.h"
#include "../../link/stop_sequence.h"

namespace tiniscript {

// What a byte completes; the greater value wins.
enum class StopKind : uint8_t {
  kNothing,
  kInFrame,  // a stop of its packet, if that is no whole frame
  kOfRun,    // a stop of the current run
  kStop,
};

class StopFinder {
 public:
  // A connection begins. `is_framed`: with frames.
  void begin(bool is_framed = false) {
    mode_ = is_framed ? Mode::kBegin : Mode::kText;
    begin_line();
  }

  StopKind put(uint8_t byte, uint16_t now_ms) {
    const bool are_zeros = zeros_.count_zeros(byte, now_ms);
    if (zeros_.keep_and_find_silence(byte, now_ms)) end_silence();
    zeros_.take_whole();
    if (byte == 0) return put_zero() || are_zeros ? StopKind::kStop : StopKind::kNothing;
    return mode_ == Mode::kText ? put_text(byte) : put_packet(byte);
  }

  // Whether the beginning of a line stops the current run, if silence follows.
  bool is_at_stop() const {
    return line_ == Line::kHeld || (mode_ != Mode::kFrame && is_typed());
  }

 private:
  enum class Mode : uint8_t { kText, kBegin, kLine, kFrame };
  enum class Line : uint8_t { kNothing, kHeld, kSkipped, kBegun };

  bool is_typed() const { return typed_stop_.kind() != TypedStop::kNone; }
  static bool is_printable(uint8_t byte) { return byte >= ' ' && byte < 0x7f; }

  void begin_line() {
    line_ = Line::kNothing;
    is_printable_ = true;
    keys_.begin();
    typed_stop_.begin();
  }

  void end_silence() {
    mode_ = Mode::kText;
    if (line_ != Line::kBegun) line_ = Line::kNothing;
    typed_stop_.begin();
  }

  // Whether it ends a line that is a typed stop.
  bool put_zero() {
    const bool is_line = mode_ == Mode::kLine || line_ == Line::kBegun;
    const bool is_stop = is_line && is_printable_ && is_typed();
    begin_line();
    mode_ = Mode::kBegin;
    return is_stop;
  }

  StopKind end_line(bool is_stop) {
    begin_line();
    mode_ = Mode::kText;
    return is_stop ? StopKind::kStop : StopKind::kNothing;
  }

  StopKind watch(uint8_t byte) {
    typed_stop_.put(byte);
    return typed_stop_.is_urgent() ? StopKind::kOfRun : StopKind::kNothing;
  }

  StopKind put_text(uint8_t byte) {
    if (ends_line(byte)) return end_line(line_ == Line::kHeld || is_typed());
    if (keys_.put(byte)) {
      if (line_ != Line::kBegun) line_ = Line::kSkipped;
      return StopKind::kNothing;
    }
    if (line_ != Line::kBegun) {
      if (byte <= ' ' || byte == kDelete) {
        line_ = byte == kControlC && line_ <= Line::kHeld ? Line::kHeld : Line::kSkipped;
        return StopKind::kNothing;
      }
      line_ = Line::kBegun;
      is_printable_ = true;
    }
    if (!is_printable(byte)) is_printable_ = false;
    return watch(byte);
  }

  StopKind put_packet(uint8_t byte) {
    if (mode_ == Mode::kLine && ends_line(byte)) return end_line(is_typed());
    if (mode_ == Mode::kBegin) mode_ = Mode::kLine;
    if (!is_printable(byte)) mode_ = Mode::kFrame;
    return mode_ == Mode::kLine ? watch(byte) : take_frame_byte(byte);
  }

  StopKind take_frame_byte(uint8_t byte) {
    const bool is_stop = ends_line(byte) && typed_stop_.kind() == TypedStop::kStrict;
    if ((byte < ' ' && byte != '\t') || byte == kDelete) {
      typed_stop_.begin();
    } else {
      typed_stop_.put(byte);
    }
    return is_stop ? StopKind::kInFrame : StopKind::kNothing;
  }

  static constexpr uint8_t kControlC = 3;
  static constexpr uint8_t kDelete = 0x7f;

  StopSequence zeros_;
  Mode mode_;
  Line line_;
  bool is_printable_;  // all of the line is printable ASCII
  TypedStop typed_stop_;
  KeySequence keys_;
};

}  // namespace tiniscript
