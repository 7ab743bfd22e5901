// An EEPROM, byte by byte, whose plug can be pulled while a byte is written.
//
// Defines what `../src/store/nvm.h` declares. A byte that was cut may be unstable: each time it is
// read it says what it said before or what was written, at random, until it is written again.
// Ends the program where the store asks for something while the memory writes.

#pragma once

#include <stdint.h>

#include "../../src/store/layout.h"

namespace tiniscript {

// What becomes of the byte that is written when the plug is pulled.
enum class TornByte : uint8_t {
  kNotStarted,
  kDone,
  kAllOnes,
  kAllZeros,
  kRandom,
  kBoth,  // old and new: only the bits that both have
  kUnstable,
};
constexpr uint8_t kTornBytes = 7;

struct Memory {
  struct Cell {
    uint8_t value;
    uint8_t other_value;  // not the same: unstable
  };

  Cell cells[kMemoryBytes];
  bool is_writing;
  bool is_cut_next;  // the plug is pulled at the next write
  TornByte torn_byte;
  bool is_off;  // since then nothing is written
  uint16_t cut_place;
  uint16_t dead_place = kMemoryBytes;  // a byte that keeps what it is
  uint32_t writes;

  void fill(uint8_t value);
};

// The one memory of this program; whoever wants to try several things copies it.
extern Memory memory;

// Erases of each byte since somebody put them to 0.
extern uint16_t erases[kMemoryBytes];

}  // namespace tiniscript
