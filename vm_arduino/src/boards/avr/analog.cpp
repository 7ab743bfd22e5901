#ifdef __AVR__

#include "../analog.h"

#include <avr/io.h>

namespace tiniscript {

namespace {

constexpr uint8_t kNoChannel = 0xff;
constexpr uint8_t kFromSupply = 1 << REFS0;  // the highest count is the supply's voltage
constexpr uint8_t kChannels = 8;             // three bits select these; more need a bit elsewhere

// The channel of the chip's own 1.1 V reference. It varies from 1.0 to 1.2 V between chips, so what
// counts as 4.0 V here is 3.6 to 4.4 V.
#ifdef MUX5
constexpr uint8_t kBandGap = 0x1e;
#else
constexpr uint8_t kBandGap = 0x0e;
#endif
constexpr uint16_t kMostCount = 281;  // 1024 * 1.1 V / 4.0 V: the supply is too low above it
// The reference has a high resistance, so the converter's capacitor needs 1 to 2 ms to follow. Only
// the last of these conversions (104 us each) counts.
constexpr uint8_t kSupplyTries = 24;

uint8_t measured;       // the channel of the last conversion, or kNoChannel
uint8_t tries;          // conversions of the reference still to come
bool is_supply_wanted;  // somebody asked in this turn of the main loop

void convert() { ADCSRA |= 1 << ADSC; }

}  // namespace

void analog_begin() {
  ADCSRA = 1 << ADEN | 1 << ADPS2 | 1 << ADPS1 | 1 << ADPS0;  // 125 kHz
  analog_forget();
}

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

}  // namespace tiniscript

#endif  // __AVR__
