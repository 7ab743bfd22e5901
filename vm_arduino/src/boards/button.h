// The start button with debounce.

#pragma once

#include <stdint.h>

namespace tiniscript {

// A stop must be early, a start may be late: the first edge of a press is reported at once, a
// release only after a debounced press and a debounced release. Each is reported once per press.
enum class Press : uint8_t {
  kNothing,
  kPressed,  // it goes down, or there is a spike on its wire
  kDown,     // it has been down for 30 ms: a press, not a spike; alone if it began before the reset
  kReleased,  // it has been up for 30 ms after kDown
};

// Whether the button has changed since the last call.
bool button_has_moved(bool is_down);

// The events since the last call. A button that is down after a reset is reported as down, not as
// pressed.
Press button_read(bool is_down, uint32_t now_ms);

}  // namespace tiniscript
