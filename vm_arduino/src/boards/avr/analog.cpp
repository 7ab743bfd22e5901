#ifdef __AVR__

#include "../analog.h"

#include <avr/io.h>

#include "../../vm/build.h"
#include "../../vm/small.h"
#include "../kit.h"

namespace tiniscript {

namespace {

constexpr uint8_t kNoChannel = 0xff;
constexpr uint8_t kFromSupply = 1 << REFS0;  // the highest count is the supply's voltage
constexpr uint8_t kChannels = 8;             // three bits select these; more need a bit elsewhere

// The channel of the chip's own 1.1 V reference. It varies from 1.0 to 1.2 V between chips, so the
// limit of 4.0 V here is really 3.6 to 4.4 V.
#ifdef MUX5
constexpr uint8_t kBandGap = 0x1e;
#else
constexpr uint8_t kBandGap = 0x0e;
#endif
constexpr uint16_t kMaxCount = 281;  // 1024 * 1.1 V / 4.0 V: the supply is too low above it
// The reference has a high resistance, so the converter's capacitor needs 1 to 2 ms to follow. Only
// the last of these conversions (104 us each) is used.
constexpr uint8_t kSupplyTries = 24;

#ifdef tiniscript_has_tasks
constexpr bool kHasOthers = true;
#else
constexpr bool kHasOthers = false;
#endif
#ifdef MUX5
typedef uint16_t Channels;
#else
typedef uint8_t Channels;
#endif

#ifndef tiniscript_analogs
#define tiniscript_analogs 8 * sizeof(Channels)
#endif

struct Converter {
  uint8_t last_channel;   // the channel of the last conversion, or kNoChannel
  uint8_t tries;          // conversions of the reference still to come
  bool is_supply_wanted;  // somebody asked in this turn of the main loop
  // With tasks, values wait for all tasks that ask.
  Channels bit;             // of `last_channel`; 0: it is old
  Channels fresh_channels;  // have been measured
  Channels aging_channels;  // had been at the last tick: they are forgotten at the next
  uint16_t counts[tiniscript_analogs];
};

Converter converter;

void convert() { ADCSRA |= 1 << ADSC; }

bool is_converting() { return (ADCSRA & 1 << ADSC) != 0; }

}  // namespace

void analog_begin() {
  ADCSRA = 1 << ADEN | 1 << ADPS2 | 1 << ADPS1 | 1 << ADPS0;  // 125 kHz
  near(&converter)->last_channel = kNoChannel;
}

bool analog_read(uint8_t channel, int32_t* value) {
  Converter* const near_converter = near(&converter);
  if (kHasOthers) {
    const uint8_t last_channel = near_converter->last_channel;
    if (last_channel < kBandGap && !is_converting()) {
      near_converter->counts[last_channel] = ADC;
      near_converter->fresh_channels |= near_converter->bit;
      near_converter->last_channel = kNoChannel;
    }
    const Channels bit = static_cast<Channels>(1 << channel);
    if ((near_converter->fresh_channels & bit) != 0) {
      *value = near_converter->counts[channel];
      return true;
    }
    if (near_converter->last_channel != kNoChannel) return false;
    near_converter->bit = bit;
  } else {
    if (is_converting() || near_converter->last_channel == kBandGap) return false;
    if (near_converter->last_channel == channel) {
      near_converter->last_channel = kNoChannel;
      *value = ADC;
      return true;
    }
  }
  near_converter->last_channel = channel;
  ADMUX = static_cast<uint8_t>(kFromSupply | (channel % kChannels));
#ifdef MUX5
  ADCSRB = channel >= kChannels ? 1 << MUX5 : 0;
#endif
  convert();
  return false;
}

void analog_forget() {
  Converter* const near_converter = near(&converter);
  if (kHasOthers) {
    near_converter->fresh_channels = near_converter->bit = 0;
  } else {
    near_converter->last_channel = kNoChannel;
  }
}

Supply analog_supply() {
  Converter* const near_converter = near(&converter);
  near_converter->is_supply_wanted = true;
  if (is_converting()) return Supply::kMeasuring;
  if (near_converter->last_channel != kBandGap) {
    near_converter->last_channel = kBandGap;
    near_converter->tries = kSupplyTries;
    ADMUX = kFromSupply | kBandGap;
#ifdef MUX5
    ADCSRB = 0;
#endif
  } else if (--near_converter->tries == 0) {
    near_converter->last_channel = kNoChannel;
    return ADC > kMaxCount ? Supply::kLow : Supply::kEnough;
  }
  convert();
  return Supply::kMeasuring;
}

void analog_tick() {
  Converter* const near_converter = near(&converter);
  if (kHasOthers) {
    const Channels kept_channels = static_cast<Channels>(
        (near_converter->fresh_channels | near_converter->bit) & ~near_converter->aging_channels);
    near_converter->fresh_channels &= kept_channels;
    near_converter->bit &= kept_channels;
    near_converter->aging_channels = kept_channels;
  }
  if (near_converter->last_channel == kBandGap && !near_converter->is_supply_wanted)
    near_converter->last_channel = kNoChannel;
  near_converter->is_supply_wanted = false;
}

}  // namespace tiniscript

#endif  // __AVR__
