#include "receiver.h"

#include "../vm/small.h"

namespace tiniscript {

namespace {

bool is_letter(uint8_t byte) {
  const uint8_t small = static_cast<uint8_t>(byte | 0x20);
  return small >= 'a' && small <= 'z';
}

bool is_blank(uint8_t byte) { return byte == ' ' || byte == '\t' || ends_line(byte); }

// In a line of text. Bytes beyond ASCII are UTF-8.
bool is_printable(uint8_t byte) { return byte >= ' ' && byte != 0x7f; }

}  // namespace

tini_noinline bool Receiver::take(uint8_t byte, uint16_t now_ms) {
  has_heard_ = true;
  const bool is_quiet = this->is_quiet(now_ms);
  last_ms_ = now_ms;
  if (is_quiet) {  // a typed stop in a frame has acted long ago
    const bool is_text =
        place_ == Place::kText || place_ == Place::kLost || place_ == Place::kAfterText;
    if (!is_kept_ || !is_text) cut();
    zeros_ = 1;  // this byte, if it is one
    typed_.begin();
  }
  const Place before = place_;
  const bool is_typed = typed_.put(byte);
  if (byte == 0) {
    zero();
  } else {
    zeros_ = 0;
    sort(byte);
  }
  if (is_typed) {
    if (is_marked(before)) return true;
    if (is_frame() && !is_dropping_) {  // one that is dropped is not whole
      place_ = Place::kHeld;
      return false;
    }
  } else if (before != Place::kHeld || place_ != Place::kSkip) {
    return false;
  }
  stop();
  return true;
}

// Takes a byte that is not 0.
inline void Receiver::sort(uint8_t byte) {
  if (place_ >= Place::kBlank && place_ <= Place::kCrLf) {
    // The second byte of a request is its type, and no frame to a robot begins like this.
    if (is_printable(byte) && byte < 0x80) {
      place_ = Place::kAfterText;
    } else if (place_ == Place::kCr && byte == '\n') {
      place_ = Place::kCrLf;
      return add(byte);
    } else {
      place_ = Place::kFrame;
      drop();
    }
  }
  if (place_ == Place::kAfterText && is_blank(byte)) return;
  if (place_ <= Place::kAfterText) {
    begin(byte);
  } else {
    go_on(byte);
  }
}

// A line has ended that is a typed stop; `before` is where the receiver was before its end. Returns
// whether all of it has found a place as text, and a mark behind it.
bool Receiver::is_marked(Place before) {
  const bool is_in_packet = before >= Place::kHead && before <= Place::kOther && !is_dropping_ &&
                            packet_[filled()] == Packet::kText;
  if (before != Place::kText && !is_in_packet) return false;
  if (place_ == Place::kAfterText) pass_on(kLineStop);
  if (place_ != Place::kAfterText) return false;
  marks_ = static_cast<uint8_t>(marks_ + 1);
  return true;
}

// Determines the kind of a packet from its first byte, as far as possible. A frame after text has a
// zero before it, so while text waits, or a line of it is open, what follows it is text.
void Receiver::begin(uint8_t byte) {
  if (byte == 0x7f) return skip();
  const bool goes_on = place_ == Place::kAfterText &&
                       (is_kept_ || first_ != behind_ || packet_[filled()] == Packet::kText);
  if (is_letter(byte) || (goes_on && is_printable(byte))) {
    place_ = Place::kText;
    return pass_on(byte);
  }
  is_dropping_ = packet_[filled()] != Packet::kNone;
  if (!is_dropping_) {
    length_[filled()] = 0;
    if (is_first()) has_begun_ = true;
  }
  if (byte >= kTextFrom) {
    place_ = Place::kOther;
  } else if (is_blank(byte)) {
    place_ = byte == '\r' ? Place::kCr : Place::kBlank;
  } else {
    place_ = byte > ' ' ? Place::kHead : Place::kFrame;
  }
  if (!is_blank(byte)) drop();
  add(byte);
}

// Takes a further byte of a packet.
void Receiver::go_on(uint8_t byte) {
  const bool is_text = is_printable(byte) || byte == '\t';
  if (place_ == Place::kSkip) return;
  if (place_ >= Place::kText) {
    if (ends_line(byte)) return end_text(place_ == Place::kText ? kLineEnd : kLineCut);
    if (place_ == Place::kText) pass_on(byte);
    return;
  }
  if (place_ == Place::kHead) {
    place_ = is_printable(byte) ? Place::kLine : Place::kFrame;  // request types are smaller
  } else if (!is_frame() && ends_line(byte)) {
    place_ = Place::kAfterText;
    if (!end(Packet::kText)) lose();
    return;
  } else if (place_ == Place::kLine && !is_text) {
    place_ = Place::kFrame;
  } else if (place_ == Place::kOther && !is_text) {
    return skip();
  }
  if (length_[filled()] == most_bytes() && !is_dropping_) {
    if (is_frame()) return skip();
    place_ = Place::kText;
    end(Packet::kText);
    is_begun_ = true;
    if (packet_[filled()] != Packet::kText) {
      place_ = Place::kLost;
      is_lost_ = true;
    }
    if (place_ == Place::kText) pass_on(byte);
    return;
  }
  add(byte);
}

void Receiver::skip() {
  damaged_ = static_cast<uint8_t>(damaged_ + 1);
  place_ = Place::kSkip;
}

// Counts a packet that begins while another one waits.
void Receiver::drop() {
  if (is_dropping_) dropped_ = static_cast<uint8_t>(dropped_ + 1);
}

// Leaves a waiting packet and its length unchanged.
void Receiver::add(uint8_t byte) {
  const uint8_t length = length_[filled()];
  if (is_dropping_ || length == kPacketBytes) return;
  bytes_[filled()][length] = byte;
  length_[filled()] = static_cast<uint8_t>(length + 1);
}

void Receiver::zero() {
  if (place_ >= Place::kBlank && place_ <= Place::kHeld && place_ != Place::kOther) {
    end(Packet::kFrame);
    place_ = Place::kBegin;
  } else {
    cut();
  }
  if (zeros_ != kStopRun) return;
  zeros_ = 0;  // four more zeros are another stop
  due_stop_ = Cause::kSequence;
}

// Starts over; the open packet never ended.
void Receiver::cut() {
  const Place place = place_;
  place_ = Place::kBegin;
  if (place >= Place::kBlank && place <= Place::kText) damaged_ = static_cast<uint8_t>(damaged_ + 1);
  if (place == Place::kText || place == Place::kLost) pass_on(kLineCut);
}

// A line that may overtake older text, or a frame, is dropped. Returns whether the packet waits.
bool Receiver::end(Packet packet) {
  if (is_dropping_) return false;
  is_begun_ = false;
  taken_ = 0;
  if (packet == Packet::kFrame || (first_ == behind_ && is_first())) {
    may_stop_[filled()] = place_ == Place::kHeld;
    packet_[filled()] = packet;
    if (packet == Packet::kFrame) fill_on();
    return true;
  }
  dropped_ = static_cast<uint8_t>(dropped_ + 1);
  return false;
}

// Passes a byte of text on. Where there is no room, the rest of its line is skipped. The last place is
// for a kLineCut: if that is taken, it tells of what is lost now, too.
void Receiver::pass_on(uint8_t byte) {
  const uint8_t at = behind_;
  const uint8_t behind = static_cast<uint8_t>(at + 1) % kTextBytes;
  const uint8_t room = static_cast<uint8_t>(first_ - behind) % kTextBytes;
  if (byte == kLineCut) {
    if (room == 0) return;
  } else if (room < 2) {
    if (place_ != Place::kLost) damaged_ = static_cast<uint8_t>(damaged_ + 1);
    place_ = Place::kLost;
    is_lost_ = true;
    return;
  }
  text_[at] = byte;
  asm volatile("" ::: "memory");  // barrier: `take_text` reads the byte after the index
  behind_ = behind;
}

// A line has found no room as a packet.
void Receiver::lose() {
  is_lost_ = true;
  pass_on(kLineCut);
}

void Receiver::end_text(uint8_t byte) {
  place_ = Place::kAfterText;
  pass_on(byte);
}

bool Receiver::take_text(uint8_t* byte) {
  if (packet_[looked_at()] == Packet::kText) {
    if (taken_ < length_[looked_at()]) {
      *byte = bytes_[looked_at()][taken_++];
      return true;
    }
    const bool is_over = !is_begun_;
    asm volatile("" ::: "memory");  // barrier: the bytes are read before the interrupt may write
    packet_[looked_at()] = Packet::kNone;
    if (is_over) {
      *byte = kLineEnd;
      return true;
    }
  }
  const uint8_t first = first_;
  if (first == behind_) return false;
  *byte = text_[first];
  asm volatile("" ::: "memory");
  first_ = static_cast<uint8_t>(first + 1) % kTextBytes;
  return true;
}

}  // namespace tiniscript
