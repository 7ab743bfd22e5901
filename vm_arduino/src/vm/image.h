// An image: code with the header that tells a robot whether it may run it.
//
// Knows the header and the checksum. Knows nothing of what the code does: `verify` does.

#ifndef TINISCRIPT_VM_IMAGE_H_
#define TINISCRIPT_VM_IMAGE_H_

#include <stddef.h>
#include <stdint.h>

#include "bytecode.h"

namespace tiniscript {

// `code` points into the bytes of the image; `kit` is a fingerprint, or 0.
struct Image {
  const uint8_t* code;
  uint16_t code_length;
  uint16_t kit;
  uint8_t start;
};

// Fills `*image` from `length` bytes, for a robot whose kit has the fingerprint `kit`. Its code is
// not verified yet, and `*image` means nothing where it is refused.
Refusal unpack(const uint8_t* data, size_t length, uint16_t kit, Image* image);

}  // namespace tiniscript

#endif  // TINISCRIPT_VM_IMAGE_H_
