#include "siphash.h"

#include "../vm/flash.h"
#include "../vm/small.h"

namespace tiniscript {

namespace {

constexpr uint8_t kWord = 8;  // bytes, little-endian
constexpr uint8_t kWords = 4;
constexpr uint8_t kRounds = 2;  // after each word of the message
constexpr uint8_t kLastRounds = 4;

// The state before the key: "somepseudorandomlygeneratedbytes" in words.
const uint8_t kBegin[kWords * kWord + 1] tini_progmem = "uespemosmodnarodarenegylsetybdet";

tini_noinline void mix(uint8_t* word, const uint8_t* other) {
  for (uint8_t k = 0; k < kWord; k++) word[k] ^= other[k];
}

// Rotates a word to the left by whole bytes, then by bits.
tini_noinline void rotate(uint8_t* word, uint8_t bytes, uint8_t bits) {
  while (bytes-- != 0) {
    const uint8_t last = word[kWord - 1];
    for (uint8_t k = kWord - 1; k != 0; k--) word[k] = word[k - 1];
    word[0] = last;
  }
  while (bits-- != 0) {
    uint8_t carry = static_cast<uint8_t>(word[kWord - 1] >> 7);
    for (uint8_t k = 0; k < kWord; k++) {
      const uint8_t byte = word[k];
      word[k] = static_cast<uint8_t>(byte << 1 | carry);
      carry = static_cast<uint8_t>(byte >> 7);
    }
  }
}

// first += second; second = second rotated, XOR first.
tini_noinline void stir(uint8_t* first, uint8_t* second, uint8_t bytes, uint8_t bits) {
  uint8_t carry = 0;
  for (uint8_t k = 0; k < kWord; k++) {
    const uint16_t sum = static_cast<uint16_t>(first[k] + second[k] + carry);
    first[k] = static_cast<uint8_t>(sum);
    carry = static_cast<uint8_t>(sum >> 8);
  }
  rotate(second, bytes, bits);
  mix(second, first);
}

tini_noinline void go_round(uint8_t* state, uint8_t rounds) {
  while (rounds-- != 0) {
    stir(state, state + kWord, 1, 5);  // by 13
    rotate(state, 4, 0);
    stir(state + 2 * kWord, state + 3 * kWord, 2, 0);  // by 16
    stir(state, state + 3 * kWord, 2, 5);              // by 21
    stir(state + 2 * kWord, state + kWord, 2, 1);      // by 17
    rotate(state + 2 * kWord, 4, 0);
  }
}

}  // namespace

tini_noinline void siphash(const uint8_t* key, const uint8_t* message, uint8_t length,
                           uint8_t* hash) {
  uint8_t state[kWords * kWord];
  for (uint8_t k = 0; k < sizeof state; k++) {
    state[k] = static_cast<uint8_t>(flash_byte(kBegin + k) ^ key[k % (2 * kWord)]);
  }
  uint8_t at = 0;
  uint8_t word[kWord];
  do {
    for (uint8_t k = 0; k < kWord; k++) {
      const uint8_t place = static_cast<uint8_t>(at + k);
      word[k] = place < length ? message[place] : 0;
    }
    at = static_cast<uint8_t>(at + kWord);
    if (at > length) word[kWord - 1] = length;
    mix(state + 3 * kWord, word);
    go_round(state, kRounds);
    mix(state, word);
  } while (at <= length);
  state[2 * kWord] ^= 0xff;
  go_round(state, kLastRounds);
  for (uint8_t k = 0; k < kWord; k++) {
    hash[k] = static_cast<uint8_t>(state[k] ^ state[k + kWord] ^ state[k + 2 * kWord] ^
                                   state[k + 3 * kWord]);
  }
}

}  // namespace tiniscript
