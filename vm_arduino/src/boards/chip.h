// The headers of the chip's family: its clock, pins and watchdog, and what it pays attention to.
//
// Each family has its own folder, with the same names in it.

#ifndef TINISCRIPT_BOARDS_CHIP_H_
#define TINISCRIPT_BOARDS_CHIP_H_

#include "avr/attention.h"
#include "avr/clock.h"
#include "avr/pins.h"
#include "avr/watchdog.h"

#endif  // TINISCRIPT_BOARDS_CHIP_H_
