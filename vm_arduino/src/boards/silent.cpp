// A robot without a buzzer: a sound takes its time, but is silent.

#include "kit.h"
#include "sound.h"

#ifdef tiniscript_silent

void tiniscript::sound_begin() {}

void tiniscript::sound_start(uint16_t, uint32_t) {}

void tiniscript::sound_finished() {}

void tiniscript::sound_faulted() {}

void tiniscript::sound_off() {}

void tiniscript::sound_tick(uint32_t) {}

#endif
