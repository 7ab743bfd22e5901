// What the parts of the firmware share. `firmware.cpp` holds it.

#ifndef TINISCRIPT_FIRMWARE_STATE_H_
#define TINISCRIPT_FIRMWARE_STATE_H_

#include <stdint.h>

#include "../link/link.h"
#include "../store/store.h"
#include "board.h"

namespace tiniscript {

extern Board board;          // as it was told at the beginning
extern Condition condition;  // what the robot does and holds, and its last fault
extern uint32_t now_ms;      // of this tick
extern Link link;
extern Store store;

inline bool is_running() { return condition.state == State::kRunning; }

// Tells the board whether a press of the button would start something.
void show_light();

}  // namespace tiniscript

#endif  // TINISCRIPT_FIRMWARE_STATE_H_
