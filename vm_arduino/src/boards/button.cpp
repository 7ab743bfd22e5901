#include "button.h"

namespace tiniscript {

namespace {

constexpr uint8_t kDebounceMs = 30;  // bouncing and spikes are shorter, or not steady

enum class State : uint8_t {
  kUnknown,  // after a reset
  kUp,
  kEdge,  // just went down: bouncing or a spike
  kDown,
};

State state = State::kUnknown;
bool was_down;
uint8_t steady_ms;  // how long it has been steady, in milliseconds that were sampled
uint8_t last_ms;

}  // namespace

bool button_has_moved(bool is_down) { return is_down != was_down; }

Press button_read(bool is_down, uint32_t now_ms) {
  const uint8_t time_ms = static_cast<uint8_t>(now_ms);
  if (is_down != was_down) {
    was_down = is_down;
    steady_ms = 0;
  } else if (time_ms != last_ms && steady_ms < kDebounceMs) {
    steady_ms++;
  }
  last_ms = time_ms;
  if (state == State::kUp && is_down) {
    state = State::kEdge;
    return Press::kPressed;
  }
  if (steady_ms < kDebounceMs || (is_down && state == State::kDown)) return Press::kNothing;
  const State before = state;
  state = is_down ? State::kDown : State::kUp;
  if (is_down) return Press::kHeld;
  return before == State::kDown ? Press::kReleased : Press::kNothing;
}

}  // namespace tiniscript
