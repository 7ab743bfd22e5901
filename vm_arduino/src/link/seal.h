// The seal of a session: a key that both ends have derived, and a counter for each direction.
//
// Knows the bytes of a sealed frame, as `seal.py` does. Knows no message. In a buffer the frame lies as
// `frames.h` says: type, sequence number, epoch, 0, counter, payload, MAC.

#pragma once

#include <stdint.h>

#include "../vm/build.h"
#include "frames.h"
#include "messages.h"

namespace tiniscript {

constexpr uint8_t kSealZeroAt = kPayloadAt;
constexpr uint8_t kCounterAt = kSealZeroAt + 1;
constexpr uint8_t kSealedPayloadAt = kCounterAt + sizeof(uint32_t);
constexpr uint32_t kLastCounter = 0xffffffff;

// The data that a key is derived from, besides the key of the robot.
struct SealOrigin {
  const uint8_t* challenge;
  uint32_t nonce;        // the computer's
  uint32_t robot_nonce;
  uint8_t epoch;
  uint8_t kind;  // of the robot's keys
};

// Starts as one that is not set.
class Seal {
 public:
  bool is_set() const { return is_set_; }

  // Whether another frame may be sealed: a counter value is never used twice.
  bool may_close() const { return is_set_ && sent_counter_ != kLastCounter; }

  void begin(const uint8_t* key, const SealOrigin& origin);

  // Forgets the key.
  void drop();

  // Whether the frame, whose MAC ends at `end`, is one of the computer that has this seal, and is
  // newer than all before. Then its payload ends kTagBytes before.
  bool open(const uint8_t* bytes, uint8_t end);

  // Encrypts or decrypts bytes of the frame with this counter: no one else can read them.
  void cover(const uint8_t* counter, uint8_t* bytes, uint8_t length) const;

  // Seals a frame whose payload ends at `end`: writes 0, counter and MAC. Returns where that ends.
  uint8_t close(uint8_t* bytes, uint8_t end);

 protected:
  uint32_t received_counter_;  // the last counter from the computer
  uint32_t sent_counter_;      // the last one to it

 private:
  bool is_set_;
  uint8_t key_[kKeyBytes];
};

// Whether bytes are equal, in constant time, so that timing reveals nothing about them.
bool are_equal(const uint8_t* first, const uint8_t* second, uint8_t length);

}  // namespace tiniscript
