// The robot's firmware: connects button, link, store and program.
//
// Knows no pins. Time comes in as `now_ms`; no function here blocks. There is only one robot, so
// these are plain functions. Parts: `program` holds the images in memory, `run` runs one,
// `persistence` saves, `identity` is id, name, `trim` and `pace`, `port` answers the link, with
// `owners`; `state` is what they share. `guide` controls a move by distance, `breakpoints` and
// `statements` halt a run, `button_hold` and `identify` handle a long press and how the robot
// identifies itself.

#pragma once

#include <stdint.h>

#include "../link/receiver.h"
#include "../link/transports.h"
#include "board.h"

namespace tiniscript {

// Call it once, after the board has begun. No motor turns until the button or the link starts it.
void firmware_begin(const BootInfo& boot_info);

// Passes the time; call it at least once a millisecond.
void firmware_on_time(uint32_t now_ms);

// Does a little of everything that is due; call it continuously.
void firmware_turn();

// Whether `firmware_turn` would start a LIVE now, so that other work may wait for a turn.
bool firmware_has_due_live();

// Calls both.
void firmware_tick(uint32_t now_ms);

// The button goes down: stops the run. The button goes up: starts the waiting program, if no
// program has run or was stopped since it went down.
void firmware_on_pressed();
void firmware_on_released();

// The button has been down for a while: also stops a program started since its first edge.
void firmware_on_down();

// The radio module reports that the client has disconnected: ends an attached run.
void firmware_on_disconnect();

// Whether a program runs, in which image and where. It has no side effects, so it may be called
// from an interrupt, and after a reset before memory is set up.
bool firmware_runs(Place* place);

// On a robot with several transports, the main loop calls all of these.
void firmware_on_rx_byte(Transport transport, uint8_t byte, uint16_t now_ms);
bool firmware_next_tx_byte(Transport transport, uint8_t* byte);

// Whether the next byte finds room, if it is text; otherwise it may wait elsewhere.
bool firmware_has_room(Transport transport);

// Whether a stop waits after text that waits elsewhere: it ends the current run, and this transport
// starts nothing before it is handled. Call it after bytes have been taken.
void firmware_await_stop(Transport transport, bool is_there);

// The robot's name on a radio: its own name, or otherwise, and as a host in a network, the end of
// its id; at a broker its whole id, in hexadecimal. All end with a 0.
struct RadioName {
  char name[kNameBytes + 1];
  char host[sizeof "tini-0000"];
  char id[sizeof "00000000"];
};

// False: the robot does not know yet.
bool firmware_radio_name(RadioName* name);

// Whether WiFi is off after restarts: HELLO reports this.
void firmware_wifi_rests(bool is_resting);

// Whether the client of a transport has authenticated with a key of the robot.
bool firmware_has_key(Transport transport);

// A transport has no client any more: this ends an attached run that the client started.
void firmware_on_client_left(Transport transport);

// For a robot with one line: a byte has arrived; one with a framing error is 0. May be called from
// the interrupt: a run of zeros turns the motors off at once.
void firmware_on_rx_byte(uint8_t byte, uint16_t now_ms);

// The same for a board that has looked for a stop in a byte of 0 itself, as `Receiver::count_zeros` does.
void firmware_take_rx_byte(uint8_t byte, uint16_t now_ms);

// Whether there is a byte to send; the next one, or false if there is none. May be called from an
// interrupt.
bool firmware_has_tx_byte();
bool firmware_next_tx_byte(uint8_t* byte);

}  // namespace tiniscript
