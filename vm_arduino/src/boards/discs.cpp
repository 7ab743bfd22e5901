#include "discs.h"

#include "../vm/build.h"
#include "../vm/small.h"
#include "kit.h"

#ifdef tiniscript_discs

#ifndef tiniscript_has_discs
#error "An Uno or a Nano has room for discs as uno_tinibot2 and nano_tinibot2 of platformio.ini."
#endif

#ifndef __AVR__
#include <driver/pcnt.h>
#endif

namespace tiniscript {

namespace {

constexpr bool kHasTwo = kDiscs.has_two;

#ifdef __AVR__

constexpr uint16_t kGlitchUs = 300;   // no wheel is so fast that two edges are nearer
constexpr uint16_t kOldUs = 30000;    // so that the time since an edge does not wrap around

// The data that the interrupt of a disc records. Two changes that are closer than kGlitchUs were a
// glitch, and neither counts. The interrupt is then off until the next tick: whatever the line
// does, the chip has time for the rest.
struct Counter {
  uint16_t edges;
  uint16_t edge_us;  // when the last change came
  int8_t step;       // its count
  bool is_high;
  bool is_old;       // it was long ago, or a glitch
};

volatile Counter counters[2];

// Returns whether it was a glitch. Call this only while the interrupt is off.
tini_always_inline bool on_change(volatile Counter* counter, Disc disc) {
  const bool is_high_now = is_high(disc.pin);
  cli();
  const uint16_t now_us = clock_us_inside();
  sei();
  if (!counter->is_old && static_cast<uint16_t>(now_us - counter->edge_us) < kGlitchUs) {
    counter->edges = static_cast<uint16_t>(counter->edges - counter->step);
    counter->is_old = true;
    counter->is_high = !counter->is_high;  // which `tick` compares with the line
    return true;
  }
  if (is_high_now == counter->is_high) return true;  // it was over before it was seen
  counter->is_high = is_high_now;
  counter->edge_us = now_us;
  counter->is_old = false;
  counter->step = kHasTwo && is_high(disc.second) == is_high_now ? -1 : 1;
  counter->edges = static_cast<uint16_t>(counter->edges + counter->step);
  return false;
}

tini_always_inline void on_edge(volatile Counter* counter, Disc disc) {
  do {
    if (on_change(counter, disc)) return;
  } while (is_high(disc.pin) != counter->is_high);
  cli();  // until it returns, so that it does not interrupt itself
  register8(kExternal) |= disc.interrupt;
}

// Two interrupts that do not call anything save few registers: each may come in all others.
extern "C" void __vector_left_disc() __attribute__((signal, used, externally_visible));
void __vector_left_disc() { on_edge(counters, kLeftDisc); }

extern "C" void __vector_right_disc() __attribute__((signal, used, externally_visible));
void __vector_right_disc() { on_edge(counters + 1, kRightDisc); }

// Before that it turns itself off and lets the others in, as a stop waits for them: after the
// instruction that follows.
tini_always_inline void interrupt(Disc disc, void (*function)()) {
  asm volatile("sei\n\tcbi %[mask], %[bit]\n\t%~jmp %x[function]" ::[mask] "I"(kExternal - 0x20),
               [bit] "I"(__builtin_ctz(disc.interrupt)), [function] "i"(function));
}

// Turns it on again, and notices the changes since it was off.
tini_always_inline void tick(volatile Counter* counter, Disc disc) {
  const bool is_on = (register8(kExternal) & disc.interrupt) != 0;
  if (is_on && is_high(disc.pin) == counter->is_high) return;
  register8(kExternal) &= static_cast<uint8_t>(~disc.interrupt);
  EIFR = disc.interrupt;
  if (is_high(disc.pin) != counter->is_high) on_change(counter, disc);
  register8(kExternal) |= disc.interrupt;
}

void begin(volatile Counter* counter, Disc disc) {
  begin_pull_up(disc.pin);
  if (is_there(disc.second)) begin_pull_up(disc.second);
  counter->is_old = true;
  counter->is_high = is_high(disc.pin);
  const CriticalSection critical;
  listen_inside({disc.pin, kExternalGroup, disc.interrupt}, true);
}

uint16_t edges_of(volatile Counter* counter) {
  uint16_t edges;
  uint16_t edge_us;
  {
    const CriticalSection critical;
    edges = counter->edges;
    edge_us = counter->edge_us;
  }
  if (static_cast<uint16_t>(clock_us() - edge_us) > kOldUs) {
    const CriticalSection critical;
    if (counter->edge_us == edge_us) counter->is_old = true;
  }
  return edges;
}

#else

constexpr uint16_t kFilter = 1023;  // ticks of 12.5 ns: the longest pulse that the counter ignores
constexpr int16_t kHalf = 16000;    // the counter begins again at 0 where it is full

uint16_t edge_counts[2];

void begin(pcnt_unit_t unit, Disc disc) {
  begin_input(disc.pin);
  pcnt_config_t config = {};
  config.pulse_gpio_num = disc.pin.number;
  config.ctrl_gpio_num = PCNT_PIN_NOT_USED;
  config.unit = unit;
  config.channel = PCNT_CHANNEL_0;
  config.pos_mode = PCNT_COUNT_INC;
  config.neg_mode = PCNT_COUNT_INC;
  config.lctrl_mode = PCNT_MODE_KEEP;
  config.hctrl_mode = PCNT_MODE_KEEP;
  config.counter_h_lim = 32767;
  config.counter_l_lim = -32768;
  if (is_there(disc.second)) {
    begin_input(disc.second);
    config.ctrl_gpio_num = disc.second.number;
    config.neg_mode = PCNT_COUNT_DEC;
    config.hctrl_mode = PCNT_MODE_REVERSE;
  }
  pcnt_unit_config(&config);
  pcnt_set_filter_value(unit, kFilter);
  pcnt_filter_enable(unit);
  pcnt_counter_clear(unit);
  pcnt_counter_resume(unit);
}

#endif

}  // namespace

#ifdef __AVR__

void discs_begin() {
  begin(counters, kLeftDisc);
  begin(counters + 1, kRightDisc);
}

void discs_tick() {
  tick(counters, kLeftDisc);
  tick(counters + 1, kRightDisc);
}

uint16_t board_edges(bool is_right) { return edges_of(counters + is_right); }

#else

void discs_begin() {
  begin(PCNT_UNIT_0, kLeftDisc);
  begin(PCNT_UNIT_1, kRightDisc);
}

void discs_tick() {}

uint16_t board_edges(bool is_right) {
  const pcnt_unit_t unit = is_right ? PCNT_UNIT_1 : PCNT_UNIT_0;
  int16_t count = 0;
  pcnt_get_counter_value(unit, &count);
  uint16_t& total = edge_counts[is_right];
  if (count < kHalf && count > -kHalf) return static_cast<uint16_t>(total + count);
  pcnt_counter_clear(unit);
  total = static_cast<uint16_t>(total + count);
  return total;
}

#endif

Discs board_discs() { return kDiscs; }

}  // namespace tiniscript

#ifdef __AVR__
ISR(tiniscript_disc_left, ISR_NAKED) {
  tiniscript::interrupt(tiniscript::kLeftDisc, tiniscript::__vector_left_disc);
}
ISR(tiniscript_disc_right, ISR_NAKED) {
  tiniscript::interrupt(tiniscript::kRightDisc, tiniscript::__vector_right_disc);
}
#endif

#else

void tiniscript::discs_begin() {}

void tiniscript::discs_tick() {}

#ifdef tiniscript_has_discs

tiniscript::Discs tiniscript::board_discs() { return {0, 0, false}; }

uint16_t tiniscript::board_edges(bool) { return 0; }

#endif

#endif
