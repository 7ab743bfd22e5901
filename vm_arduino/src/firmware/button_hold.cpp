#include "button_hold.h"

#include "../robot.h"
#include "../vm/build.h"
#include "../vm/small.h"
#include "persistence.h"
#include "state.h"

namespace tiniscript {

namespace {

constexpr uint16_t kMaxMs = 60000;    // longer presses count as this
constexpr uint16_t kSignHertz = 1568;  // says that the button may be let go
constexpr uint8_t kSignMs = 250;

enum class Phase : uint8_t {
  kUp,
  kEdge,  // a press, or a spike on its wire
  kDown,
  kDownSinceReset,
};

struct Hold {
  Phase phase;
  uint16_t down_ms;
};

Hold hold;

// A press has lasted long enough for a claim.
void confirm() {
  if (!link.confirm_claim()) {
    if ((port_identity().features & kOwned) == 0) return;
    port_identity().features |= kTextAllowed;
  }
  robot_beep(kSignHertz, kSignMs);
}

}  // namespace

void pass_button_hold(uint16_t passed_ms) {
  Hold* const near_hold = near(&hold);
  if (near_hold->phase == Phase::kUp) return;
  const uint16_t previous_ms = near_hold->down_ms;
  near_hold->down_ms =
      passed_ms < kMaxMs - previous_ms ? static_cast<uint16_t>(previous_ms + passed_ms) : kMaxMs;
  if (!kHasOwners) return;
  if (near_hold->phase == Phase::kDown && previous_ms < kClaimMs && near_hold->down_ms >= kClaimMs)
    confirm();
  // Tried again until the store is free.
  if (near_hold->phase == Phase::kDownSinceReset && near_hold->down_ms >= kForgetMs &&
      forget_keys()) {
    near_hold->phase = Phase::kUp;
    robot_beep(kSignHertz, kSignMs);
  }
}

void begin_press() {
  hold.phase = Phase::kEdge;
  hold.down_ms = 0;
}

void hold_press() {
  Hold* const near_hold = near(&hold);
  if (near_hold->phase == Phase::kEdge) {
    near_hold->phase = Phase::kDown;
  } else if (near_hold->phase == Phase::kUp) {
    near_hold->phase = Phase::kDownSinceReset;
    near_hold->down_ms = 0;
  }
}

void end_press() { hold.phase = Phase::kUp; }

bool is_long_press() { return hold.down_ms >= kLongMs; }

}  // namespace tiniscript
