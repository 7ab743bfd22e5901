// A turn of an AVR whose turns are in C++: its inner loop leaves at each jump back, where a loop may
// wait, and at each call.

#include "build.h"

#if defined(tiniscript_in_assembly) && defined(tiniscript_drives_in_turns)

#include "flags.h"
#include "machine.h"

namespace tiniscript {

bool Machine::run_turn() {
  uint8_t budget = budget_left_;
  bool is_cut_short = false;
  for (;;) {
    execute(1);
    if (budget_left_ != 0 || fault_ != Fault::kNone || status_ == Status::kDone) break;
    budget--;
    if (code_[offset_] < static_cast<uint8_t>(Op::kCall) && !go_back()) break;
    is_cut_short = budget == 0 || Flag<Bit::kEvent>();
    if (is_cut_short) break;
  }
  budget_left_ = budget;
  return is_cut_short;
}

}  // namespace tiniscript

#endif
