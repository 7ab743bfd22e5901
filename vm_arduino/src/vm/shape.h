// What the table of instructions says of an opcode: its stack, its size, its operands, its role.
//
// Knows how the rows of `bytecode.h` are packed, and where they lie. Verifier and machine read
// them here.

#ifndef TINISCRIPT_VM_SHAPE_H_
#define TINISCRIPT_VM_SHAPE_H_

#include <stdint.h>

#include "bytecode.h"

namespace tiniscript {

// A row of kOpRows; null: this is no opcode.
struct Shape {
  const uint8_t* row;

  uint8_t pushes() const { return (flash_byte(row) & 4) != 0; }
  uint8_t pops() const { return flash_byte(row) & 3; }
  Role role() const { return static_cast<Role>(flash_byte(row) >> 3); }
  uint8_t size() const { return flash_byte(row + 1) & 0x7f; }
  uint8_t operands() const { return flash_byte(row + 2); }  // 4 bits for each of the first two
  bool has_third() const { return (flash_byte(row + 1) & 0x80) != 0; }
};

Shape shape_of(uint8_t code);

}  // namespace tiniscript

#endif  // TINISCRIPT_VM_SHAPE_H_
