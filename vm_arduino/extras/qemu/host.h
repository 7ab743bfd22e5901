// What an emulator lends to the program on its chip: two pipes, through calls of its own.
//
// `xtensa.S` and `riscv.S` define these, beside what happens before `serve` and at a fault.

#pragma once

#include <stdint.h>

extern "C" {

// Each returns how many bytes went through: 0 where the other side has closed the pipe.
uint32_t host_read(uint8_t* data, uint32_t length);
uint32_t host_write(const uint8_t* data, uint32_t length);

// The program: answers requests until there are no more.
void serve();
}
