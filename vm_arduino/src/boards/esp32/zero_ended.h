// Texts that end with a 0, without a library.

#pragma once

#include <stddef.h>
#include <stdint.h>

namespace tiniscript {

inline size_t length_of(const char* text) {
  size_t length = 0;
  while (text[length] != 0) length++;
  return length;
}

inline bool is_same(const char* first, const char* second) {
  while (*first != 0 && *first == *second) {
    first++;
    second++;
  }
  return *first == *second;
}

// Appends to a text that has `max_length` bytes at most, if all of it finds room and has no 0 in
// it.
inline bool append(char* to, size_t max_length, const uint8_t* text, uint8_t length) {
  const size_t old_length = length_of(to);
  if (length > max_length - old_length) return false;
  for (uint8_t k = 0; k < length; k++) {
    if (text[k] == 0) return false;
  }
  __builtin_memcpy(to + old_length, text, length);
  return true;
}

}  // namespace tiniscript
