// The robot's firmware: connects button, link, store and program.
//
// Knows no pins. Time comes in as `now_ms`; nothing here blocks. There is only one robot, so these
// are plain functions. Parts: `program` holds the images in memory, `run` runs one, `persistence`
// saves, `identity` is id, name, `trim` and `pace`, `port` answers the link, with `owners`; `state` is
// what they share. `guide` goes a way, `breakpoints` and `statements` halt a run, `button_hold` and
// `identify` are what a long press means and how the robot shows which one it is.

#pragma once

#include <stdint.h>

#include "../link/receiver.h"
#include "../link/transports.h"
#include "board.h"

namespace tiniscript {

// Call it once, after the board has begun. Nothing moves until the button or the link starts it.
void firmware_begin(const BootInfo& boot_info);

// Passes the time; call it at least once a millisecond.
void firmware_on_time(uint32_t now_ms);

// Does a little of everything that is due; call it continuously.
void firmware_turn();

// Whether `firmware_turn` would start a LIVE now, so that other work may wait for a turn.
bool firmware_has_due_live();

// Calls both.
void firmware_tick(uint32_t now_ms);

// The button goes down: stops what runs. The button goes up: starts the waiting program, if
// nothing has run or was stopped since it went down.
void firmware_on_pressed();
void firmware_on_released();

// The button has been down for a while: also stops what was started since its first edge.
void firmware_on_down();

// The radio module reports that the client has disconnected: ends an attached run.
void firmware_on_disconnect();

// Whether a program runs, in which image and where. Changes nothing, so it may be called from an
// interrupt, and after a reset before memory is set up.
bool firmware_runs(Place* place);

// Where a robot is reached over several transports, all of these are called from the main loop.
void firmware_on_rx_byte(Transport transport, uint8_t byte, uint16_t now_ms);
bool firmware_next_tx_byte(Transport transport, uint8_t* byte);

// Whether the next byte finds room, if it is text; so it may wait elsewhere.
bool firmware_has_room(Transport transport);

// Whether a stop waits behind text that waits elsewhere: what runs ends, and nothing of this transport
// starts before that. Call it after bytes have been taken.
void firmware_await_stop(Transport transport, bool is_there);

// How the robot is called over a radio: by the name that it was given, or else, and as a host in a
// network, by the end of its id; at a broker by all of its id, in hexadecimal. All end with a 0.
struct RadioName {
  char name[kNameBytes + 1];
  char host[sizeof "tini-0000"];
  char id[sizeof "00000000"];
};

// False: the robot does not know yet.
bool firmware_radio_name(RadioName* name);

// Whether WiFi is off after restarts: HELLO says so.
void firmware_wifi_rests(bool is_so);

// Whether who is connected over a transport has shown a key of the robot.
bool firmware_has_key(Transport transport);

// Nobody is connected over a transport any more: ends an attached run that it has started.
void firmware_on_part(Transport transport);

// Where there is one line: a byte has arrived; one with a framing error is 0. May be called from the
// interrupt: a run of zeros turns the motors off at once.
void firmware_on_rx_byte(uint8_t byte, uint16_t now_ms);

// The same for a board that has looked for a stop in a byte of 0 itself, as `Receiver::count_zeros` does.
void firmware_take_rx_byte(uint8_t byte, uint16_t now_ms);

// Whether there is a byte to send; the next one, or false if there is none. May be called from an
// interrupt.
bool firmware_has_tx_byte();
bool firmware_next_tx_byte(uint8_t* byte);

}  // namespace tiniscript
