// Splits bytes into packets: frames, lines of text, and what stops a robot: a run of zeros, or a
// line that is a typed stop.
//
// Everything is text until a 0x00. After it everything is frames, until a second passes without a
// byte or the connection is lost; there CR or LF after nothing but printable ASCII ends a line of
// text, because no whole frame looks so, and text goes on.
// Knows where a packet begins and ends; `frames.h` checks whether a frame is whole. Asks `port.h`
// only whether a program runs, for what is typed in a hurry. Holds frames until they are released,
// kWindow of them; a frame that finds no place is dropped. Text is passed on as it arrives. Finds
// the same packets as `receiver.py`, in the same modes and in kStopInFrame, as typed stops are a
// class of their own there. `put` may be called from an interrupt, all other functions from the
// main loop.

#pragma once

#include <stdint.h>

#include "../vm/small.h"
#include "key_sequence.h"
#include "messages.h"
#include "sizes.h"
#include "text_ring.h"
#include "typed_stop.h"
#include "stop_sequence.h"

namespace tiniscript {

// The kind of input waiting in a place.
enum class InputKind : uint8_t { kNone, kFrame, kText };

// The results of `take_text` other than the bytes of a line. A kLineCut is in the place of a line's
// end that never came, or of bytes that found no room; a kLineStop is after what was a typed stop.
constexpr uint8_t kLineEnd = '\n';
constexpr uint8_t kLineCut = 0;
constexpr uint8_t kLineStop = '\r';

// The places of the packets that wait: the main loop looks at one, the interrupt fills one. They
// are the same where nothing waits, or where all places are taken.
template <uint8_t kPlaces>
class PacketPlaces {
 protected:
  uint8_t read_place() const { return read_place_; }
  uint8_t write_place() const { return write_place_; }
  void advance_read() { read_place_ = next_place(read_place_); }
  void advance_write() { write_place_ = next_place(write_place_); }

 private:
  static uint8_t next_place(uint8_t place) { return static_cast<uint8_t>((place + 1) % kPlaces); }

  volatile uint8_t read_place_;
  volatile uint8_t write_place_;
};

template <>
class PacketPlaces<1> {
 protected:
  static constexpr uint8_t read_place() { return 0; }
  static constexpr uint8_t write_place() { return 0; }
  static void advance_read() {}
  static void advance_write() {}
};

class Receiver : private PacketPlaces<kWindow> {
  // Where the next byte belongs. Below kBegin it is text; from kFrame on no line may end here.
  enum class Mode : uint8_t {
    kText,   // between two lines of text, or in one
    kLost,   // in a line of text whose bytes have found no room
    kBegin,  // after a 0x00
    kLine,   // in a frame, or in a line of text: all of it is printable
    kFrame,  // in a frame
    kStopInFrame,  // in a frame with a typed stop in it
  };

  // The state of a line of text: nothing, a stop that waits for silence, bytes that are skipped,
  // some of it, or some before a second of silence and nothing since.
  enum class Line : uint8_t { kNothing, kHeld, kSkipped, kBegun, kPaused };

 public:
  // Takes a byte at the time `now_ms`. Returns whether the motors go off at once: it completes a run
  // of four zeros, the stop sequence, or a typed stop. Eight zeros are two stops. A byte with a
  // framing error is 0.
  bool put(uint8_t byte, uint16_t now_ms) {
    const bool is_stop = count_zeros(byte, now_ms);
    return keep_and_find_stop(byte, now_ms) || is_stop;
  }

  // The halves of `put`, after each of which the caller turns the motors off: the first one returns
  // whether the byte completes a stop sequence, the second one whether it completes a typed stop.
  tini_always_inline bool count_zeros(uint8_t byte, uint16_t now_ms) {
    return zeros_.count_zeros(byte, now_ms);
  }
  bool keep_and_find_stop(uint8_t byte, uint16_t now_ms);

  // The address of the count of zeros: an AVR's interrupt does `count_zeros` in assembly
  // (`receiver_avr.h`).
  struct Layout;

  // Keeps the byte that completes a stop.
  void keep_last_zero() { keep_and_find_stop(0, zeros_.last_ms()); }

  // The connection is lost: what comes next is text, and what has not ended never will.
  void disconnect();

  // Whether a frame waits, the bytes of the first one and their number.
  bool has_frame() const { return input_kinds_[read_place()] == InputKind::kFrame; }
  uint8_t* bytes() { return bytes_[read_place()]; }
  uint8_t length() const { return length_[read_place()]; }

  // Whether a typed stop is in the first frame that waits: unless that is whole, it stops.
  bool frame_may_stop() const { return may_stop_[read_place()]; }
  void let_frame() { may_stop_[read_place()] = false; }

  // Whether the unfinished frame has a typed stop, or one was all between two 0x00, or Ctrl-C is
  // all of the line so far: it stops when no byte has come for kHeldMs.
  bool is_held() const { return mode() == Mode::kStopInFrame || line() == Line::kHeld; }

  // Whether the line so far would be a typed stop if it ended here.
  bool is_at_stop() const {
    return mode() < Mode::kFrame && typed_stop_.kind() != TypedStop::kNone;
  }

  // Whether a second of silence may end a person's line: all of it is printable, or CR or LF is in
  // it.
  bool has_open_line() const {
    return mode() >= Mode::kLine && *const_cast<const volatile bool*>(&may_be_line_);
  }

  // Whether a typed stop waits among the text: the reader of text decides whether it belongs to an
  // open block, and nothing starts before.
  bool has_mark() const { return marks_ != marks_taken_; }
  void put_mark() { marks_ = static_cast<uint8_t>(marks_ + 1); }
  void take_mark() { marks_taken_ = static_cast<uint8_t>(marks_taken_ + 1); }

  // Goes on to the next frame: as if it began now, though it may be whole already.
  void release() {
    if (kWindow > 1) length_[read_place()] = 0;
    input_kinds_[read_place()] = InputKind::kNone;
    if (kWindow == 1) return;
    advance_read();
    has_begun_ = true;
  }

  // Whether text may wait.
  bool has_text() const {
    return input_kinds_[read_place()] == InputKind::kText || !text_.is_empty();
  }

  // Whether the next byte finds room, if it is text.
  bool has_room() const { return text_.has_room(); }

  // Takes the next byte of text, or one of those above. False: none waits.
  bool take_text(uint8_t* byte);

  // Whether bytes of a line have been lost since the last call. A kLineCut tells where.
  bool take_is_lost() {
    const bool is_lost = is_lost_;
    is_lost_ = false;
    return is_lost;
  }

  // Whether any byte has arrived since the last call, which forgets it.
  bool take_has_heard() {
    if (!has_heard_) return false;
    has_heard_ = false;
    return true;
  }

  // Bytes of an unfinished packet may be read up to `length`. `take_has_begun` says whether another
  // packet has begun since the last call: call it before `length`. A packet that begins between the
  // two calls counts as begun, too.
  bool take_has_begun() {
    if (!has_begun_) return false;
    has_begun_ = false;
    return true;
  }

  // Has the robot stop for a typed stop.
  void stop() { due_stop_ = Cause::kText; }

  // Why the robot is to stop since the last `take_stop`, or kNone.
  Cause due_stop() const { return due_stop_; }
  void take_stop() { due_stop_ = Cause::kNone; }

  // The number of damaged and dropped packets. It wraps around to 0.
  uint8_t damaged() const { return damaged_count_; }
  uint8_t dropped() const { return dropped_count_; }

 private:
  // Read where the interrupt may write.
  Mode mode() const { return *const_cast<const volatile Mode*>(&mode_); }
  Line line() const { return *const_cast<const volatile Line*>(&line_); }

  void end_silence();
  bool put_zero();
  bool put_text(uint8_t byte);
  bool put_packet(uint8_t byte);
  bool put_frame(uint8_t byte);
  bool watch(uint8_t byte);
  bool end_line(bool is_there);
  bool stop_at_mark(bool is_there);
  void begin_line();
  void begin_packet();
  void add(uint8_t byte);
  bool end_packet(InputKind kind);
  void cut_line();
  void lose_line();
  void count_damaged() { damaged_count_ = static_cast<uint8_t>(damaged_count_ + 1); }

  // Whether no frame waits before the packet that is being filled.
  bool is_first() const { return write_place() == read_place(); }

  // The most bytes that the packet has which is being filled, if it is a frame.
  uint8_t most_bytes() const {
    return kHasLargeFrames && bytes_[write_place()][0] > kLargeFirst ? kSmallPacket : kPacketBytes;
  }

  // The waiting packets. A line after a 0x00 waits in `bytes_` like a frame, as the last.
  volatile InputKind input_kinds_[kWindow];
  volatile bool has_begun_;
  volatile Cause due_stop_;
  StopSequence zeros_;
  Mode mode_;
  Line line_;
  bool is_line_printable_;  // all of the line is printable ASCII
  bool is_cut_;       // a 0x00 has cut a line: the rest of it is lost
  bool is_dropping_;  // the packet finds no place
  bool may_be_line_;  // the packet may be a person's
  TypedStop typed_stop_;
  KeySequence keys_;
  volatile bool is_lost_;
  volatile bool has_heard_;
  volatile bool may_stop_[kWindow];
  volatile uint8_t marks_;
  uint8_t marks_taken_;
  volatile uint8_t damaged_count_;
  volatile uint8_t dropped_count_;
  uint8_t taken_bytes_;  // bytes of the line in `bytes_`
  volatile uint8_t length_[kWindow];
  TextRing text_;
  uint8_t bytes_[kWindow][kPacketBytes];
};

// The address of a link's receiver.
class OnlyReceiver;
typedef Choice<kIsAvr, OnlyReceiver, Receiver*>::Type ReceiverOfLink;

}  // namespace tiniscript

#ifdef __AVR__
#include "receiver_avr.h"
#endif
