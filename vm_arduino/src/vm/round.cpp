// The round of turns, where these are in C++.

#include "build.h"

#ifdef tiniscript_drives_in_turns

#include "machine.h"

namespace tiniscript {

void Machine::run_round() {
  for (bool is_over = false; finds_turn(is_over) && left_ != 0; is_over = true) {
    if (run_turn() || fault_ != Fault::kNone || status_ == Status::kDone) return;
    // before all others the main task waits for a reading, too
    if (!has_had_turn() && status_ == Status::kRunning) return;
  }
}

}  // namespace tiniscript

#endif
