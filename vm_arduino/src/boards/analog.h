// The analog converter: a measurement is begun, and fetched when it is there.

#ifndef TINISCRIPT_BOARDS_ANALOG_H_
#define TINISCRIPT_BOARDS_ANALOG_H_

#include <stdint.h>

#include "../firmware/board.h"

namespace tiniscript {

// Puts 0 to 1023 into `*value` and returns true where a channel has been measured since the last
// time; else begins that, if it is not under way, and returns false.
bool analog_read(uint8_t channel, int32_t* value);

// A measurement that is under way is nobody's any more.
void analog_forget();

// The same for the supply: its voltage against the band gap of the chip. It takes some 3 ms, and a
// channel waits for so long. To be asked in every turn of the main loop; `analog_tick`, once in
// each, gives up a measurement that was not.
Supply analog_supply();
void analog_tick();

// What a count means: `zero`, and for each count `step` and so many parts of 1023 that `rest` is
// (0 to 1022), rounded.
int32_t analog_scaled(int32_t count, int32_t zero, int32_t step, int32_t rest);

// The value nearest to `value` from `low` to `high`.
int32_t in_limits(int32_t value, int32_t low, int32_t high);

// A setting of `low` to `high` (whole numbers) in thousandths, as a part of the way from `first` to
// `last`.
uint16_t part_of_range(int32_t value, int32_t low, int32_t high, uint16_t first, uint16_t last);

}  // namespace tiniscript

#endif  // TINISCRIPT_BOARDS_ANALOG_H_
