// Lines that hold keys of a remote control, in a conversation in text.

#include "../vm/build.h"
#include "console.h"
#include "port.h"

#ifdef tiniscript_reads_keys

namespace tiniscript {

// Whether the line that has ended holds keys. In a block it belongs to the program. It counts as
// silence; otherwise a person who holds a key would never be silent.
bool Console::take_keys() {
  if (is_waiting_ || !key_line_.read(&keys_) || !text_may_drive()) return false;
  is_open_ = false;
  left_ms_[kPatience] = line_patience_ms_;
  is_silent_ = line_patience_ms_ <= kPatienceMs - kSilenceMs;
  if (is_silent_) {
    is_ignoring_ = false;
    if (left_ms_[kWait] == 0) is_discarding_ = false;
  }
  return !is_discarding_;
}

void Console::note_keys(bool reads, bool is_heard) {
  if (!reads && !has_told_keys_) tell(Remark::kNoKeys, is_heard);
  has_told_keys_ = !reads;
  if (!is_heard) is_talking_ = true;
}

}  // namespace tiniscript

#endif
