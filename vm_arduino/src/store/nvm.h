// What the store may ask of the memory that keeps its bytes without power.
//
// Plain functions, as in `robot.h`: each build links one definition of them (the EEPROM of a board,
// a model in a test). A place is counted from 0. None of them waits; a write goes on by itself
// after it has begun, and nothing else may be asked until the memory is ready again.

#ifndef TINISCRIPT_STORE_NVM_H_
#define TINISCRIPT_STORE_NVM_H_

#include <stdint.h>

namespace tiniscript {

// Whether the last write is finished: a byte may be read, or a write may begin.
bool nvm_is_ready();

uint8_t nvm_read(uint16_t place);

// Begins to put a value into a byte, also where it is there already: the byte is erased first.
void nvm_write(uint16_t place, uint8_t value);

// Begins to make a byte 0, where the memory can do so without an erase.
void nvm_clear(uint16_t place);

}  // namespace tiniscript

#endif  // TINISCRIPT_STORE_NVM_H_
