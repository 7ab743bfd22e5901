// The functions that the store needs of its non-volatile memory.
//
// Plain functions, as in `robot.h`: each build links one definition of them (the EEPROM of a board,
// a model in a test). A place is an address from 0. None of them blocks: a write continues on its
// own, and no other call is allowed until the memory is ready again.

#pragma once

#include <stdint.h>

#include "../vm/build.h"

namespace tiniscript {

// Whether a byte whose write was cut may read differently later, until it is written again.
constexpr bool kCutBytesAreUnstable = !kWritesStopTheChip;

// Whether the last write is finished: only then may a byte be read or written.
bool nvm_is_ready();

uint8_t nvm_read(uint16_t place);

// Whether the memory has refused no read: only then does "not found" mean missing.
bool nvm_has_refused();
inline bool nvm_is_readable() { return !kWritesStopTheChip || !nvm_has_refused(); }

// Begins to write a byte, even an equal one: the byte is erased first.
void nvm_write(uint16_t place, uint8_t value);

// Begins to set a byte to 0, without an erase if the memory can do that.
void nvm_clear(uint16_t place);

}  // namespace tiniscript
