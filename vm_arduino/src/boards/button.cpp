#include "button.h"

namespace tiniscript {

namespace {

constexpr uint8_t kBounceMs = 30;  // for so long a contact may chatter

enum class State : uint8_t {
  kUnknown,  // after a reset
  kRising,   // has gone up; may chatter
  kUp,
  kFalling,  // has gone down; may chatter, or be a spike
  kDown,
};

State state = State::kUnknown;
uint32_t changed_ms;

}  // namespace

Press button_read(bool is_down, uint32_t now_ms) {
  const bool is_settled = now_ms - changed_ms >= kBounceMs;
  switch (state) {
    case State::kUnknown:
      if (is_settled && !is_down) state = State::kUp;
      break;
    case State::kRising:
      if (is_settled) state = State::kUp;
      break;
    case State::kUp:
      if (!is_down) break;
      state = State::kFalling;
      changed_ms = now_ms;
      return Press::kPressed;
    case State::kFalling:
      if (is_settled) state = is_down ? State::kDown : State::kUp;
      break;
    case State::kDown:
      if (is_down) break;
      state = State::kRising;
      changed_ms = now_ms;
      return Press::kReleased;
  }
  return Press::kNothing;
}

}  // namespace tiniscript
