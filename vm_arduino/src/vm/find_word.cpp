#ifndef __AVR__

#include "find_word.h"

#include "cpu.h"

namespace tiniscript {

uint8_t find_word(const uint8_t* table, const uint8_t* word, uint8_t length) {
  uint8_t number = 0;
  while (flash_byte(table) != 0) {
    bool is_same = true;
    uint8_t index = 0;
    uint8_t letter;
    do {
      letter = flash_byte(table++);
      if (is_same) {
        const uint8_t word_letter = word[index++];
        is_same = letter == (index == length ? word_letter | kLastLetter : word_letter);
      }
    } while ((letter & kLastLetter) == 0);
    if (is_same) break;
    number++;
  }
  return number;
}

}  // namespace tiniscript

#endif  // __AVR__
