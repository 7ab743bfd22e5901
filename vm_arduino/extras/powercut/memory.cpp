#include "memory.h"

#include <stdio.h>
#include <stdlib.h>

#include "../../src/store/nvm.h"
#include "contents.h"

namespace tiniscript {

Memory memory;
uint16_t erases[kMemoryBytes];

namespace {

void expect(bool condition, const char* message) {
  if (condition) return;
  printf("MISUSE %s\n", message);
  exit(3);
}

uint8_t read_cell(const Memory::Cell& cell) {
  return random_below(2) == 0 ? cell.value : cell.other_value;
}

// Any byte; often one that means something in the slot around it: nature is no friend.
uint8_t nasty_byte(uint16_t place) {
  if (random_below(2) == 0) return static_cast<uint8_t>(random_below(0x100));
  const uint32_t neighbor = (place + kMemoryBytes - 3U + random_below(7)) % kMemoryBytes;
  return memory.cells[neighbor].value ^ (random_below(2) == 0 ? 0 : 0xa5);
}

void write(uint16_t place, uint8_t value) {
  expect(place < kMemoryBytes, "a write past the end");
  expect(!memory.is_writing, "a write while another one goes on");
  if (memory.is_off) return;
  memory.is_writing = true;
  memory.writes++;
  if (place == memory.dead_place) return;
  Memory::Cell& cell = memory.cells[place];
  if (!memory.is_cut_next) {
    cell = {value, value};
    return;
  }
  memory.is_off = true;
  memory.cut_place = place;
  switch (memory.torn_byte) {
    case TornByte::kNotStarted:
      return;
    case TornByte::kDone:
      break;
    case TornByte::kAllOnes:
      value = 0xff;
      break;
    case TornByte::kAllZeros:
      value = 0;
      break;
    case TornByte::kRandom:
      value = nasty_byte(place);
      break;
    case TornByte::kBoth:
      value &= read_cell(cell);
      break;
    case TornByte::kUnstable:
      cell = {read_cell(cell), value};
      return;
  }
  cell = {value, value};
}

}  // namespace

void Memory::fill(uint8_t value) {
  for (Cell& cell : cells) cell = {value, value};
}

bool nvm_is_ready() { return !memory.is_writing; }

uint8_t nvm_read(uint16_t place) {
  expect(place < kMemoryBytes, "a read past the end");
  expect(!memory.is_writing, "a look while a write goes on");
  const Memory::Cell& cell = memory.cells[place];
  return cell.value == cell.other_value ? cell.value : read_cell(cell);
}

void nvm_write(uint16_t place, uint8_t value) {
  write(place, value);
  erases[place]++;
}

void nvm_clear(uint16_t place) { write(place, 0); }

}  // namespace tiniscript
