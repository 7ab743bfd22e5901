// The analog converter: one call starts a measurement, a later call fetches it.

#pragma once

#include <stdint.h>

#include "../firmware/board.h"

namespace tiniscript {

void analog_begin();

// If the channel has been measured in the last two milliseconds (without tasks: since the last
// call), puts 0 to 1023 into `*value` and returns true: so no task takes another one's value away.
// Otherwise starts the measurement, unless one is under way, and returns false.
bool analog_read(uint8_t channel, int32_t* value);

// Discards the results so far, and the measurement under way.
void analog_forget();

// The same for the supply: an AVR measures its voltage against the chip's band gap. This takes some
// 3 ms, and channels wait meanwhile. Call it in every turn of the main loop: `analog_tick`, called
// once a millisecond, drops a measurement that is not requested, and forgets old values.
Supply analog_supply();
void analog_tick();

// Converts a count: `zero`, plus `step` and `rest` / 1023 (`rest` is 0 to 1022) for each count,
// rounded.
int32_t analog_scaled(int32_t count, int32_t zero, int32_t step, int32_t rest);

// Returns `value` limited to `low` to `high`.
int32_t in_limits(int32_t value, int32_t low, int32_t high);

// Maps a setting in thousandths, from `low` to `high` (whole numbers), to the range from `first` to
// `last`.
uint16_t map_to_range(int32_t value, int32_t low, int32_t high, uint16_t first, uint16_t last);

}  // namespace tiniscript
