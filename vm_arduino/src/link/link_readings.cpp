// What programs read, told to a session that wants it, and values that a program shows meanwhile.
//
// A reading delays no program. While it is being sent, a SHOW finds room where it would without: its value
// waits here instead. `behind_` is by how many bytes the line is behind one without readings: what is
// left of a reading, as it was when something else began to wait for it.

#include "../vm/build.h"
#include "link.h"
#include "port.h"

#ifdef tiniscript_tells_readings

namespace tiniscript {

void Link::tell_readings(bool is_on) {
  tells_readings_ = is_on;
  port_tell_readings(is_on);
}

void Link::catch_up() {
  const bool waits = (due_ & ~kDueText) != 0 || has_late_value_;
  if (!waits && left_ < behind_) behind_ = left_;
}

// Whether a value that would have room waits for a reading. Nothing else waits now.
bool Link::keep_value(int32_t value, bool is_yes_no) {
  catch_up();
  if (behind_ == 0) return false;
  late_value_ = {value, is_yes_no, port_status().run, port_shown_at()};
  late_epoch_ = epoch_;
  has_late_value_ = true;
  return true;
}

void Link::send_late_value() {
  has_late_value_ = false;
  begin_event(Message::kShow);
  out_[kEpochAt] = late_epoch_;
  put_all(&late_value_, sizeof late_value_);
  close();
}

void Link::send_reading() {
  if (separate()) return;
  const ToldReading reading = port_next_reading();
  begin_event(Message::kReading);
  put_all(&reading, sizeof reading);
  close();
  behind_ = left_;
}

}  // namespace tiniscript

#endif
