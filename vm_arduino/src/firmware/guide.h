// Goes a way by what the discs of both wheels say: as far as was said, and straight.
//
// Every 10 ms it compares how far the wheels have gone, gives more power to the one behind, and
// goes slower towards the end. Both wheels off, it waits until they stand, and corrects what they
// rolled too far. It counts what they roll on after something has taken the motors, and goes on
// from there. What a wheel shows that cannot turn is noise. Knows neither pins nor time but through
// `board.h` and the firmware's clock.

#pragma once

#include <stdint.h>

#include "../robot.h"
#include "../vm/build.h"

namespace tiniscript {

void guide_begin();  // a program begins
void guide_go(int8_t left, int8_t right, int32_t way);
void guide_go_on();  // with that way, after something has ended it
Going guide_going(int32_t* rest);
void guide_end(bool is_driven);  // it sets no motor any more; `is_driven`: something else does
void guide_tick();               // as often as may be
uint16_t guide_noise();          // of both wheels, the left one in the low byte

}  // namespace tiniscript
