// The start button, debounced.

#ifndef TINISCRIPT_BOARDS_BUTTON_H_
#define TINISCRIPT_BOARDS_BUTTON_H_

#include <stdint.h>

namespace tiniscript {

// A stop is early and a start is late: the first edge of a press is told at once, and a release
// only when the button was surely down and is surely up. Each is told once for a press.
enum class Press : uint8_t {
  kNothing,
  kPressed,   // it goes down, or a spike on its wire looks so
  kHeld,      // it has been down for 30 ms: a press and no spike
  kReleased,  // it has been up for 30 ms after that
};

// What has happened since the last question. One that is down after a reset has to go up first.
Press button_read(bool is_down, uint32_t now_ms);

}  // namespace tiniscript

#endif  // TINISCRIPT_BOARDS_BUTTON_H_
