// The rounds of SipHash on all chips but an AVR, which has them in `siphash_avr.S`.

#include "siphash.h"

#ifndef __AVR__

namespace tiniscript {

namespace {

// Rotates a word to the left.
void rotate(uint8_t* word, uint8_t bits) {
  while (bits-- != 0) {
    uint8_t carry = static_cast<uint8_t>(word[kWord - 1] >> 7);
    for (uint8_t k = 0; k < kWord; k++) {
      const uint8_t byte = word[k];
      word[k] = static_cast<uint8_t>(byte << 1 | carry);
      carry = static_cast<uint8_t>(byte >> 7);
    }
  }
}

// The quarters of a round: where two words lie, by how much the second one is rotated before it is
// XORed with the sum that replaces the first one, and by how much the first one is rotated then.
const uint8_t kQuarters[] = {
    0 * kWord, 1 * kWord, 13, 32,  //
    2 * kWord, 3 * kWord, 16, 0,   //
    0 * kWord, 3 * kWord, 21, 0,   //
    2 * kWord, 1 * kWord, 17, 32,
};

}  // namespace

void xor_word(uint8_t* word, const uint8_t* operand) {
  for (uint8_t k = 0; k < kWord; k++) word[k] ^= operand[k];
}

void sip_rounds(uint8_t* state, uint8_t rounds) {
  do {
    const uint8_t* row = kQuarters;
    do {
      uint8_t* const first = state + *row++;
      uint8_t* const second = state + *row++;
      uint8_t carry = 0;
      for (uint8_t k = 0; k < kWord; k++) {
        const uint16_t sum = static_cast<uint16_t>(first[k] + second[k] + carry);
        first[k] = static_cast<uint8_t>(sum);
        carry = static_cast<uint8_t>(sum >> 8);
      }
      rotate(second, *row++);
      xor_word(second, first);
      rotate(first, *row++);
    } while (row != kQuarters + sizeof kQuarters);
  } while (--rounds != 0);
}

}  // namespace tiniscript

#endif
