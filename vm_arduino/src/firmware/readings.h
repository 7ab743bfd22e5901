// Records the readings of programs for a computer that wants them.
//
// A reading is noted where it differs from the one before of the same sensor, or is the first of a
// run. No reading is dropped unnoticed: if there is no room, that sensor records no more until all
// others have been reported; then its last reading is reported, and that some before it were not.

#pragma once

#include <stdint.h>

#include "../vm/build.h"

namespace tiniscript {

// A run begins.
void begin_readings();

extern bool are_readings_noted;

void note_changed(uint8_t sensor, int32_t previous_value, int32_t value);

// A sensor has been read: it had `previous_value` the last time. Returns that it has been.
inline bool note_reading(uint8_t sensor, int32_t previous_value, int32_t value) {
  if (kTellsReadings && are_readings_noted) note_changed(sensor, previous_value, value);
  return true;
}

}  // namespace tiniscript
