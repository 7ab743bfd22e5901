// The robot's keys: implements their part of `port.h`.

#include "../link/port.h"
#include "../store/layout.h"
#include "../store/nvm.h"
#include "../vm/build.h"
#include "persistence.h"
#include "state.h"

namespace tiniscript {

static_assert(kKeyRoom == kKeyBytes, "a key fills its place");

// Reads the keys byte by byte, so that they are nowhere in RAM. A robot that cannot read them may
// have an owner: no one can drive it.
void read_owner() {
  if (!kHasOwners) return;
  uint8_t key[kKeyBytes];
  uint8_t features = port_identity().features & static_cast<uint8_t>(~(kOwned | kTextAllowed));
  const bool has_key = fetch_key(static_cast<uint8_t>(Key::kOwner), key) && is_key(key);
  if (has_key || !nvm_is_readable()) {
    features |= kOwned;
  } else {
    features |= kTextAllowed;
  }
  port_identity().features = features | kOwners;
  if (kHasSeals) port_identity().more_features |= kMoreSeals;
}

Answer port_key(uint8_t kind, uint8_t* key) {
  if (!nvm_is_readable()) return Answer::kUnreadable;
  const Answer answer = owner_save_answer();
  if (answer != Answer::kOk) return answer;
  return fetch_key(kind, key) ? Answer::kOk : busy_answer();
}

}  // namespace tiniscript
