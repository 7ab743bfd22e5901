#ifdef ARDUINO_ARCH_ESP32

#include "../sound.h"

#include "../kit.h"

#ifndef tiniscript_silent

namespace tiniscript {

namespace {

constexpr uint32_t kRestHertz = 1000;  // the frequency that a silent channel has
// A timer of LEDC divides its clock by 1023 at most: low tones need more bits, high ones fewer.
constexpr uint8_t kToneBits = 10;
constexpr uint8_t kLowBits = 14;  // of an ESP32-C3, at most
constexpr uint16_t kLowHertz = 1000;

// Half of each period is high.
void play(uint16_t hertz) {
  const uint8_t bits = hertz < kLowHertz ? kLowBits : kToneBits;
#if ESP_ARDUINO_VERSION_MAJOR >= 3
  ledcChangeFrequency(kBuzzer.pin.number, hertz, bits);
#else
  ledcSetup(kBuzzer.channel, hertz, bits);
#endif
  write_duty(kBuzzer, 1U << (bits - 1));
}

bool is_on;
uint16_t next_hertz;  // the next note, or 0
uint32_t end_ms;

void start_notes(uint16_t hertz, uint16_t next) {
  sound_start(hertz, kNoteMs);
  next_hertz = next;
}

}  // namespace

void sound_begin() { begin_channel(kBuzzer, kRestHertz, kToneBits); }

void sound_start(uint16_t hertz, uint32_t duration_ms) {
  sound_off();
  if (duration_ms == 0) return;
  play(hertz);
  join(kBuzzer);
  end_ms = clock_ms() + duration_ms;
  is_on = true;
}

void sound_finished() { start_notes(kFinishedHertz[0], kFinishedHertz[1]); }

void sound_faulted() { start_notes(kFaultHertz[0], kFaultHertz[1]); }

void sound_off() {
  if (is_on) write_duty(kBuzzer, 0);
  disconnect(kBuzzer);
  is_on = false;
  next_hertz = 0;
}

void sound_tick(uint32_t now_ms) {
  if (!is_on || static_cast<int32_t>(now_ms - end_ms) < 0) return;
  if (next_hertz == 0) return sound_off();
  start_notes(next_hertz, 0);
}

}  // namespace tiniscript

#endif  // tiniscript_silent

#endif  // ARDUINO_ARCH_ESP32
