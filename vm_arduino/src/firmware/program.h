// The images in memory: the program that the robot holds, and the other one that runs once.
//
// Loads the stored program into memory and knows which one the robot holds. It knows nothing of
// runs.

#pragma once

#include <stdint.h>

#include "../link/sizes.h"
#include "../link/text_level.h"
#include "../store/layout.h"
#include "../vm/machine.h"

namespace tiniscript {

// A program that is read as text: at most so many bytes of code, as its jumps are short. Its code
// and the reader's other data have this room.
constexpr uint8_t kTextCodeBytes = 255;
constexpr uint16_t kTextRoom = kRobotTextLevel == TextLevel::kMega    ? 1900
                               : kRobotTextLevel == TextLevel::kEsp32 ? 8192
                                                                      : kStoredCodeBytes;
static_assert(kTextRoom <= kStoredCodeBytes, "an Uno reads it where its program is");

constexpr uint16_t kLiveImageBytes =
    kHeaderBytes + (kTextIsInProgram ? kPayloadBytes - kLiveCodeAt : kTextCodeBytes);
extern uint8_t draft[kHeaderBytes + kTextRoom];  // unless text is in the program

extern uint8_t program[kImageBytes + kEndBytes];
extern uint8_t live[kLiveImageBytes + kEndBytes];

// Whether `program` is the one in `robot_status`.
bool is_in_memory();

// The length of the image in `robot_status`.
uint16_t held_bytes();

// The robot now holds the stored program, if there is one; it may have to be loaded. A program of
// another version does not count, and `robot_status` reports that.
void hold_stored();

// The robot now holds the verified image in memory, which is not stored.
void hold_memory();

// The robot now holds, in memory, the program before the one that it holds: where that is stored,
// the one in the other slot; where it is not, the stored one. False: there is none that it can run,
// and the program stays. The store must be ready.
bool hold_previous();

// Tells the board whether a press of the button would start a program.
void show_light();

// Whether there is no program to load.
bool has_program();

// Loads the program that the robot holds into memory, if there is one. False: it is not available
// now.
bool load_program();

}  // namespace tiniscript
