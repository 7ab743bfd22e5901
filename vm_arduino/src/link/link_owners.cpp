// Who may drive the robot: claims, keys, and the authority of a session.

#include "../vm/build.h"
#include "../vm/small.h"
#include "link.h"
#include "port.h"
#include "seal.h"
#include "siphash.h"

namespace tiniscript {

namespace {

constexpr uint8_t kTagText = kChallengeBytes + sizeof(uint32_t) + 2;
// Longer by a label than that of a tag: no challenge is the tag of another one.
constexpr uint8_t kChallengeText = kChallengeBytes + sizeof(uint32_t) + sizeof(uint16_t) + 1;
constexpr uint8_t kChallengeLabel = 'C';

static_assert(kChallengeText > kTagText, "the hash has the length in it");
static_assert(kTagBytes == kHashBytes && kChallengeBytes == kHashBytes, "both are hashes");

bool has(uint8_t feature) { return (port_identity().features & feature) != 0; }

}  // namespace

tini_noinline bool is_key(const uint8_t* key) {
  uint8_t bits = 0;
  for (uint8_t k = 0; k < kKeyBytes; k++) bits |= key[k];
  return bits != 0;
}

// Whether a message needs authority that the session does not have.
bool Link::is_forbidden(uint8_t type) const {
  if (!kHasOwners) return false;
  if (has_seal()) {
    if (is_sealed()) return false;
  } else if ((port_identity().features & (kOwned | kYours)) != kOwned) {
    return false;
  }
  if (type < kFirstActing) return type == static_cast<uint8_t>(Message::kFetch);
  return type < static_cast<uint8_t>(Message::kClaim) ||
         type > static_cast<uint8_t>(Message::kIdentify);
}

// Whether the sender of the current frame has a right: under a seal, only sealed frames have it.
bool Link::is_authorized(bool has_right) const { return has_right && (!has_seal() || is_sealed()); }

tini_noinline void Link::expire() {
  Identity& identity = port_identity();
  identity.features &= static_cast<uint8_t>(~kYours);
  constexpr uint8_t kKeptFeatures =
      kMoreBreakpoints | kMoreReadings | (kHasSeals ? kMoreSeals | kMoreWifiRests : 0);
  identity.more_features = kKeptFeatures != 0 ? identity.more_features & kKeptFeatures : 0;
  drop_seal();
  rights_ &= kHeldBack;
  is_ready_ = false;  // the image was prepared with that authority
}

bool Link::confirm_claim() {
  if (!kHasOwners || (rights_ & kIsAsked) == 0) return false;
  rights_ |= kIsConfirmed;
  return true;
}

tini_noinline Answer Link::claim(const uint8_t* payload, uint8_t length) {
  const uint8_t kind = payload[kClaimKindAt];
  const uint8_t key_bytes = static_cast<uint8_t>(length - kClaimKeyAt);
  if (kind > static_cast<uint8_t>(Key::kTeacher)) return Answer::kBadValue;
  if (key_bytes != 0 && key_bytes != kKeyBytes) return Answer::kBadLength;
  uint8_t key[kKeyBytes];
  uint8_t new_key[kKeyBytes] = {};
  copy_bytes(payload + kClaimKeyAt, new_key, key_bytes);
  Answer answer = port_key(kind, key);
  if (answer != Answer::kOk) return answer;
  const bool is_teachers = kind == static_cast<uint8_t>(Key::kTeacher) && is_key(key);
  const bool is_allowed =
      is_teachers ? is_authorized(is_teacher()) : !has(kOwned) || is_authorized(has(kYours));
  const bool is_given = is_key(new_key);
  // A claim that is repeated because its answer was lost comes without authority.
  if (are_equal(key, new_key, kKeyBytes) && (is_given || is_allowed)) {
    rights_ &= static_cast<uint8_t>(~(kIsAsked | kIsConfirmed));
    return Answer::kOk;
  }
  if (!is_allowed) return Answer::kNotOwner;
  if (is_given && (rights_ & kIsConfirmed) == 0) {
    rights_ |= kIsAsked;
    return Answer::kHoldButton;
  }
  return port_keep_key(kind, new_key);
}

tini_noinline uint8_t Link::authenticate(const uint8_t* payload, uint8_t length) {
  const uint8_t kind = payload[kAuthenticateKindAt];
  const uint8_t* const tag = payload + kAuthenticateTagAt;
  if (kind > static_cast<uint8_t>(Key::kTeacher)) return number_of(Answer::kBadValue);
  uint8_t key[kKeyBytes];
  const Answer answer = port_key(kind, key);
  if (answer != Answer::kOk) return number_of(answer);
  if (!is_key(key)) return number_of(Answer::kWrongKey);
  uint8_t text[kChallengeText];
  copy_bytes(challenge_, text, kChallengeBytes);
  if (length == kAuthenticateTagAt) {
    if (may_seal()) expire();  // a new seal replaces the one before
    copy_bytes(&port_identity().nonce, text + kChallengeBytes, sizeof(uint32_t));
    copy_bytes(&now_ms_, text + kChallengeBytes + sizeof(uint32_t), sizeof now_ms_);
    text[kChallengeText - 1] = kChallengeLabel;
    siphash(key, text, kChallengeText, challenge_);
    rights_ |= kHasChallenge;
    return kOkStatus;
  }
  if (length != kAuthenticateTagAt + kTagBytes) return number_of(Answer::kBadLength);
  if ((rights_ & kHasChallenge) == 0) return number_of(Answer::kNotOwner);
  rights_ &= static_cast<uint8_t>(~kHasChallenge);
  copy_bytes(&nonce_, text + kChallengeBytes, sizeof nonce_);
  text[kTagText - 2] = epoch_;
  text[kTagText - 1] = kind;
  siphash(key, text, kTagText, text);
  // 64 bits cannot be guessed, and a pause for strangers would also delay the owner.
  if (!are_equal(text, tag, kTagBytes)) return number_of(Answer::kWrongKey);
  port_identity().features |= kYours;
  if (kind == static_cast<uint8_t>(Key::kTeacher)) {
    port_identity().more_features |= kMoreByTeacher;
  }
  if (kMaySeal) begin_seal(key, kind);
  return kOkStatus;
}

Answer Link::allow_text(const uint8_t* payload) {
  const uint8_t is_allowed = payload[kTextIsAllowedAt];
  if (is_allowed > 1) return Answer::kBadValue;
  if (is_allowed != 0 || !has(kOwned)) {
    port_identity().features |= kTextAllowed;
  } else {
    port_identity().features &= static_cast<uint8_t>(~kTextAllowed);
    console_.drop();
  }
  return Answer::kOk;
}

}  // namespace tiniscript
