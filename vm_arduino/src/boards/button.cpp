#include "button.h"

#include "../vm/small.h"

namespace tiniscript {

namespace {

constexpr uint8_t kDebounceMs = 30;  // bouncing and spikes are shorter, or not steady

enum class State : uint8_t {
  kUnknown,  // after a reset
  kUp,
  kEdge,  // just went down: bouncing or a spike
  kDown,
};

struct Button {
  State state;
  bool was_down;
  uint8_t steady_ms;  // how long it has been steady, in milliseconds that were sampled
  uint8_t last_ms;
};

Button button;

}  // namespace

bool button_has_moved(bool is_down) { return is_down != button.was_down; }

Press button_read(bool is_down, uint32_t now_ms) {
  Button* const near_button = near(&button);
  const uint8_t now_low_ms = static_cast<uint8_t>(now_ms);
  if (is_down != near_button->was_down) {
    near_button->was_down = is_down;
    near_button->steady_ms = 0;
  } else if (now_low_ms != near_button->last_ms && near_button->steady_ms < kDebounceMs) {
    near_button->steady_ms++;
  }
  near_button->last_ms = now_low_ms;
  if (near_button->state == State::kUp && is_down) {
    near_button->state = State::kEdge;
    return Press::kPressed;
  }
  if (near_button->steady_ms < kDebounceMs || (is_down && near_button->state == State::kDown))
    return Press::kNothing;
  const State previous_state = near_button->state;
  near_button->state = is_down ? State::kDown : State::kUp;
  if (is_down) return Press::kDown;
  return previous_state == State::kDown ? Press::kReleased : Press::kNothing;
}

}  // namespace tiniscript
