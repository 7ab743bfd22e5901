#include "analog.h"

#include <avr/io.h>

#include "../vm/number.h"

namespace tiniscript {

namespace {

constexpr uint8_t kNoChannel = 0xff;
constexpr uint8_t kFromSupply = 1 << REFS0;  // the highest count is the supply's voltage
constexpr uint8_t kChannels = 8;             // with a number of three bits; more have a bit apart

// The chip's own voltage of 1.1 V, as a channel. Between chips it is 1.0 to 1.2 V: what counts as
// 4.0 V here is 3.6 to 4.4 V.
#ifdef MUX5
constexpr uint8_t kBandGap = 0x1e;
#else
constexpr uint8_t kBandGap = 0x0e;
#endif
constexpr uint16_t kMostCount = 281;  // 1024 times 1.1 V by 4.0 V: with more the supply is too low
// It has a high resistance, and the converter's capacitor takes a millisecond or two to follow. The
// last of so many conversions of 104 us counts.
constexpr uint8_t kSupplyTries = 24;

uint8_t measured = kNoChannel;
uint8_t tries;          // conversions of the band gap that are still to come
bool is_supply_wanted;  // in this turn of the main loop

void convert() { ADCSRA |= 1 << ADSC; }

}  // namespace

bool analog_read(uint8_t channel, int32_t* value) {
  if ((ADCSRA & 1 << ADSC) != 0 || measured == kBandGap) return false;
  if (measured != channel) {
    measured = channel;
    ADMUX = static_cast<uint8_t>(kFromSupply | (channel % kChannels));
#ifdef MUX5
    ADCSRB = channel >= kChannels ? 1 << MUX5 : 0;
#endif
    convert();
    return false;
  }
  measured = kNoChannel;
  *value = ADC;
  return true;
}

void analog_forget() { measured = kNoChannel; }

Supply analog_supply() {
  is_supply_wanted = true;
  if ((ADCSRA & 1 << ADSC) != 0) return Supply::kMeasuring;
  if (measured != kBandGap) {
    measured = kBandGap;
    tries = kSupplyTries;
    ADMUX = kFromSupply | kBandGap;
#ifdef MUX5
    ADCSRB = 0;
#endif
  } else if (--tries == 0) {
    measured = kNoChannel;
    return ADC > kMostCount ? Supply::kLow : Supply::kEnough;
  }
  convert();
  return Supply::kMeasuring;
}

void analog_tick() {
  if (measured == kBandGap && !is_supply_wanted) measured = kNoChannel;
  is_supply_wanted = false;
}

int32_t analog_scaled(int32_t count, int32_t zero, int32_t step, int32_t rest) {
  const uint32_t parts = static_cast<uint32_t>(count * rest) + 511;
  // That is divided by 1023, exactly up to 2^20.
  return zero + count * step + static_cast<int32_t>((parts + (parts >> 10) + 1) >> 10);
}

int32_t in_limits(int32_t value, int32_t low, int32_t high) {
  return value < low ? low : value > high ? high : value;
}

uint16_t part_of_range(int32_t value, int32_t low, int32_t high, uint16_t first, uint16_t last) {
  const int32_t at = in_limits(whole(value), low, high) - low;
  // Ranges of more than 2^15 are as exact as they need to be without their last bits.
  uint32_t range = static_cast<uint32_t>(high - low);
  uint32_t gone = static_cast<uint32_t>(at);
  while (range > 0x7fff) {
    range >>= 1;
    gone >>= 1;
  }
  const bool is_falling = last < first;
  const uint16_t way = static_cast<uint16_t>(is_falling ? first - last : last - first);
  const uint16_t part = static_cast<uint16_t>((gone * way + range / 2) / range);
  return static_cast<uint16_t>(is_falling ? first - part : first + part);
}

}  // namespace tiniscript
