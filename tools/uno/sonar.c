// HC-SR04s: a pulse of 10 us at the trigger, and half a millisecond later an echo whose length is
// the way of the sound, there and back.

#include "uno.h"

enum {
  kMaxSonars = 4,
  kMicrosecond = kHertz / 1000000,
  kTriggerCycles = 10 * kMicrosecond,
  kBeginCycles = 450 * kMicrosecond,      // eight periods of 40 kHz, and what the module needs
  kNothingCycles = 38000 * kMicrosecond,  // it gives up then
  kNearestMm = 20,
  kFarthestMm = 4000,
};

static struct Sonar {
  int trigger;
  int echo;
  int distance_mm;
  bool is_busy;
  Cycle rose;
} sonars[kMaxSonars];
static int count;

static void falls(Cycle when, void* what) {
  (void)when;
  struct Sonar* sonar = what;
  sonar->is_busy = false;
  pin_drive(sonar->echo, kLow);
}

static void rises(Cycle when, void* what) {
  struct Sonar* sonar = what;
  Cycle length = kNothingCycles;
  if (sonar->distance_mm >= kNearestMm && sonar->distance_mm <= kFarthestMm) {
    length = (Cycle)(sonar->distance_mm * 2.0 / 0.343 * kMicrosecond);  // 343 m/s
  }
  pin_drive(sonar->echo, kHigh);
  at_cycle(when + length, falls, sonar);
}

bool sonar_set(int trigger, int echo, int distance_mm) {
  struct Sonar* sonar = sonars;
  while (sonar < sonars + count && (sonar->trigger != trigger || sonar->echo != echo)) sonar++;
  if (sonar == sonars + kMaxSonars) return false;
  if (sonar == sonars + count) {
    count++;
    *sonar = (struct Sonar){trigger, echo, distance_mm, false, 0};
    pin_drive(echo, kLow);
  }
  sonar->distance_mm = distance_mm;
  return true;
}

void sonar_trigger(Cycle when, int pin, bool level) {
  for (struct Sonar* sonar = sonars; sonar < sonars + count; sonar++) {
    if (sonar->trigger != pin) continue;
    if (level) {
      sonar->rose = when;
    } else if (when - sonar->rose >= kTriggerCycles && !sonar->is_busy) {
      sonar->is_busy = true;
      at_cycle(when + kBeginCycles, rises, sonar);
    }
  }
}
