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
constexpr uint8_t kFreshAge = 28;       // 60 ms, less 2 for a late clock and a step of 2
constexpr uint8_t kOldAge = 150;        // 300 ms: a healthy sensor has lowered its echo by then
constexpr uint16_t kNearUs = 175;       // 3 cm
constexpr uint8_t kGlitchUs = 100;      // an echo is at least 117 us long, from 2 cm
constexpr uint16_t kNothing = 0xffff;
constexpr uint32_t kFarthest = 400000;
constexpr uint16_t kFarUs = 23326;      // an echo from there
constexpr uint16_t kThousandthsPer256Us = 4390;  // half of 34.3 cm/ms

// A Nano has no room for more.
#ifdef tiniscript_trusts_samples
constexpr bool kTrustsSamples = true;
#else
constexpr bool kTrustsSamples = false;
#endif

enum class Ping : uint8_t { kNone, kTriggered, kListening };

// Lengths of echoes; kLimitUs: there was no echo; or kNothing.
struct Reading {
  uint16_t echo_us;    // the value
  uint16_t sample_us;  // a sample that is not yet confirmed
  uint8_t age;         // since its last ping, in steps of 2 ms; a long time is 0xff
};

// The interrupt's record of an echo. It ignores pulses and gaps shorter than kGlitchUs.
enum class EchoState : uint8_t {
  kNothing,
  kHigh,       // since `rose_us`
  kEnded,      // at `fell_us`; final after kGlitchUs
  kHighAgain,  // the line is high again since `high_again_us`
};

Flag<Bit::kSpaced> is_spaced;  // kSpacingUs have passed since `ping_us`

// The rest lies together, as `near` makes access short.
struct Sonar {
  volatile EchoState echo_state;
  volatile uint16_t rose_us;
  volatile uint16_t fell_us;
  volatile uint16_t high_again_us;
  Ping ping;
  bool is_held;         // there is a stale echo
  uint8_t ages_ms;      // when the ages were right
  uint8_t last_pinged;  // the sensor of the current ping
  uint16_t ping_us;     // when the last ping of any sensor was sent
  uint16_t start_us;    // when the trigger, or a stale echo, went high
  Reading readings[kUltrasonics];
};

Sonar sonar;

// With only one sensor, the compiler knows which one.
tini_always_inline uint8_t pinged_sensor() { return kUltrasonics == 1 ? 0 : sonar.last_pinged; }

tini_always_inline uint16_t elapsed_us(uint16_t now_us, uint16_t earlier_us) {
  return static_cast<uint16_t>(now_us - earlier_us);
}

void on_change() {
  Sonar* const near_sonar = near(&sonar);
  const uint16_t now_us = clock_us();
  const EchoState state = near_sonar->echo_state;
  if (is_high(ultrasonic_at(pinged_sensor()).echo.pin)) {
    if (state == EchoState::kNothing) {
      near_sonar->rose_us = now_us;
      near_sonar->echo_state = EchoState::kHigh;
    } else if (state == EchoState::kEnded && elapsed_us(now_us, near_sonar->fell_us) < kGlitchUs) {
      near_sonar->high_again_us = now_us;
      near_sonar->echo_state = EchoState::kHighAgain;
    }
  } else if (state == EchoState::kHigh) {
    near_sonar->fell_us = now_us;
    near_sonar->echo_state = elapsed_us(now_us, near_sonar->rose_us) < kGlitchUs
                                 ? EchoState::kNothing
                                 : EchoState::kEnded;
  } else if (state == EchoState::kHighAgain) {
    if (elapsed_us(now_us, near_sonar->high_again_us) >= kGlitchUs) near_sonar->fell_us = now_us;
    near_sonar->echo_state = EchoState::kEnded;
  }
}

#ifdef __AVR__
// An interrupt.
tini_always_inline void on_pin_change() {
  if (kUltrasonics == 1) {
    on_echo_edge<Sonar, EchoState>(&sonar, ultrasonic_at(0).echo, kGlitchUs);
  } else {
    call_in_frame(on_change);
  }
}
#endif

// Whether `difference_us` is over 3 cm, and over 20 % of `value_us`.
tini_always_inline bool is_far(uint16_t difference_us, uint16_t value_us) {
  if (difference_us >= 0x2000) return true;  // no value is so long that this is less
  return difference_us > kNearUs && static_cast<uint16_t>(5 * difference_us) > value_us;
}

// One wrong sample has no effect: one that is far from the value counts only with a second, and the
// value is the middle one of the three. The same holds for the first value of a run, of three
// samples.
void add_sample(Reading& reading, uint16_t us) {
  if (kTrustsSamples) {
    reading.echo_us = us;
    reading.sample_us = kNothing;
    return;
  }
  uint16_t value_us = reading.echo_us;
  const uint16_t sample_us = reading.sample_us;
  uint16_t low = us;
  uint16_t high = value_us;
  if (low > high) {
    low = value_us;
    high = us;
  }
  if (sample_us == kNothing) {
    const uint16_t difference_us = static_cast<uint16_t>(high - low);
    if (is_far(difference_us, value_us)) {  // always, where there is no value
      reading.sample_us = us;
      return;
    }
    value_us = us;
  } else if (value_us == kNothing) {
    value_us = us;
  } else {
    value_us = sample_us < low ? low : sample_us > high ? high : sample_us;
    reading.sample_us = kNothing;
  }
  reading.echo_us = value_us;
}

void listen(bool is_on) {
  const CriticalSection critical;
  if (is_on) sonar.echo_state = EchoState::kNothing;
  listen_inside(ultrasonic_at(pinged_sensor()).echo, is_on);
}

void lower_trigger() {
  Sonar* const near_sonar = near(&sonar);
  write(ultrasonic_at(pinged_sensor()).trigger, false);
  near_sonar->ping_us = clock_us();
  is_spaced = false;
  near_sonar->readings[pinged_sensor()].age = 0;
}

// Continues the current ping. Returns whether it is over, and puts the sample into `*us`.
bool end_ping(uint16_t* us) {
  Sonar* const near_sonar = near(&sonar);
  if (near_sonar->ping == Ping::kTriggered) {
    if (elapsed_us(clock_us(), near_sonar->start_us) < kTriggerUs) return false;
    listen(true);
    lower_trigger();
    near_sonar->ping = Ping::kListening;
    return false;
  }
  EchoState echo_state;
  uint16_t rose_us;
  uint16_t fell_us;
  {
    const CriticalSection critical;
    echo_state = near_sonar->echo_state;
    rose_us = near_sonar->rose_us;
    fell_us = near_sonar->fell_us;
  }
  const uint16_t now_us = clock_us();
  const uint16_t since_ping_us = elapsed_us(now_us, near_sonar->ping_us);
  const uint16_t echo_us = elapsed_us(fell_us, rose_us);
  const uint16_t quiet_us = elapsed_us(now_us, fell_us);
  const bool has_ended = echo_state == EchoState::kEnded;
  if (since_ping_us < kLimitUs && !(has_ended && quiet_us >= kGlitchUs)) return false;
  listen(false);
  near_sonar->ping = Ping::kNone;
  if (has_ended && echo_us < kLimitUs) *us = echo_us;
  return true;
}

void begin(uint8_t number) {
  Sonar* const near_sonar = near(&sonar);
  if (kUltrasonics != 1) near_sonar->last_pinged = number;
  write(ultrasonic_at(number).trigger, true);
  near_sonar->start_us = clock_us();
  near_sonar->ping = Ping::kTriggered;
}

// Notes and returns whether kSpacingUs have passed since the last ping of any sensor.
bool note_spacing() {
  if (elapsed_us(clock_us(), sonar.ping_us) >= kSpacingUs) is_spaced = true;
  return is_spaced;
}

// Goes on with the pings. Returns whether the value of a sensor is fresh, if it has one.
bool measure(uint8_t number) {
  Sonar* const near_sonar = near(&sonar);
  Reading& reading = near_sonar->readings[number];
  uint8_t sensor = number;
  uint16_t us = kLimitUs;
  bool is_awaited = true;
  if (near_sonar->ping != Ping::kNone) {
    sensor = pinged_sensor();
    if (!end_ping(&us)) return sensor != number && reading.age <= kFreshAge;
    is_awaited = !is_spaced && sensor == number;  // an echo found so late was not awaited
  } else {
    if (release(ultrasonic_at(number).echo)) return false;
    // A sensor without an echo holds its line high for longer and ignores triggers meanwhile.
    const bool is_busy = is_high(ultrasonic_at(number).echo.pin);
    if (!is_busy) {
      near_sonar->is_held = false;
      if (note_spacing()) {
        if (reading.age >= kOldAge) reading.sample_us = kNothing;
        begin(number);
        return false;
      }
    }
    if (reading.age <= kFreshAge) return true;
    if (!is_busy) return false;
    if (!near_sonar->is_held) {
      near_sonar->is_held = true;
      near_sonar->start_us = clock_us();
      return false;
    }
    if (elapsed_us(clock_us(), near_sonar->start_us) < kLimitUs) return false;
    near_sonar->is_held = false;
    if (reading.age >= kOldAge) {
      revive(ultrasonic_at(number).echo);
      reading.echo_us = 0;
      reading.sample_us = kNothing;
      return true;
    }
  }
  add_sample(near_sonar->readings[sensor], us);
  return is_awaited;
}

}  // namespace

void ultrasonic_begin() {
  for (uint8_t number = 0; number < kUltrasonics; number++) {
    begin_echo(ultrasonic_at(number).echo, on_change);
  }
}

void ultrasonic_tick() {
  if (!is_spaced) note_spacing();
  Sonar* const near_sonar = near(&sonar);
  const uint8_t passed_ms = (clock_8_ms() - near_sonar->ages_ms) & 0xfe;
  near_sonar->ages_ms = static_cast<uint8_t>(near_sonar->ages_ms + passed_ms);
  for (uint8_t number = 0; number < kUltrasonics; number++) {
    Reading& reading = near_sonar->readings[number];
    const uint8_t age = static_cast<uint8_t>(reading.age + passed_ms / 2);
    reading.age = age < reading.age ? 0xff : age;
  }
}

bool ultrasonic_read(uint8_t number, int32_t* distance) {
  if (kUltrasonics == 1) number = 0;  // which it is, but a compiler cannot know
  if (!measure(number)) return false;
  const Reading& reading = near(&sonar)->readings[number];
  const uint16_t echo_us = reading.echo_us;
  if (echo_us == kNothing || reading.sample_us != kNothing) return false;
  *distance = kFarthest;
  if (echo_us < kFarUs) *distance = uint32_t{echo_us} * kThousandthsPer256Us >> 8;
  return true;
}

void ultrasonic_forget() {
  Sonar* const near_sonar = near(&sonar);
  if (near_sonar->ping == Ping::kTriggered) lower_trigger();
  if (near_sonar->ping == Ping::kListening) listen(false);
  near_sonar->ping = Ping::kNone;
  near_sonar->is_held = false;
  for (uint8_t number = 0; number < kUltrasonics; number++) {
    near_sonar->readings[number].echo_us = near_sonar->readings[number].sample_us = kNothing;
  }
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
