#ifdef ARDUINO_ARCH_ESP32

#include "../analog.h"

#include <Arduino.h>

namespace tiniscript {

namespace {

constexpr uint8_t kBits = 10;  // 0 to 1023, as on an AVR

}  // namespace

void analog_begin() { analogReadResolution(kBits); }

// A conversion takes some 40 us: no reason to come back for it. The channel is the pin's number.
bool analog_read(uint8_t channel, int32_t* value) {
  *value = analogRead(channel);
  return true;
}

void analog_forget() {}

// The brown-out detector restarts the chip before its flash is written wrongly, and an interrupted
// write of NVS leaves the old content.
Supply analog_supply() { return Supply::kEnough; }

void analog_tick() {}

}  // namespace tiniscript

#endif  // ARDUINO_ARCH_ESP32
