#include "sound.h"

#include "kit.h"

namespace tiniscript {

namespace {

constexpr uint32_t kClockHertz = 16000000;
constexpr uint16_t kMostCounts = 512;  // per period: 256 for each half

// Two notes each: rising and high, or falling and low.
constexpr uint16_t kFinishedHertz[] = {1047, 1568};
constexpr uint16_t kFaultHertz[] = {220, 110};
constexpr uint8_t kNoteMs = 120;

bool is_on;
uint16_t next_hertz;  // the next note, or 0
uint32_t end_ms;

// The last count of each half period. They differ by one if the period is odd.
volatile uint8_t first_half;
volatile uint8_t second_half;

// A prescaler of timer 2: divides the clock by 2^`shift`.
struct Divider {
  uint8_t shift;
  uint8_t bits;  // in TCCR2B
};

constexpr Divider kFastest = {3, 2};

// Returns the next slower prescaler: 8, 32, 64, 128, 256, 1024.
Divider slower(Divider divider) {
  const bool is_wide = divider.bits == 2 || divider.bits == 6;
  divider.shift = static_cast<uint8_t>(divider.shift + (is_wide ? 2 : 1));
  divider.bits++;
  return divider;
}

uint16_t counts(uint32_t cycles, uint8_t shift) {
  return static_cast<uint16_t>(((cycles >> (shift - 1)) + 1) >> 1);
}

}  // namespace

void sound_begin() {
  begin_output(kBuzzer, false);
  TCCR2B = 0;
  TCCR2A = 1 << WGM21;  // counts up to OCR2A
}

void sound_start(uint16_t hertz, uint32_t duration_ms, uint32_t now_ms) {
  sound_off();
  if (duration_ms == 0) return;
  const uint32_t cycles = kClockHertz / hertz;
  Divider divider = kFastest;
  while (cycles >> divider.shift >= kMostCounts) divider = slower(divider);
  const uint16_t period = counts(cycles, divider.shift);
  first_half = static_cast<uint8_t>(period / 2 - 1);
  second_half = static_cast<uint8_t>(period - period / 2 - 1);
  TCNT2 = 0;
  OCR2A = first_half;
  TIFR2 = 1 << OCF2A;
  TIMSK2 = 1 << OCIE2A;
  TCCR2B = divider.bits;
  end_ms = now_ms + duration_ms;
  is_on = true;
}

void sound_finished(uint32_t now_ms) {
  sound_start(kFinishedHertz[0], kNoteMs, now_ms);
  next_hertz = kFinishedHertz[1];
}

void sound_faulted(uint32_t now_ms) {
  sound_start(kFaultHertz[0], kNoteMs, now_ms);
  next_hertz = kFaultHertz[1];
}

void sound_off() {
  TIMSK2 = 0;
  TCCR2B = 0;
  write(kBuzzer, false);
  is_on = false;
  next_hertz = 0;
}

void sound_tick(uint32_t now_ms) {
  if (!is_on || static_cast<int32_t>(now_ms - end_ms) < 0) return;
  if (next_hertz != 0) {
    sound_start(next_hertz, kNoteMs, now_ms);
  } else {
    sound_off();
  }
}

}  // namespace tiniscript

ISR(TIMER2_COMPA_vect) {
  using namespace tiniscript;
  toggle(kBuzzer);
  OCR2A = is_high(kBuzzer) ? second_half : first_half;
}
