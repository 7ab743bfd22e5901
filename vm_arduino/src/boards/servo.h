// Servos: a pulse for each, 50 times a second. On an AVR timer 1 makes them one after the other, on
// an ESP32 a channel of LEDC makes those of each.

#pragma once

#include <stdint.h>

namespace tiniscript {

// A servo gets no pulse until it is set.
void servo_begin();

// Sets a servo's pulse in microseconds, for `frames` pulses or without end if `frames` is 0. May be
// called from an interrupt.
void servo_set(uint8_t number, uint16_t pulse_us, uint8_t frames);

#ifdef __AVR__
// Ends all pulses, also the one under way. For an interrupt after which no other one runs.
void servos_low();

// The interrupt counts pulses.
inline void servo_tick(uint32_t) {}
#else
// Ends the pulses of servos that have had theirs. Call it at least every 20 ms.
void servo_tick(uint32_t now_ms);
#endif

// Whether a servo gets pulses endlessly.
bool servo_is_held(uint8_t number);

}  // namespace tiniscript
