// The verifier: what a machine must refuse, and the number of each reason.
//
// One pass over the code from its first byte to its last, with bounded memory: what is open is a
// few words, and a jump is right when it leads where the structure around it ends or begins.
// Accepted code cannot leave the stack, the variables, the kit or the code while it runs.
// `bytecode_spec.md` has the steps in words, `verify.py` in Python: same names, same order, same
// verdict at the same offset. Change all three.

#pragma once

#include <stddef.h>
#include <stdint.h>

#include "bytecode.h"

namespace tiniscript {

// For refused code: the first rule that it violates, and the offset of the instruction there. For
// accepted code: kNone, and bits of `needs` below the minor version that its instructions came
// with.
struct Verdict {
  Rule rule;
  uint16_t offset_or_needs;

  bool is_accepted() const { return rule == Rule::kNone; }
  uint16_t offset() const { return offset_or_needs; }
  uint8_t needs() const { return static_cast<uint8_t>(offset_or_needs); }
  uint8_t minor() const {  // of its image: the lowest that has what it has and needs
    const uint8_t op_minor = static_cast<uint8_t>(kOpsHaveMinors ? offset_or_needs >> 8 : 0);
    return minor_of_needs(needs()) > op_minor ? minor_of_needs(needs()) : op_minor;
  }
};

// Whether a machine with this many sensors and actuators (0 to 255) may run `code`. Its image says
// what it may have. Puts the hash of the used devices into `*devices`, which is undefined
// if the code is refused.
Verdict verify(const uint8_t* code, size_t length, uint8_t sensors, uint8_t actuators,
               uint16_t* devices, uint8_t needs);

inline Verdict verify(const uint8_t* code, size_t length, uint8_t sensors, uint8_t actuators,
                      uint8_t needs = 0) {
  uint16_t devices;
  return verify(code, length, sensors, actuators, &devices, needs);
}

}  // namespace tiniscript
