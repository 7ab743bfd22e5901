// What the link may ask of the robot.
//
// Plain functions: each build links one definition of them (a board, a test). None of them waits.

#ifndef TINISCRIPT_LINK_PORT_H_
#define TINISCRIPT_LINK_PORT_H_

#include <stdint.h>

#include "messages.h"

namespace tiniscript {

// Who the robot is. It stays the same, but for the name.
struct Card {
  uint32_t id;
  uint8_t nonce[8];  // another one after each reset
  uint16_t features;
  uint16_t kit;
  uint8_t sensors;
  uint8_t actuators;
  Reset reset;
  uint8_t name_length;
  uint8_t name[kNameBytes];
};

// What the robot does and holds.
struct Condition {
  State state;
  uint8_t run;       // counts the programs that were started
  uint32_t program;  // checksum of the image that START starts
  uint16_t length;   // of its code
  uint8_t slot;      // where it is saved
  Saved saved;
  // the last fault, or 0, where it was and in which image
  uint8_t fault;
  uint16_t fault_at;
  uint32_t fault_program;
};

const Card& port_card();
const Condition& port_condition();

// The most bytes of code for which there is room.
uint16_t port_room();

// Ends the running program, and has the one in memory saved if it shall be. False where that is not
// finished: the link says so, and is asked again. What is_live comes beside the program in memory.
bool port_make_way(bool is_live);

// Where an image with so many bytes of code goes, kEndBytes behind it included; nullptr where it
// has no room. Nothing there is lost before port_make_way has been asked.
uint8_t* port_memory(uint16_t code_length, bool is_live);

// The image in memory is whole and verified. `mode` says whether it is saved.
void port_take(uint8_t mode, bool is_live);

// Starts what was taken last, or the program that the robot holds.
void port_start(bool is_live);

// Motors off; what runs ends, and nothing starts until port_release. A fault that is not 0 is
// recorded.
void port_stop(uint8_t fault);
void port_release();

// A byte of the image that the robot holds.
uint8_t port_image_byte(uint16_t offset);

// False while the robot has no time to save it: the link says so, and is asked again.
bool port_rename(const uint8_t* name, uint8_t length);

}  // namespace tiniscript

#endif  // TINISCRIPT_LINK_PORT_H_
