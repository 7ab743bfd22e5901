// An image: code, and a header by which a robot decides whether it may run it.
//
// Knows the header and the checksum; `verify` checks the code.

#pragma once

#include <stddef.h>
#include <stdint.h>

#include "bytecode.h"

namespace tiniscript {

// `code` points into the bytes of the image; `devices` is the hash of the devices that it uses.
struct Image {
  const uint8_t* code;
  uint16_t code_length;
  uint16_t devices;
  uint8_t start;
  uint8_t needs;  // bits: what the code may have that not every machine has
};

// After the checksum come the parts that it covers besides the ten bytes before it: `needs`, fields
// of later versions, and the code.
constexpr uint8_t kChecksumBytes = 4;
constexpr uint8_t kAfterChecksum = kChecksumAt + kChecksumBytes;

// The length of an image, from its header.
inline uint16_t image_length(const uint8_t* image) {
  const uint16_t code = static_cast<uint16_t>(image[kCodeLengthAt] | image[kCodeLengthAt + 1] << 8);
  return static_cast<uint16_t>(image[kHeaderLengthAt] + code);
}

// The checksum of any bytes followed by their own checksum.
constexpr uint32_t kCrcResidue = 0x2144df1c;

// The checksum of an image of `length` bytes, whatever its header says.
uint32_t image_checksum(const uint8_t* image, uint16_t length);

// Fills `*image` from `length` bytes. Code and devices are not verified yet; `*image` is undefined
// if it is refused.
Refusal unpack(const uint8_t* data, size_t length, Image* image);

// Whether the devices that the code uses are those of this robot: `devices` is their hash here,
// from `verify`.
Refusal check_devices(const Image& image, uint16_t devices);

// Whether a robot with this many sensors and actuators may run an image: 0, a Refusal, or the
// verifier's Rule with its `offset`. Its version and its lengths have been checked: whoever puts it
// into memory needs them first.
struct Admission {
  uint8_t refusal;
  uint16_t offset;
};

Admission admit(const uint8_t* data, uint8_t sensors, uint8_t actuators);

}  // namespace tiniscript
