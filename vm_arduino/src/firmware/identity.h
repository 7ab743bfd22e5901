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

// Creates an id if none is saved.
void make_identity();

// Reads from and writes to a record of kRecordBytes, without its check.
void read_identity(const uint8_t* record);
void write_identity(uint8_t* record);

// The pace shares a record with the last fault.
void read_pace(const uint8_t* record);

// Each returns whether it changes anything. The arguments must be valid.
bool change_name(const uint8_t* name, uint8_t length);
bool change_tuning(const Tuning& new_tuning, bool has_pace);

}  // namespace tiniscript
