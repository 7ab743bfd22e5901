// Who the robot is: its id, its name, the trim of its motors, and what it is built for.
//
// Knows how that lies in a record; not when it is kept. `identity.cpp` also answers `port_card`,
// `port_equipment` and `port_trim`.

#ifndef TINISCRIPT_FIRMWARE_IDENTITY_H_
#define TINISCRIPT_FIRMWARE_IDENTITY_H_

#include <stdint.h>

#include "../link/port.h"

namespace tiniscript {

// Takes over what the board has told.
void begin_identity();

// A robot that has kept none gets an id.
void make_identity();

// From a record of kRecordBytes and into one; its check is not looked at, nor written.
void read_identity(const uint8_t* record);
void write_identity(uint8_t* record);

// Each says whether that changes anything. The trim is sound.
bool change_name(const uint8_t* name, uint8_t length);
bool change_trim(const Trim& trim);

}  // namespace tiniscript

#endif  // TINISCRIPT_FIRMWARE_IDENTITY_H_
