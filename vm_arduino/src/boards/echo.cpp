#include "echo.h"

#include <Arduino.h>

#include "kit.h"

#ifdef tiniscript_echo_vectors

namespace tiniscript {

namespace {

constexpr uint8_t kTriggerUs = 10;    // how long the trigger is high, at least
constexpr uint16_t kLimitUs = 25000;  // there and back is at most 23.3 ms, and 0.5 ms to begin
constexpr int32_t kFarthest = 400000;
constexpr uint16_t kThousandthsPer256Us = 4390;  // half of 34.3 cm a millisecond
constexpr uint16_t kGroups = 0x68;               // PCICR
constexpr uint16_t kChanges = 0x6b;              // PCMSK0 to PCMSK2
constexpr uint16_t kExternal = 0x3d;             // EIMSK
constexpr uint8_t kExternalGroup = 3;

enum class Ping : uint8_t { kNone, kTriggered, kListening };

Ping ping;
uint32_t begun_us;  // where there is no ping: since when the last one's echo is still high
bool is_held;       // whether it is
Pin heard;

enum class Heard : uint8_t { kNothing, kBegin, kAll };

// What the interrupt notes: when the echo began, and then how long it was.
volatile Heard state;
volatile uint32_t echo_us;

in_place void on_change() {
  const uint32_t now_us = micros();
  if (is_high(heard)) {
    echo_us = now_us;
    state = Heard::kBegin;
  } else if (state == Heard::kBegin) {
    echo_us = now_us - echo_us;
    state = Heard::kAll;
  }
}

void listen(Echo sensor, bool is_on) {
  const NoInterrupts quiet;
  const uint16_t masks =
      sensor.group == kExternalGroup ? kExternal : static_cast<uint16_t>(kChanges + sensor.group);
  if (is_on) {
    heard = sensor.echo;
    state = Heard::kNothing;
    if (sensor.group == kExternalGroup) {
#ifdef EICRB
      EICRA = 0x55;  // each change of INT0 to INT7
      EICRB = 0x55;
      EIFR = sensor.interrupt;
#endif
    } else {
      PCIFR = static_cast<uint8_t>(1 << sensor.group);
      register8(kGroups) |= static_cast<uint8_t>(1 << sensor.group);
    }
    register8(masks) |= sensor.interrupt;
  } else {
    register8(masks) &= static_cast<uint8_t>(~sensor.interrupt);
  }
}

}  // namespace

bool echo_read(Echo sensor, int32_t* distance) {
  const uint32_t now_us = micros();
  const uint32_t gone_us = now_us - begun_us;
  switch (ping) {
    case Ping::kNone:
      // A sensor that has heard nothing holds its echo for longer, and sees no trigger meanwhile.
      if (is_high(sensor.echo)) {
        if (!is_held) {
          is_held = true;
          begun_us = now_us;
          return false;
        }
        if (gone_us < kLimitUs) return false;
        is_held = false;
        *distance = kFarthest;
        return true;
      }
      is_held = false;
      write(sensor.trigger, true);
      begun_us = micros();
      ping = Ping::kTriggered;
      return false;
    case Ping::kTriggered:
      if (gone_us < kTriggerUs) return false;
      listen(sensor, true);
      write(sensor.trigger, false);
      begun_us = micros();
      ping = Ping::kListening;
      return false;
    case Ping::kListening:
      break;
  }
  const bool is_heard = state == Heard::kAll;  // from then on `echo_us` stays as it is
  if (!is_heard && gone_us < kLimitUs) return false;
  listen(sensor, false);
  ping = Ping::kNone;
  *distance = kFarthest;
  if (is_heard && echo_us < kLimitUs) {
    const int32_t found = static_cast<int32_t>(echo_us * kThousandthsPer256Us >> 8);
    if (found < kFarthest) *distance = found;
  }
  return true;
}

void echo_forget() {
  ping = Ping::kNone;
  is_held = false;
}

}  // namespace tiniscript

#define tiniscript_on(vector) \
  ISR(vector) { tiniscript::on_change(); }
tiniscript_echo_vectors(tiniscript_on)

#else

void tiniscript::echo_forget() {}

#endif
