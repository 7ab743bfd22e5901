// The images in memory: the program that the robot holds, and the one that runs once beside it.
//
// Brings the stored program into memory, and says which one the robot holds. Knows nothing of runs.

#ifndef TINISCRIPT_FIRMWARE_PROGRAM_H_
#define TINISCRIPT_FIRMWARE_PROGRAM_H_

#include <stdint.h>

#include "../link/messages.h"
#include "../store/layout.h"
#include "../vm/vm.h"

namespace tiniscript {

constexpr uint8_t kLiveCodeBytes = kPayloadBytes - kLiveCodeAt;

extern uint8_t program[kHeaderBytes + kStoredCodeBytes + kEndBytes];
extern uint8_t live[kHeaderBytes + kLiveCodeBytes + kEndBytes];

// Whether `program` is the one that `condition` names.
bool is_in_memory();

// The robot holds the stored program, if there is one; it may have to be loaded.
void hold_stored();

// The robot holds the image in memory, which is verified. It is stored nowhere.
void hold_memory();

// Brings the program that the robot holds into memory, if there is one. False: it is not to be had
// now.
bool load_program();

}  // namespace tiniscript

#endif  // TINISCRIPT_FIRMWARE_PROGRAM_H_
