// What programs read, noted for a computer that wants to know it.
//
// A reading is noted where it differs from the one before of the same sensor, or is the first of a run.
// None is dropped unnoticed: where there is no room, nothing more is noted of that sensor until all others
// have been told; then its last reading is told, and that some before it were not.

#pragma once

#include <stdint.h>

#include "../vm/build.h"

namespace tiniscript {

// A run begins.
void begin_readings();

extern bool are_readings_noted;

void note_changed(uint8_t sensor, int32_t before, int32_t value);

// A sensor has been read: it had `before` the last time. Returns that it has been.
inline bool note_reading(uint8_t sensor, int32_t before, int32_t value) {
  if (kTellsReadings && are_readings_noted) note_changed(sensor, before, value);
  return true;
}

}  // namespace tiniscript
