// The form of an opcode from the tables: its stack, its size, its operands, its role.
//
// Knows how the rows of `bytecode.h` are packed, and where they lie.

#pragma once

#include <stdint.h>

#include "bytecode.h"

namespace tiniscript {

// An invalid opcode has a form too: one byte, no operands or values, role kNone.
struct DecodeForm {
  uint8_t effects;
  uint8_t bytes;
  uint8_t kinds;  // of the operands: each a Byte of 4 bits, the first one below
  Family family;

  uint8_t pops() const { return static_cast<uint8_t>(effects / 64); }
  uint8_t pushes() const { return (effects & 0x20) != 0; }
  ControlRole role() const { return static_cast<ControlRole>(effects & 0x1f); }
  uint8_t size() const { return bytes & 7; }
  bool is_far() const { return (bytes & kFar) != 0; }
  bool jumps_back() const { return (bytes & kBack) != 0; }
};

DecodeForm decode_form_of(uint8_t code);

}  // namespace tiniscript
