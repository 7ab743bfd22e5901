// The buzzer: a timer (timer 2, or a channel of LEDC) makes the tone, `sound_tick` ends it.

#pragma once

#include <stdint.h>

namespace tiniscript {

// Two notes each: rising and high, or falling and low.
constexpr uint16_t kFinishedHertz[] = {1047, 1568};
constexpr uint16_t kFaultHertz[] = {220, 110};
constexpr uint8_t kNoteMs = 120;

void sound_begin();

// Starts a sound of 31 to 20000 hertz, which `sound_tick` ends. 0 ms means no sound.
void sound_start(uint16_t hertz, uint32_t duration_ms);

// The tune for the end of a program, and the one for a fault.
void sound_finished();
void sound_faulted();

void sound_off();

void sound_tick(uint32_t now_ms);

}  // namespace tiniscript
