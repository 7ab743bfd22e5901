#include "ultrasonic.h"

#include "../vm/flags.h"
#include "../vm/small.h"
#include "chip.h"
#include "kit.h"

#ifdef tiniscript_ultrasonics

namespace tiniscript {

namespace {

constexpr uint8_t kTriggerUs = 10;      // minimum length of the trigger pulse
constexpr uint16_t kLimitUs = 25000;    // an echo takes at most 23.3 ms, plus 0.5 ms to begin
constexpr uint16_t kSpacingUs = 30000;  // between two pings
constexpr uint8_t kFreshMs = 57;        // 60 ms, less 2 for a late clock and steps of 2
constexpr uint8_t kGlitchUs = 100;      // an echo is at least 117 us long, from 2 cm
constexpr uint16_t kNothing = 0xffff;
constexpr uint32_t kFarthest = 400000;
constexpr uint16_t kThousandthsPer256Us = 4390;  // half of 34.3 cm/ms

enum class Ping : uint8_t { kNone, kTriggered, kListening };

struct Reading {
  uint16_t echo_us;  // the length of its echo; kLimitUs: it heard none; or kNothing
  uint32_t ping_ms;  // when its ping was sent
};

// The interrupt's record of an echo. It ignores pulses and gaps shorter than kGlitchUs.
enum class Heard : uint8_t {
  kNothing,
  kHigh,   // since `rose_us`
  kEnded,  // at `fell_us`; final after kGlitchUs
  kAgain,  // the line is high again since `again_us`
};

Flag<Bit::kSpaced> is_spaced;  // kSpacingUs have passed since `ping_us`

// Everything else lies together, as `near` makes access short.
struct Sonar {
  volatile Heard heard;
  volatile uint16_t rose_us;
  volatile uint16_t fell_us;
  volatile uint16_t again_us;
  Ping ping;
  bool is_held;        // there is a stale echo
  uint8_t last_asked;  // the sensor of the current ping
  uint16_t ping_us;    // when the last ping of any sensor was sent
  uint16_t begun_us;   // when the trigger, or a stale echo, went high
  Reading readings[kUltrasonics];
};

Sonar sonar;

// Where there is only one sensor, the compiler knows.
tini_always_inline uint8_t asked() { return kUltrasonics == 1 ? 0 : sonar.last_asked; }

tini_always_inline uint16_t since(uint16_t now_us, uint16_t then_us) {
  return static_cast<uint16_t>(now_us - then_us);
}

void on_change() {
  Sonar* const it = near(&sonar);
  const uint16_t now_us = clock_us();
  const Heard before = it->heard;
  if (is_high(ultrasonic_at(asked()).echo.pin)) {
    if (before == Heard::kNothing) {
      it->rose_us = now_us;
      it->heard = Heard::kHigh;
    } else if (before == Heard::kEnded && since(now_us, it->fell_us) < kGlitchUs) {
      it->again_us = now_us;
      it->heard = Heard::kAgain;
    }
  } else if (before == Heard::kHigh) {
    it->fell_us = now_us;
    it->heard = since(now_us, it->rose_us) < kGlitchUs ? Heard::kNothing : Heard::kEnded;
  } else if (before == Heard::kAgain) {
    if (since(now_us, it->again_us) >= kGlitchUs) it->fell_us = now_us;
    it->heard = Heard::kEnded;
  }
}

#ifdef __AVR__
// An interrupt.
tini_always_inline void on_pin_change() {
  if (kUltrasonics == 1) {
    on_echo_edge<Sonar, Heard>(&sonar, ultrasonic_at(0).echo, kGlitchUs);
  } else {
    call_in_frame(on_change);
  }
}
#endif

void listen(bool is_on) {
  const CriticalSection critical;
  if (is_on) sonar.heard = Heard::kNothing;
  listen_inside(ultrasonic_at(asked()).echo, is_on);
}

void lower_trigger() {
  Sonar* const it = near(&sonar);
  write(ultrasonic_at(asked()).trigger, false);
  it->ping_us = clock_us();
  is_spaced = false;
  it->readings[asked()].ping_ms = clock_ms();
}

// Continues the current ping. Returns true when it is over and there is a reading.
bool is_over() {
  Sonar* const it = near(&sonar);
  if (it->ping == Ping::kTriggered) {
    if (since(clock_us(), it->begun_us) < kTriggerUs) return false;
    listen(true);
    lower_trigger();
    it->ping = Ping::kListening;
    return false;
  }
  Heard found;
  uint16_t rose_us;
  uint16_t fell_us;
  {
    const CriticalSection critical;
    found = it->heard;
    rose_us = it->rose_us;
    fell_us = it->fell_us;
  }
  const uint16_t now_us = clock_us();
  const uint16_t gone_us = since(now_us, it->ping_us);
  const uint16_t echo_us = since(fell_us, rose_us);
  const uint16_t quiet_us = since(now_us, fell_us);
  const bool has_ended = found == Heard::kEnded;
  if (gone_us < kLimitUs && !(has_ended && quiet_us >= kGlitchUs)) return false;
  listen(false);
  it->ping = Ping::kNone;
  it->readings[asked()].echo_us = has_ended && echo_us < kLimitUs ? echo_us : kLimitUs;
  return true;
}

void begin(uint8_t number) {
  Sonar* const it = near(&sonar);
  it->last_asked = number;
  it->readings[number].echo_us = kNothing;
  write(ultrasonic_at(number).trigger, true);
  it->begun_us = clock_us();
  it->ping = Ping::kTriggered;
}

// Whether kSpacingUs have passed since the last ping of any sensor.
bool may_ping() {
  if (since(clock_us(), sonar.ping_us) >= kSpacingUs) is_spaced = true;
  return is_spaced;
}

// The length of an echo, or kNothing: ask again.
uint16_t echo_of(uint8_t number) {
  Sonar* const it = near(&sonar);
  const Reading& mine = it->readings[number];
  // Nobody has waited for an echo that is found so late.
  if (it->ping != Ping::kNone && is_over() && !is_spaced && asked() == number) return mine.echo_us;
  if (it->ping != Ping::kNone && asked() == number) return kNothing;
  // A sensor without an echo holds its line high for longer and ignores triggers meanwhile.
  const bool is_busy = it->ping == Ping::kNone && is_high(ultrasonic_at(number).echo.pin);
  if (it->ping == Ping::kNone && !is_busy) {
    it->is_held = false;
    if (may_ping()) {
      begin(number);
      return kNothing;
    }
  }
  if (clock_ms() - mine.ping_ms <= kFreshMs) return mine.echo_us;
  if (!is_busy) return kNothing;
  if (!it->is_held) {
    it->is_held = true;
    it->begun_us = clock_us();
    return kNothing;
  }
  if (since(clock_us(), it->begun_us) < kLimitUs) return kNothing;
  it->is_held = false;
  return kLimitUs;
}

}  // namespace

void ultrasonic_begin() {
  for (uint8_t number = 0; number < kUltrasonics; number++) {
    begin_echo(ultrasonic_at(number).echo, on_change);
  }
}

void ultrasonic_tick() {
  if (!is_spaced) may_ping();
}

bool ultrasonic_read(uint8_t number, int32_t* distance) {
  const uint16_t echo_us = echo_of(number);
  if (echo_us == kNothing) return false;
  const uint32_t near = uint32_t{echo_us} * kThousandthsPer256Us >> 8;
  *distance = static_cast<int32_t>(near < kFarthest ? near : kFarthest);
  return true;
}

void ultrasonic_forget() {
  Sonar* const it = near(&sonar);
  if (it->ping == Ping::kTriggered) lower_trigger();
  if (it->ping == Ping::kListening) listen(false);
  it->ping = Ping::kNone;
  it->is_held = false;
  for (Reading& reading : it->readings) reading.echo_us = kNothing;
}

}  // namespace tiniscript

#ifdef tiniscript_ultrasonic_vectors
#define tiniscript_on(vector) \
  ISR(vector, ISR_NAKED) { tiniscript::on_pin_change(); }
tiniscript_ultrasonic_vectors(tiniscript_on)
#endif

#else

void tiniscript::ultrasonic_begin() {}

void tiniscript::ultrasonic_forget() {}

void tiniscript::ultrasonic_tick() {}

#endif
