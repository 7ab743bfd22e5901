// The robot's identity: its id, name, motor trim and kit.
//
// Knows the layout in a record, not when it is saved. `identity.cpp` also implements
// `port_identity`, `port_device_info` and `port_tuning`.

#pragma once

#include <stdint.h>

#include "board.h"

namespace tiniscript {

// Takes over the board's data.
void begin_identity(const BootInfo& boot_info);

// Makes an id if none is saved.
void make_identity();

// Reads from and writes to a record of kRecordBytes, without its check.
void read_identity(const uint8_t* record);
void write_identity(uint8_t* record);

// The pace has its place in a record beside the last fault.
void read_pace(const uint8_t* record);

// Each returns whether it changes anything. What is given must be sound.
bool change_name(const uint8_t* name, uint8_t length);
bool change_tuning(const Tuning& wanted, bool has_pace);

}  // namespace tiniscript
