#include "siphash.h"

#include "../vm/cpu.h"
#include "../vm/small.h"

namespace tiniscript {

namespace {

constexpr uint8_t kRounds = 2;  // after each word of the message
constexpr uint8_t kLastRounds = 4;

// The state before the key: "somepseudorandomlygeneratedbytes" in words.
const uint8_t kInitialState[kWords * kWord + 1] tini_progmem = "uespemosmodnarodarenegylsetybdet";

}  // namespace

tini_noinline void siphash(const uint8_t* key, const uint8_t* message, uint8_t length,
                           uint8_t* hash) {
  uint8_t state[kWords * kWord];
  for (uint8_t k = 0; k < sizeof state; k++) {
    state[k] = static_cast<uint8_t>(flash_byte(kInitialState + k) ^ key[k % (2 * kWord)]);
  }
  uint8_t offset = 0;
  uint8_t word[kWord];
  do {
    for (uint8_t k = 0; k < kWord; k++) {
      const uint8_t place = static_cast<uint8_t>(offset + k);
      word[k] = place < length ? message[place] : 0;
    }
    offset = static_cast<uint8_t>(offset + kWord);
    if (offset > length) word[kWord - 1] = length;
    xor_word(state + 3 * kWord, word);
    sip_rounds(state, kRounds);
    xor_word(state, word);
  } while (offset <= length);
  state[2 * kWord] ^= 0xff;
  sip_rounds(state, kLastRounds);
  for (uint8_t k = 0; k < kWord; k++) {
    hash[k] = static_cast<uint8_t>(state[k] ^ state[k + kWord] ^ state[k + 2 * kWord] ^
                                   state[k + 3 * kWord]);
  }
}

}  // namespace tiniscript
