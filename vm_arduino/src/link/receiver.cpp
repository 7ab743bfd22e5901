#include "receiver.h"

#include "port.h"

namespace tiniscript {

namespace {

constexpr uint8_t kControlC = 3;
constexpr uint8_t kEscape = 0x1b;
constexpr uint8_t kDelete = 0x7f;

// Properties that every byte of a line has and a frame never has.
bool is_printable(uint8_t byte) { return byte >= ' ' && byte < kDelete; }

bool is_running() { return port_status().state == State::kRunning; }

bool is_control(uint8_t byte) { return (byte < ' ' && byte != '\t') || byte == kDelete; }

}  // namespace

tini_noinline bool Receiver::keep_and_find_stop(uint8_t byte, uint16_t now_ms) {
  has_heard_ = true;
  if (zeros_.keep_and_find_silence(byte, now_ms)) end_silence();
  if (byte == 0) return put_zero();
  return mode_ < Mode::kBegin ? put_text(byte) : put_packet(byte);
}

// A second without a byte: text comes again. A typed stop begins here whatever was before.
inline void Receiver::end_silence() {
  if (mode_ >= Mode::kBegin) {
    if (mode_ > Mode::kBegin) count_damaged();
    mode_ = Mode::kText;
    is_cut_ = false;
  }
  line_ = line_ >= Line::kBegun ? Line::kPaused : Line::kNothing;
  keys_.begin();
  typed_stop_.begin();
}

// Frames come from here on. A 0x00 ends a frame, or a line that is cut: a typed stop counts all the
// same. In frames it waits, or comes a second time: it may be what is left of one.
inline bool Receiver::put_zero() {
  bool is_stop = false;
  Line next_line = Line::kNothing;
  if (mode_ >= Mode::kFrame) {
    is_stop = !end_packet(InputKind::kFrame) && mode_ == Mode::kStopInFrame;
    is_cut_ = false;
  } else if (mode_ == Mode::kLine || line_ >= Line::kBegun) {
    is_stop = is_line_printable_ && typed_stop_.kind() != TypedStop::kNone;
    is_cut_ = true;
    if (!is_stop) cut_line();
    if (is_stop && mode_ == Mode::kLine && line_ != Line::kHeld) {
      next_line = Line::kHeld;
      is_stop = false;
    }
  }
  begin_line();
  line_ = next_line;
  mode_ = Mode::kBegin;
  if (is_stop) stop();
  if (zeros_.take_whole()) due_stop_ = Cause::kSequence;
  return is_stop;
}

// -- text -------------------------------------------------------------------------------------------

inline bool Receiver::put_text(uint8_t byte) {
  if ((byte == kEscape || keys_.is_active()) && keys_.put(byte)) {
    if (line_ < Line::kBegun) line_ = Line::kSkipped;
    return false;
  }
  if (ends_line(byte)) {
    if (line_ >= Line::kBegun) return end_line(mode_ == Mode::kText && text_.put(kLineEnd));
    if (line_ != Line::kHeld) line_ = Line::kNothing;
    if (text_.is_empty()) text_.put(kLineEnd);  // only to tell that lines end here
    return false;
  }
  if (line_ != Line::kBegun) {
    if (byte == kControlC && line_ != Line::kSkipped) {
      line_ = Line::kHeld;
      return false;
    }
    if (line_ != Line::kPaused && (byte <= ' ' || byte == kDelete)) {
      line_ = Line::kSkipped;
      return false;
    }
    line_ = Line::kBegun;
    is_line_printable_ = true;
  }
  if (!is_printable(byte)) is_line_printable_ = false;
  if (mode_ == Mode::kText && !text_.put(byte)) {
    count_damaged();
    mode_ = Mode::kLost;
  }
  return watch(byte);
}

// Looks for a stop that does not wait for the end of its line.
inline bool Receiver::watch(uint8_t byte) {
  typed_stop_.put(byte);
  if (!typed_stop_.is_urgent() || !is_running()) return false;
  typed_stop_.begin();
  return stop_at_mark(mode_ == Mode::kText);
}

// A line has ended; `is_there`: all of it waits to be read. After a 0x00 only S and STOP stop at once.
bool Receiver::end_line(bool is_there) {
  const TypedStop::Kind kind = typed_stop_.kind();
  const bool was_text = mode_ < Mode::kBegin;
  begin_line();
  mode_ = Mode::kText;
  is_cut_ = false;
  if (kind == TypedStop::kStrict || (kind != TypedStop::kNone && was_text)) {
    return stop_at_mark(is_there);
  }
  if (kind != TypedStop::kNone) line_ = Line::kHeld;
  if (!is_there) lose_line();
  return false;
}

// -- frames -----------------------------------------------------------------------------------------

inline bool Receiver::put_packet(uint8_t byte) {
  if (mode_ == Mode::kBegin) {
    begin_packet();
  } else if (mode_ == Mode::kLine && ends_line(byte)) {
    return end_line(!is_cut_ && end_packet(InputKind::kText));
  }
  add(byte);
  if (mode_ == Mode::kLine && !is_printable(byte)) {
    mode_ = Mode::kFrame;
    line_ = Line::kNothing;
    may_be_line_ = false;
  }
  return mode_ == Mode::kLine ? watch(byte) : put_frame(byte);
}

// Looks for a typed stop with a line of its own. It waits: the frame may be whole.
inline bool Receiver::put_frame(uint8_t byte) {
  if (ends_line(byte)) {
    may_be_line_ = true;
    if (typed_stop_.kind() == TypedStop::kStrict) mode_ = Mode::kStopInFrame;
  }
  if (is_control(byte)) {
    typed_stop_.begin();
  } else {
    typed_stop_.put(byte);
  }
  if (mode_ != Mode::kStopInFrame || !is_dropping_) return false;
  mode_ = Mode::kFrame;  // what is dropped is never whole
  stop();
  return true;
}

// Counts a packet that begins while all places are taken.
void Receiver::begin_packet() {
  mode_ = Mode::kLine;
  is_line_printable_ = true;
  may_be_line_ = true;
  is_dropping_ = input_kinds_[write_place()] != InputKind::kNone;
  if (is_dropping_) {
    dropped_count_ = static_cast<uint8_t>(dropped_count_ + 1);
    return;
  }
  length_[write_place()] = 0;
  if (is_first()) has_begun_ = true;
}

// Leaves a waiting packet and its length unchanged.
void Receiver::add(uint8_t byte) {
  if (is_dropping_) return;
  const uint8_t length = length_[write_place()];
  if (length == most_bytes()) {
    is_dropping_ = true;
    return count_damaged();
  }
  bytes_[write_place()][length] = byte;
  length_[write_place()] = static_cast<uint8_t>(length + 1);
}

// A line that may overtake older text, or a frame, is dropped. Returns whether the packet waits.
bool Receiver::end_packet(InputKind kind) {
  if (is_dropping_) return false;
  taken_bytes_ = 0;
  if (kind == InputKind::kFrame || (text_.is_empty() && is_first())) {
    may_stop_[write_place()] = mode_ == Mode::kStopInFrame;
    input_kinds_[write_place()] = kind;
    if (kind == InputKind::kFrame) advance_write();
    return true;
  }
  dropped_count_ = static_cast<uint8_t>(dropped_count_ + 1);
  return false;
}

// -- both -------------------------------------------------------------------------------------------

void Receiver::begin_line() {
  line_ = Line::kNothing;
  keys_.begin();
  typed_stop_.begin();
}

// Leaves a mark after a typed stop, where all before it waits to be read. A stop that finds no place
// for it belongs to no block.
bool Receiver::stop_at_mark(bool is_there) {
  if (is_there && text_.put(kLineStop)) {
    put_mark();
  } else {
    stop();
  }
  return true;
}

// The line that has begun never ends.
void Receiver::cut_line() {
  count_damaged();
  text_.put_last(kLineCut);
}

// Bytes of the line have found no place.
void Receiver::lose_line() {
  is_lost_ = true;
  text_.put_last(kLineCut);
}

// Waiting input no longer belongs to anyone, except a stop.
void Receiver::disconnect() {
  bool is_stop = has_mark();
  for (uint8_t k = 0; k < kWindow; k++)
    is_stop |= input_kinds_[k] == InputKind::kFrame && may_stop_[k];
  const Cause cause = is_stop ? Cause::kText : due_stop_;
  const uint8_t damaged_count = damaged_count_;
  const uint8_t dropped_count = dropped_count_;
  *this = Receiver();
  due_stop_ = cause;
  damaged_count_ = damaged_count;
  dropped_count_ = dropped_count;
}

bool Receiver::take_text(uint8_t* byte) {
  if (input_kinds_[read_place()] == InputKind::kText) {
    if (taken_bytes_ < length_[read_place()]) {
      *byte = bytes_[read_place()][taken_bytes_++];
      return true;
    }
    asm volatile("" ::: "memory");  // barrier: the bytes are read before the interrupt may write
    input_kinds_[read_place()] = InputKind::kNone;
    *byte = kLineEnd;
    return true;
  }
  return text_.take(byte);
}

}  // namespace tiniscript
