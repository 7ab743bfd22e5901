// The data that the robot saves: read after a reset, written when allowed.
//
// Knows the order of program, fault and identity, and that a commit needs motors off and enough
// voltage. The store knows how bytes are written.

#pragma once

#include <stdint.h>

#include "../link/port.h"

namespace tiniscript {

// Continues reading or saving: at most one byte.
void tick_persistence();

// Whether all records have been read since the reset. Until then, none may be changed.
bool has_booted();

// Has it saved as soon as the store is free. The program must not change until then.
void keep_program();
void keep_fault();
void keep_identity();

// Whether the identity is saved, and the pace, which is stored with the fault. kOk: yes; kSaving
// and kLowSupply: not yet; kNotKept: the memory is worn out, and it is tried again.
Answer identity_save_answer();

// Copies a key of the robot into `key`: zeros if it has none. False: not available now.
bool fetch_key(uint8_t kind, uint8_t* key);

// kSaving or kLowSupply while a key is being saved.
Answer owner_save_answer();

// Learns from the store whether the robot has an owner (`owners.cpp`).
void read_owner();

// Begins to take all keys away. False: not now.
bool forget_keys();

// Makes way for another program in memory: kBusy while the current one is being saved. A save that
// waits for more voltage is given up.
Answer give_up_program();

// The reason why something is not available now.
Answer busy_answer();

}  // namespace tiniscript
