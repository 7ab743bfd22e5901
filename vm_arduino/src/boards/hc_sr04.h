// An HC-SR04: how far away something is, without waiting for the echo.

#ifndef TINISCRIPT_BOARDS_HC_SR04_H_
#define TINISCRIPT_BOARDS_HC_SR04_H_

#include <stdint.h>

namespace tiniscript {

void hc_sr04_begin(uint8_t trigger_pin, uint8_t echo_pin);

// Puts thousandths of a centimetre into `*distance` and returns true where there is an echo, or
// none in time: then it is 400 cm, the end of its range. Otherwise false: ask again.
bool hc_sr04_read(int32_t* distance);

}  // namespace tiniscript

#endif  // TINISCRIPT_BOARDS_HC_SR04_H_
