// What a fuzzer has made, byte by byte; 0 after its end.

#pragma once

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

class Input {
 public:
  Input(const uint8_t* data, size_t size) : data_(data), size_(size), at_(0) {}

  bool has_more() const { return at_ < size_; }
  size_t left() const { return size_ - at_; }
  uint8_t u8() { return at_ < size_ ? data_[at_++] : 0; }
  uint16_t u16() {
    const uint8_t low = u8();
    return static_cast<uint16_t>(low | u8() << 8);
  }

 private:
  const uint8_t* data_;
  size_t size_;
  size_t at_;
};

// Ends the run with what must not be: the fuzzer keeps its input.
#define must(what)                 \
  do {                             \
    if (!(what)) {                 \
      printf("WRONG %s\n", #what); \
      fflush(stdout);              \
      abort();                     \
    }                              \
  } while (false)

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size);
