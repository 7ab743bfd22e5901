// Sealed frames: which ones the robot takes, and which of its own it seals. `docs/develop/link.md` says why.

#include "../vm/build.h"
#include "link.h"
#include "port.h"

#ifdef tiniscript_seals

namespace tiniscript {

namespace {

uint8_t number_of(Message message) { return static_cast<uint8_t>(message); }

}  // namespace

// Returns the end of the payload of the request in a frame that ends at `end`, or 0: a frame with a
// wrong seal is not answered. STOP is taken from anybody.
uint8_t Link::open_seal(uint8_t end) {
  const uint8_t* const bytes = receiver_->bytes();
  const uint8_t type = bytes[kTypeAt];
  if ((type & kSealed) == 0 || !may_seal()) return end;
  is_sealed_ = seal_.open(bytes, end);
  if (is_sealed_) {
    left_ms_[kSealHeard] = kListenMs;
    return static_cast<uint8_t>(end - kTagBytes);
  }
  const bool is_stop = type == (number_of(Message::kStop) | kSealed);
  return is_stop || !seal_.is_set() ? kSealedPayloadAt : 0;
}

// The request is answered: its reply is sealed as it was, and that to the right tag with the new seal.
void Link::close_seal() {
  const bool is_tag = reply_.number == number_of(Message::kAuthenticate) &&
                      reply_.status == kOkStatus && (rights_ & kHasChallenge) == 0;
  is_reply_sealed_ = is_sealed_ || is_tag;
  if (is_sealed_) {  // an unsealed frame comes after it, and repeats nothing
    last_reply_.seq = reply_.seq;
    last_reply_.number = 0;
  }
  is_sealed_ = false;
  if (!seal_.is_set()) left_ms_[kListen] = kListenMs;  // what has dropped it was heard
}

void Link::begin_seal(const uint8_t* key, uint8_t kind) {
  if (!may_seal()) return;
  const SealOrigin origin = {challenge_, nonce_, port_identity().nonce, epoch_, kind};
  seal_.begin(key, origin);
}

// While there is a seal, a stranger cannot change the robot's memory of its last request.
bool Link::keeps_answer(uint8_t type) const {
  if (!seal_.is_set() || is_sealed_) return true;
  return type == number_of(Message::kAuthenticate) && reply_.status == kOkStatus;
}

// The mark in the type of a frame to the computer. When the counter ends, authority ends, too.
uint8_t Link::seal_mark() {
  if (seal_.may_close()) return kSealed;
  expire();
  return 0;
}

}  // namespace tiniscript

#endif
