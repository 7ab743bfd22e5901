#include "seal.h"

#include "../vm/build.h"
#include "../vm/small.h"
#include "siphash.h"

namespace tiniscript {

tini_noinline bool are_equal(const uint8_t* first, const uint8_t* second, uint8_t length) {
  uint8_t difference = 0;
  while (length-- != 0) difference = static_cast<uint8_t>(difference | (*first++ ^ *second++));
  return difference == 0;
}

namespace {

// A label and the origin: no other hash under the robot's keys is of so many bytes.
constexpr uint8_t kLabelAt = 0;
constexpr uint8_t kChallengeAt = 1;
constexpr uint8_t kNonceAt = kChallengeAt + kChallengeBytes;
constexpr uint8_t kRobotNonceAt = kNonceAt + sizeof(uint32_t);
constexpr uint8_t kOriginEpochAt = kRobotNonceAt + sizeof(uint32_t);
constexpr uint8_t kOriginKindAt = kOriginEpochAt + 1;
constexpr uint8_t kOriginBytes = kOriginKindAt + 1;

static_assert(kKeyBytes == 2 * kHashBytes, "a key is two hashes");
static_assert(kTagBytes == kHashBytes, "a MAC is a hash");

}  // namespace

void Seal::begin(const uint8_t* key, const SealOrigin& origin) {
  uint8_t text[kOriginBytes];
  copy_bytes(origin.challenge, text + kChallengeAt, kChallengeBytes);
  copy_bytes(&origin.nonce, text + kNonceAt, sizeof origin.nonce);
  copy_bytes(&origin.robot_nonce, text + kRobotNonceAt, sizeof origin.robot_nonce);
  text[kOriginEpochAt] = origin.epoch;
  text[kOriginKindAt] = origin.kind;
  text[kLabelAt] = 1;
  siphash(key, text, kOriginBytes, key_);
  text[kLabelAt] = 2;
  siphash(key, text, kOriginBytes, key_ + kHashBytes);
  received_counter_ = sent_counter_ = 0;
  is_set_ = true;
}

void Seal::drop() {
  is_set_ = false;
  for (uint8_t& byte : key_) byte = 0;
}

bool Seal::open(const uint8_t* bytes, uint8_t end) {
  if (!is_set_ || end < kSealedPayloadAt + kTagBytes || bytes[kSealZeroAt] != 0) return false;
  const uint8_t mac_start = static_cast<uint8_t>(end - kTagBytes);
  uint8_t mac[kTagBytes];
  siphash(key_, bytes + kTypeAt, static_cast<uint8_t>(mac_start - kTypeAt), mac);
  const uint32_t counter = get32(bytes + kCounterAt);
  if (!are_equal(mac, bytes + mac_start, kTagBytes) || counter <= received_counter_) return false;
  received_counter_ = counter;
  return true;
}

uint8_t Seal::close(uint8_t* bytes, uint8_t end) {
  sent_counter_++;
  bytes[kSealZeroAt] = 0;
  copy_bytes(&sent_counter_, bytes + kCounterAt, sizeof sent_counter_);
  siphash(key_, bytes + kTypeAt, static_cast<uint8_t>(end - kTypeAt), bytes + end);
  return static_cast<uint8_t>(end + kTagBytes);
}

// No other text under this key is so short. A counter is never used twice.
void Seal::cover(const uint8_t* counter, uint8_t* bytes, uint8_t length) const {
  uint8_t text[sizeof(uint32_t) + 1];
  uint8_t stream[kHashBytes];
  copy_bytes(counter, text, sizeof(uint32_t));
  for (uint8_t k = 0; k < length; k++) {
    const uint8_t index = k % kHashBytes;
    if (index == 0) {
      text[sizeof(uint32_t)] = static_cast<uint8_t>(k / kHashBytes);
      siphash(key_, text, sizeof text, stream);
    }
    bytes[k] ^= stream[index];
  }
}

}  // namespace tiniscript
