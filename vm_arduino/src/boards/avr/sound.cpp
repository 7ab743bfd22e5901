#ifdef __AVR__

#include "../sound.h"

#include "../../vm/small.h"
#include "clock.h"
#include "../kit.h"

#ifndef tiniscript_silent

namespace tiniscript {

namespace {

constexpr uint32_t kFastestHertz = 2000000;  // the timer's clock with the fastest prescaler
constexpr uint16_t kMaxCounts = 512;        // per period: 256 for each half

struct Sound {
  bool is_on;
  uint16_t next_hertz;  // the next note, or 0
  uint32_t end_ms;
};

Sound sound;

// The last count of each half period. They differ by one if the period is odd.
volatile uint8_t first_half;
volatile uint8_t second_half;

// Prescalers of timer 2, in TCCR2B: they divide the clock by 8, 32, 64, 128, 256, 1024.
constexpr uint8_t kFastest = 2;

tini_noinline void start_notes(uint16_t hertz, uint16_t next) {
  sound_start(hertz, kNoteMs);
  sound.next_hertz = next;
}

uint16_t half(uint16_t counts) { return static_cast<uint16_t>((counts + 1) >> 1); }

}  // namespace

void sound_begin() {
  begin_output(kBuzzer, false);
  TCCR2B = 0;
  TCCR2A = 1 << WGM21;  // counts up to OCR2A
}

void sound_start(uint16_t hertz, uint32_t duration_ms) {
  sound_off();
  if (duration_ms == 0) return;
  uint16_t period = static_cast<uint16_t>((kFastestHertz + hertz / 2) / hertz);
  uint8_t prescaler = kFastest;
  while (period >= kMaxCounts) {
    period = half(period);
    if (prescaler == 2 || prescaler == 6) period = half(period);  // four times as slow
    prescaler++;
  }
  first_half = static_cast<uint8_t>(period / 2 - 1);
  second_half = static_cast<uint8_t>(period - period / 2 - 1);
  TCNT2 = 0;
  OCR2A = first_half;
  TIFR2 = 1 << OCF2A;
  TIMSK2 = 1 << OCIE2A;
  TCCR2B = prescaler;
  Sound* const near_sound = near(&sound);
  near_sound->end_ms = clock_ms() + duration_ms;
  near_sound->is_on = true;
}

void sound_finished() { start_notes(kFinishedHertz[0], kFinishedHertz[1]); }

void sound_faulted() { start_notes(kFaultHertz[0], kFaultHertz[1]); }

void sound_off() {
  TIMSK2 = 0;
  TCCR2B = 0;
  write(kBuzzer, false);
  sound.is_on = false;
  sound.next_hertz = 0;
}

void sound_tick(uint32_t now_ms) {
  const Sound* const near_sound = near(&sound);
  if (!near_sound->is_on || static_cast<int32_t>(now_ms - near_sound->end_ms) < 0) return;
  if (near_sound->next_hertz == 0) return sound_off();
  start_notes(near_sound->next_hertz, 0);
}

}  // namespace tiniscript

// In assembly, because a stop waits for it: it changes no flag, so others may come in at once.
ISR(TIMER2_COMPA_vect, ISR_NAKED) {
  using namespace tiniscript;
  asm volatile(
      "sei\n\tpush r24\n\t"
      "ldi r24, %[mask]\n\tsts %[port] - 2, r24\n\t"  // toggles the pin
      "lds r24, %[port]\n\tsbrs r24, %[bit]\n\trjmp 1f\n\t"
      "lds r24, %[second]\n\trjmp 2f\n"
      "1: lds r24, %[first]\n"
      "2: sts %[compare], r24\n\tpop r24\n\treti"
      :
      : [mask] "M"(0 + kBuzzer.mask), [port] "n"(0 + kBuzzer.port),
        [bit] "I"(__builtin_ctz(kBuzzer.mask)), [first] "i"(&first_half),
        [second] "i"(&second_half), [compare] "n"(_SFR_MEM_ADDR(OCR2A)));
}

#endif  // tiniscript_silent

#endif  // __AVR__
