// Readings of programs, reported to a session that wants them, and values that a program shows
// meanwhile.
//
// A reading delays no program. While it is being sent, a SHOW finds room where it would without:
// its value waits here instead. `lag_bytes_` is the number of bytes by which the line lags one
// without readings: the rest of a reading and the port's share of it, at the moment when another
// message began to wait for it.

#include "../vm/build.h"
#include "link.h"
#include "port.h"

#ifdef tiniscript_tells_readings

namespace tiniscript {

void Link::tell_readings(bool is_on) {
  tells_readings_ = is_on;
  port_tell_readings(is_on);
}

// Whether the line would be free without readings. A due reply is assumed to take as long as the
// last one: a client that watches a run repeats the same request.
bool Link::is_free_without_readings() const {
  const uint8_t due = due_ & ~kDueText;
  if ((due & ~kDueReply) != 0) return false;
  return bytes_left_ + (due != 0 ? reply_bytes_ : 0) <= lag_bytes_;
}

void Link::catch_up() {
  const bool is_waiting = (due_ & ~kDueText) != 0 || has_late_value_;
  const uint8_t max_lag = static_cast<uint8_t>(bytes_left_ + kPortBytes);
  if (!is_waiting && max_lag < lag_bytes_) lag_bytes_ = max_lag;
}

// The bytes in the port are sent in the next milliseconds.
void Link::pass_readings(uint16_t passed_ms) {
  if (bytes_left_ != 0 || due_ != 0 || has_late_value_) return;
  lag_bytes_ = lag_bytes_ > passed_ms ? static_cast<uint8_t>(lag_bytes_ - passed_ms) : 0;
}

// Whether a value that would have room waits for a reading. No other message waits now.
bool Link::keep_value(int32_t value, bool is_yes_no) {
  catch_up();
  if (lag_bytes_ == 0) return false;
  late_value_ = {value, is_yes_no, port_status().run, port_shown_at()};
  late_value_epoch_ = epoch_;
  has_late_value_ = true;
  return true;
}

void Link::send_late_value() {
  has_late_value_ = false;
  begin_event(Message::kShow);
  out_[kEpochAt] = late_value_epoch_;
  put_all(&late_value_, sizeof late_value_);
  close();
}

void Link::send_reading() {
  if (sends_separator()) return;
  const ReadingReport reading = port_next_reading();
  begin_event(Message::kReading);
  put_all(&reading, sizeof reading);
  close();
  lag_bytes_ = static_cast<uint8_t>(lag_bytes_ + bytes_left_);
}

}  // namespace tiniscript

#endif
