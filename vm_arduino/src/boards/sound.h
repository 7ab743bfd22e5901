// The buzzer: timer 2 toggles its pin, and what is due is done by `sound_tick`.

#ifndef TINISCRIPT_BOARDS_SOUND_H_
#define TINISCRIPT_BOARDS_SOUND_H_

#include <stdint.h>

namespace tiniscript {

void sound_begin();

// A sound of 31 to 20000 hertz, which `sound_tick` ends; one of 0 ms is none.
void sound_start(uint16_t hertz, uint32_t duration_ms, uint32_t now_ms);

// The tune that says that a program has ended, and the one that says that a fault has ended it.
void sound_finished(uint32_t now_ms);
void sound_faulted(uint32_t now_ms);

void sound_off();

void sound_tick(uint32_t now_ms);

}  // namespace tiniscript

#endif  // TINISCRIPT_BOARDS_SOUND_H_
