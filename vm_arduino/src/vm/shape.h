// What the tables say of an opcode: its stack, its size, its operands, its role.
//
// Knows how the rows of `bytecode.h` are packed, and where they lie.

#ifndef TINISCRIPT_VM_SHAPE_H_
#define TINISCRIPT_VM_SHAPE_H_

#include <stdint.h>

#include "bytecode.h"

namespace tiniscript {

// What is no opcode has a shape too: one byte, without operands or values, of the role kNone.
struct Shape {
  uint8_t effects;
  uint8_t bytes;

  uint8_t pops() const { return static_cast<uint8_t>(effects / 64); }
  uint8_t pushes() const { return (effects & 0x20) != 0; }
  Role role() const { return static_cast<Role>(effects & 0x1f); }
  uint8_t size() const { return bytes & 7; }
  // what the first byte is in 3 bits, the second in 2
  uint8_t operands() const { return static_cast<uint8_t>(bytes / 8); }
  bool jumps_back() const { return (bytes & 0x38) == static_cast<uint8_t>(Byte::kBack) << 3; }
};

Shape shape_of(uint8_t code);

}  // namespace tiniscript

#endif  // TINISCRIPT_VM_SHAPE_H_
