// What the link may ask of the robot.
//
// Plain functions: each build links one definition of them (a board, a test). None of them waits.

#ifndef TINISCRIPT_LINK_PORT_H_
#define TINISCRIPT_LINK_PORT_H_

#include <stdint.h>

#include "messages.h"

namespace tiniscript {

// What is sent as it lies in memory: little-endian, one field right behind the other.
#define tini_packed __attribute__((packed))

// Who the robot is. `features` are bits that mean nothing yet; `nonce` is another one after each
// reset.
struct tini_packed Card {
  uint16_t kit;
  uint32_t id;
  uint32_t nonce;
  uint16_t features;
  Reset reset;
};

// What the robot does and holds.
struct tini_packed Condition {
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

// What the UART has noticed: bytes without a stop bit, and how often bytes were lost because nobody
// fetched them. They begin again at 0; where there is no UART, they stay 0.
struct LineErrors {
  uint8_t framing;
  uint8_t overrun;
};

// What the motors get for the power that a program asks for: `kExchanged` and the others of
// `wheels`; the percent by which the left wheel is too strong, or the right one where it is less
// than 0; the percent that move a wheel.
struct tini_packed Trim {
  uint8_t wheels;
  int8_t balance;
  uint8_t least;
};

constexpr uint8_t kFaultBytes = 7;  // of a Condition, from `fault` on

// How many devices the kit has, and what the robot is called.
struct Equipment {
  uint8_t sensors;
  uint8_t actuators;
  uint8_t name_length;
  uint8_t name[kNameBytes];
};

const Equipment& port_equipment();
const Card& port_card();
const Condition& port_condition();
const Trim& port_trim();
LineErrors port_line_errors();

// The most bytes of code for which there is room.
uint16_t port_room();

// Ends the running program, and has the one in memory saved if it shall be. kBusy where that is not
// finished: the link says so, and is asked again. kLowSupply: nothing goes on before there is
// enough voltage. What is_live comes beside the program in memory.
Answer port_make_way(bool is_live);

// Where an image with so many bytes of code goes, kEndBytes behind it included; nullptr where it
// has no room. Nothing there is lost before port_make_way has been asked.
uint8_t* port_memory(uint16_t code_length, bool is_live);

// The image in memory is overwritten from here on, piece by piece: the robot holds the stored one.
void port_forget();

// The image in memory is verified and whole but for its checksum. `mode` says whether it is saved.
void port_take(uint8_t mode, bool is_live);

// The image that was taken has its checksum.
void port_seal(const uint8_t* image);

// Starts what was taken last, or the program that the robot holds.
void port_start(bool is_live);

// Motors off; what runs ends, and nothing starts until port_release. A fault that is not 0 is
// recorded.
void port_stop(uint8_t fault);
void port_release();

// Puts a byte of the image that the robot holds into `*byte`. kBusy or kLowSupply where it is not
// to be had now: the link says so, and is asked again.
Answer port_image_byte(uint16_t offset, uint8_t* byte);

// Sets the name, and has it kept. kOk where it is kept; kSaving and kLowSupply where it is set, and
// will be; kNotKept where the memory is worn out, kBusy where nothing is done. The link says so,
// and is asked again.
Answer port_rename(const uint8_t* name, uint8_t length);

// The same with a trim; and kBadValue.
Answer port_set_trim(const Trim& trim);

}  // namespace tiniscript

#endif  // TINISCRIPT_LINK_PORT_H_
