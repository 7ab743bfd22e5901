// Splits bytes into packets: frames, lines of text, and what stops a robot: a run of zeros, or a
// line that is a typed stop.
//
// Knows where a packet begins and ends; `frames.h` checks whether a frame is whole. Holds frames
// until they are released, kWindow of them; a frame that finds no place is dropped. Text is passed
// on as it arrives.
// Finds the same packets as `receiver.py`. `put` may be called from an interrupt, everything else
// from the main loop.

#ifndef TINISCRIPT_LINK_RECEIVER_H_
#define TINISCRIPT_LINK_RECEIVER_H_

#include <stddef.h>
#include <stdint.h>

#include "../vm/small.h"
#include "messages.h"
#include "sizes.h"
#include "typed_stop.h"

namespace tiniscript {

enum class Packet : uint8_t { kNone, kFrame, kText };

// What `take_text` returns beside the bytes of a line. kLineStop is behind the end of a line that is
// a typed stop.
constexpr uint8_t kLineEnd = '\n';
constexpr uint8_t kLineCut = 0;
constexpr uint8_t kLineStop = '\r';

// The places of the packets that wait: the main loop looks at one, the interrupt fills one. They
// are the same where nothing waits, or where all places are taken.
template <uint8_t kPlaces>
class PacketPlaces {
 protected:
  uint8_t looked_at() const { return looked_at_; }
  uint8_t filled() const { return filled_; }
  void look_on() { looked_at_ = behind(looked_at_); }
  void fill_on() { filled_ = behind(filled_); }

 private:
  static uint8_t behind(uint8_t place) { return static_cast<uint8_t>((place + 1) % kPlaces); }

  volatile uint8_t looked_at_;
  volatile uint8_t filled_;
};

template <>
class PacketPlaces<1> {
 protected:
  static constexpr uint8_t looked_at() { return 0; }
  static constexpr uint8_t filled() { return 0; }
  static void look_on() {}
  static void fill_on() {}
};

class Receiver : private PacketPlaces<kWindow> {
 public:
  // Takes a byte at the time `now_ms`. Returns whether the motors go off at once: it completes a run
  // of four zeros, the stop sequence, or a typed stop. Eight zeros are two stops. A byte with a
  // framing error is 0.
  bool put(uint8_t byte, uint16_t now_ms) {
    const bool is_stop = stops(byte, now_ms);
    return take(byte, now_ms) || is_stop;
  }

  // The halves of `put`: between them the caller turns the motors off.
  tini_always_inline bool stops(uint8_t byte, uint16_t now_ms) {
    if (byte != 0) return false;
    const uint8_t zeros = static_cast<uint8_t>(zeros_ + 1);
    zeros_ = zeros;
    if (zeros != kStopRun || is_quiet(now_ms)) return false;
    last_ms_ = now_ms;
    return true;
  }
  bool take(uint8_t byte, uint16_t now_ms);

#ifdef __AVR__
  // Where `zeros_` and `last_ms_` lie: its interrupt does `stops` in assembly.
  static constexpr size_t zeros_at() { return offsetof(Receiver, zeros_); }
  static constexpr size_t last_ms_at() { return offsetof(Receiver, last_ms_); }
#endif

  // Takes the byte that completes a stop.
  void take_last_zero() { take(0, last_ms_); }

  // Whether a frame waits, the bytes of the first one and their number.
  bool has_frame() const { return packet_[looked_at()] == Packet::kFrame; }
  uint8_t* bytes() { return bytes_[looked_at()]; }
  uint8_t length() const { return length_[looked_at()]; }

  // Whether a typed stop is in the first frame that waits: unless that is whole, it stops.
  bool frame_may_stop() const { return may_stop_[looked_at()]; }
  void let_frame() { may_stop_[looked_at()] = false; }

  // Whether a typed stop is in the unfinished frame: it stops when no byte has come for kHeldMs.
  bool is_held() const { return *const_cast<const volatile Place*>(&place_) == Place::kHeld; }

  // Whether what has come of a line would be a typed stop if it ended here.
  bool is_at_stop() const { return typed_.is_whole(); }

  // Whether a typed stop waits among the text: whether it belongs to an open block is decided where
  // text is read, and nothing starts before.
  bool has_mark() const { return marks_ != marks_taken_; }
  void take_mark() { marks_taken_ = static_cast<uint8_t>(marks_taken_ + 1); }

  // Goes on to the next frame: as if it began now, though it may be whole already.
  void release() {
    if (kWindow > 1) length_[looked_at()] = 0;
    packet_[looked_at()] = Packet::kNone;
    if (kWindow == 1) return;
    look_on();
    has_begun_ = true;
  }

  // Whether text may wait.
  bool has_text() const { return packet_[looked_at()] == Packet::kText || first_ != behind_; }

  // Takes the next byte of text. kLineEnd: the line is whole. kLineCut: it never ends, or bytes of
  // it were lost. False: none waits.
  bool take_text(uint8_t* byte);

  // Whether a line has found no room since the last call. A kLineCut tells where.
  bool take_lost() {
    const bool is_lost = is_lost_;
    is_lost_ = false;
    return is_lost;
  }

  // Whether a second of silence leaves the open line or program of text as it is. The caller limits
  // its time.
  void keep_line(bool is_kept) { is_kept_ = is_kept; }

  // Whether any byte has arrived since the last call.
  bool has_heard() {
    if (!has_heard_) return false;
    has_heard_ = false;
    return true;
  }

  // Bytes of an unfinished packet may be read up to `length`. `has_begun` says whether another
  // packet has begun since the last call: call it before `length`. A packet that begins between the
  // two calls counts as begun, too.
  bool has_begun() {
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
  uint8_t damaged() const { return damaged_; }
  uint8_t dropped() const { return dropped_; }

 private:
  enum class Place : uint8_t {
    kBegin,      // the next byte begins a packet
    kAfterText,  // the same, except for white space
    kBlank,      // after white space; a frame may also begin
    kCr,         // the same after CR, and after CR and LF
    kCrLf,
    kHead,       // after the first byte of a frame or a line of text
    kLine,       // probably in a line of text, otherwise in a frame
    kOther,      // probably in a line of text, otherwise in noise
    kFrame,
    kHeld,  // in a frame with a typed stop in it
    kText,
    kLost,  // in a line of text whose bytes found no room
    kSkip,  // in noise, up to the next 0x00
  };

  tini_always_inline bool is_quiet(uint16_t now_ms) const {
    return static_cast<uint16_t>(now_ms - last_ms_) >= kSilenceMs;
  }
  void zero();
  void sort(uint8_t byte);
  void cut();
  void begin(uint8_t byte);
  void go_on(uint8_t byte);
  void skip();
  void drop();
  void add(uint8_t byte);
  bool end(Packet packet);
  void pass_on(uint8_t byte);
  void end_text(uint8_t byte);
  void lose();
  bool is_marked(Place before);

  bool is_frame() const { return place_ == Place::kFrame || place_ == Place::kHeld; }

  // Whether no frame waits before the packet that is being filled.
  bool is_first() const { return filled() == looked_at(); }

  // The most bytes that the packet has which is being filled, if it is a frame.
  uint8_t most_bytes() const {
    return kHasLargeFrames && bytes_[filled()][0] > kLargeFirst ? kSmallPacket : kPacketBytes;
  }

  // The waiting packets. A line that may be a frame waits in `bytes_` like one, as the last.
  volatile Packet packet_[kWindow];
  volatile bool has_begun_;
  volatile Cause due_stop_;
  TypedStop typed_;
  volatile bool is_lost_;
  volatile bool may_stop_[kWindow];
  volatile uint8_t marks_;
  uint8_t marks_taken_;
  volatile uint8_t damaged_;
  volatile uint8_t dropped_;
  Place place_;
  bool is_dropping_;
  bool is_begun_;            // the line in `bytes_` goes on in `text_`
  volatile bool is_kept_;
  volatile bool has_heard_;
  uint8_t taken_;            // bytes of the line in `bytes_`
  volatile uint8_t first_;   // the text that waits, in a ring
  volatile uint8_t behind_;
  uint8_t text_[kTextBytes];
  uint8_t zeros_;
  volatile uint8_t length_[kWindow];
  uint16_t last_ms_;
  uint8_t bytes_[kWindow][kPacketBytes];
};

#ifdef __AVR__

// Where a link has its receiver. An AVR has one link, and a known address takes less flash than a
// pointer in memory does, and less time.
class ReceiverOfLink {
 public:
  void operator=(Receiver*) {}
  Receiver* operator->() const { return *this; }
  operator Receiver*() const {
    extern Receiver receiver;  // firmware/firmware.cpp
    return &receiver;
  }
};

#else

typedef Receiver* ReceiverOfLink;

#endif

}  // namespace tiniscript

#endif  // TINISCRIPT_LINK_RECEIVER_H_
