// Finds a word in a table of words in flash: one after the other, 0x80 in the last letter of each, and
// a 0 after them.

#pragma once

#include <stdint.h>

namespace tiniscript {

constexpr uint8_t kLastLetter = 0x80;

// Returns the number of a word of at least one letter, or that of the table's end. Whether its last
// letter is marked, too, makes no difference.
uint8_t find_word(const uint8_t* table, const uint8_t* word, uint8_t length);

}  // namespace tiniscript
