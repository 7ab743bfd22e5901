// The interface of a chip to the tests that run on it: reads a request, writes an answer.
//
// Each chip defines these in a folder beside this one. The requests are those of
// `tests/machines/host.py`.

#pragma once

#include <stddef.h>
#include <stdint.h>

namespace tiniscript {

// The byte of the request at this place; 0 after its end.
uint8_t request_byte(size_t place);

// Returns `length` bytes of the request from this place, in RAM and followed by `zeros`, or nullptr
// if the chip has no room for them. They are valid until the next call.
const uint8_t* request_bytes(size_t place, size_t length, size_t zeros);

// Adds a byte to the answer.
void put(char letter);

}  // namespace tiniscript
