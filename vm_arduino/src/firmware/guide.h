// Controls a move by the discs of both wheels: the given distance, and straight.
//
// Every 10 ms it compares how far the wheels have gone, gives more power to the slower one, and
// slows down towards the end. With both motors off, it waits until the wheels stop, and corrects
// the distance that they rolled too far. It counts how far they roll after other code has taken the
// motors, and continues from there. Edges of a wheel that cannot turn are noise. It knows pins and
// time only through `board.h` and the firmware's clock.

#pragma once

#include <stdint.h>

#include "../robot.h"
#include "../vm/build.h"

namespace tiniscript {

void guide_begin();  // a program begins
void guide_go(int8_t left, int8_t right, int32_t distance);
void guide_go_on();  // with that way, after something has ended it
MoveState guide_move_state(int32_t* remaining);
void guide_end(bool is_driven);  // it sets no motor any more; `is_driven`: other code does
void guide_tick();               // as often as may be
uint16_t guide_noise();          // of both wheels, the left one in the low byte

}  // namespace tiniscript
