#include "echo.h"

#include <Arduino.h>

#include "kit.h"

#ifdef tiniscript_echo_vectors

namespace tiniscript {

namespace {

constexpr uint8_t kTriggerUs = 10;      // how long the trigger is high, at least
constexpr uint16_t kLimitUs = 25000;    // there and back is at most 23.3 ms, and 0.5 ms to begin
constexpr uint16_t kSpacingUs = 30000;  // from ping to ping
constexpr uint8_t kFreshMs = 57;        // 60, and `millis` may be 2 behind and jumps by 2
constexpr uint8_t kGlitchUs = 100;      // an echo is 117 us at least, from 2 cm away
constexpr int32_t kNothing = -1;
constexpr int32_t kFarthest = 400000;
constexpr uint16_t kThousandthsPer256Us = 4390;  // half of 34.3 cm a millisecond
constexpr uint16_t kGroups = 0x68;               // PCICR
constexpr uint16_t kChanges = 0x6b;              // PCMSK0 to PCMSK2
constexpr uint16_t kExternal = 0x3d;             // EIMSK
constexpr uint8_t kExternalGroup = 3;

enum class Ping : uint8_t { kNone, kTriggered, kListening };

struct Reading {
  int32_t distance;  // or kNothing
  uint32_t ping_ms;  // when its ping left
};

Reading readings[kEchoes];
Ping ping;
uint8_t asked;      // the sensor of this ping
uint32_t ping_us;   // when the last ping left, of any sensor
uint32_t begun_us;  // since when the trigger is high, or an echo that is nobody's
bool is_held;       // there is such an echo

// What the interrupt notes of an echo. What is shorter than kGlitchUs is no echo, and no gap in one.
enum class Heard : uint8_t {
  kNothing,
  kHigh,   // since `rose_us`
  kEnded,  // at `fell_us`; after kGlitchUs that is final
  kAgain,  // but the line is high again, since `again_us`
};

volatile Heard heard;
volatile uint16_t rose_us;
volatile uint16_t fell_us;
volatile uint16_t again_us;

tini_always_inline uint16_t since(uint16_t now_us, uint16_t then_us) {
  return static_cast<uint16_t>(now_us - then_us);
}

tini_always_inline void on_change() {
  const uint16_t now_us = static_cast<uint16_t>(micros());
  const Heard before = heard;
  if (is_high(echo_at(asked).echo)) {
    if (before == Heard::kNothing) {
      rose_us = now_us;
      heard = Heard::kHigh;
    } else if (before == Heard::kEnded && since(now_us, fell_us) < kGlitchUs) {
      again_us = now_us;
      heard = Heard::kAgain;
    }
  } else if (before == Heard::kHigh) {
    fell_us = now_us;
    heard = since(now_us, rose_us) < kGlitchUs ? Heard::kNothing : Heard::kEnded;
  } else if (before == Heard::kAgain) {
    if (since(now_us, again_us) >= kGlitchUs) fell_us = now_us;
    heard = Heard::kEnded;
  }
}

void listen(bool is_on) {
  const CriticalSection critical;
  const Echo sensor = echo_at(asked);
  const uint8_t group = sensor.group;
  const uint16_t masks =
      group == kExternalGroup ? kExternal : static_cast<uint16_t>(kChanges + group);
  if (is_on) {
    heard = Heard::kNothing;
    if (group == kExternalGroup) {
#ifdef EICRB
      EICRA = 0x55;  // each change of INT0 to INT7
      EICRB = 0x55;
      EIFR = sensor.interrupt;
#endif
    } else {
      PCIFR = static_cast<uint8_t>(1 << group);
      register8(kGroups) |= static_cast<uint8_t>(1 << group);
    }
    register8(masks) |= sensor.interrupt;
  } else {
    register8(masks) &= static_cast<uint8_t>(~sensor.interrupt);
  }
}

void lower_trigger() {
  write(echo_at(asked).trigger, false);
  ping_us = micros();
  readings[asked].ping_ms = millis();
}

// Goes on with the ping that is under way. True: it is over, and there is a reading.
bool is_over() {
  if (ping == Ping::kTriggered) {
    if (micros() - begun_us < kTriggerUs) return false;
    listen(true);
    lower_trigger();
    ping = Ping::kListening;
    return false;
  }
  Heard found;
  uint16_t echo_us;
  uint16_t quiet_us;
  uint32_t gone_us;
  {
    const CriticalSection critical;
    const uint32_t now_us = micros();
    gone_us = now_us - ping_us;
    found = heard;
    echo_us = since(fell_us, rose_us);
    quiet_us = since(static_cast<uint16_t>(now_us), fell_us);
  }
  const bool has_ended = found == Heard::kEnded;
  if (gone_us < kLimitUs && !(has_ended && quiet_us >= kGlitchUs)) return false;
  listen(false);
  ping = Ping::kNone;
  int32_t distance = kFarthest;
  if (has_ended && echo_us < kLimitUs) {
    const int32_t near = static_cast<int32_t>(uint32_t{echo_us} * kThousandthsPer256Us >> 8);
    if (near < kFarthest) distance = near;
  }
  readings[asked].distance = distance;
  return true;
}

void begin(uint8_t number) {
  asked = number;
  readings[number].distance = kNothing;
  write(echo_at(number).trigger, true);
  begun_us = micros();
  ping = Ping::kTriggered;
}

}  // namespace

bool echo_read(uint8_t number, int32_t* distance) {
  const Reading& mine = readings[number];
  if (ping != Ping::kNone && is_over() && asked == number) {
    *distance = mine.distance;
    return true;
  }
  if (ping != Ping::kNone && asked == number) return false;
  // A sensor that has heard nothing holds its echo for longer, and sees no trigger meanwhile.
  const bool is_busy = ping == Ping::kNone && is_high(echo_at(number).echo);
  if (ping == Ping::kNone && !is_busy) {
    is_held = false;
    if (micros() - ping_us >= kSpacingUs) {
      begin(number);
      return false;
    }
  }
  if (mine.distance != kNothing && millis() - mine.ping_ms <= kFreshMs) {
    *distance = mine.distance;
    return true;
  }
  if (!is_busy) return false;
  if (!is_held) {
    is_held = true;
    begun_us = micros();
    return false;
  }
  if (micros() - begun_us < kLimitUs) return false;
  is_held = false;
  *distance = kFarthest;
  return true;
}

void echo_forget() {
  if (ping == Ping::kTriggered) lower_trigger();
  if (ping == Ping::kListening) listen(false);
  ping = Ping::kNone;
  is_held = false;
  for (Reading& reading : readings) reading.distance = kNothing;
}

}  // namespace tiniscript

#define tiniscript_on(vector) \
  ISR(vector) { tiniscript::on_change(); }
tiniscript_echo_vectors(tiniscript_on)

#else

void tiniscript::echo_forget() {}

#endif
