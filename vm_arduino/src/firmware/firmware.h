// The robot's own program: what it does with its button, its link, its store and a program.
//
// Knows no pins. Time comes in as `now_ms`; nothing here waits. There is one robot, so these are
// plain functions. Its parts: `program` holds the images in memory, `run` runs one, `keeping` has
// it saved, `identity` is who the robot is, `port` answers the link, `state` is what they share.

#ifndef TINISCRIPT_FIRMWARE_FIRMWARE_H_
#define TINISCRIPT_FIRMWARE_FIRMWARE_H_

#include <stdint.h>

#include "board.h"

namespace tiniscript {

// To be called once, after the board has begun. Nothing moves before the button or the link says
// so.
void firmware_begin(const Board& board);

// Does a little of all that is due; to be called all the time.
void firmware_tick(uint32_t now_ms);

// The button goes down: what runs is stopped. It goes up again: what waits is started, where
// nothing has run and nothing was stopped since it went down.
void firmware_on_pressed();
void firmware_on_released();

// The button has been down for a while: what was started between its first edge and now is
// stopped, too.
void firmware_on_held();

// The radio module says that nobody is connected any more: that ends a tethered run.
void firmware_on_disconnect();

// Whether a program runs, in which image and where. May be called in an interrupt, and after a
// reset before memory is set up anew: it changes nothing.
bool firmware_runs(Place* place);

// A byte has arrived; a damaged one is 0. May be called from the interrupt: a run of zeros turns
// the motors off there and then.
void firmware_on_rx_byte(uint8_t byte, uint16_t now_ms);

// The next byte to send; false where there is none. May be called from an interrupt.
bool firmware_next_tx_byte(uint8_t* byte);

}  // namespace tiniscript

#endif  // TINISCRIPT_FIRMWARE_FIRMWARE_H_
