// The start button, without its chatter.

#ifndef TINISCRIPT_BOARDS_BUTTON_H_
#define TINISCRIPT_BOARDS_BUTTON_H_

#include <stdint.h>

namespace tiniscript {

enum class Press : uint8_t {
  kNothing,
  kPressed,   // it goes down: at once, so that a stop is not late
  kReleased,  // it goes up after it was really down, and not for a spike on its wire
};

// What has happened since the last question. One that is down after a reset has to go up first.
Press button_read(bool is_down, uint32_t now_ms);

}  // namespace tiniscript

#endif  // TINISCRIPT_BOARDS_BUTTON_H_
