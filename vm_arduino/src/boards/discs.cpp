#include "discs.h"

#include "../vm/has_tasks.h"
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

// What the interrupt of a disc notes. Two changes that are nearer than kGlitchUs were a glitch, and
// neither counts.
struct Counter {
  uint16_t edges;
  uint16_t edge_us;    // when the last change came that is not known to be a glitch,
  uint16_t before_us;  // and the one before
  int8_t step;         // what the last one counted
  bool is_high;
  bool is_old;         // the last one was long ago
};

volatile Counter counters[2];

tini_always_inline void on_change(volatile Counter* it, Disc disc) {
  const bool is_now = is_high(disc.pin);
  if (is_now == it->is_high) return;  // it was over before it was seen
  it->is_high = is_now;
  const uint16_t now_us = clock_us();
  if (!it->is_old && static_cast<uint16_t>(now_us - it->edge_us) < kGlitchUs) {
    it->edges = static_cast<uint16_t>(it->edges - it->step);
    it->edge_us = it->before_us;
    it->step = 0;
    return;
  }
  it->before_us = it->edge_us;
  it->edge_us = now_us;
  it->is_old = false;
  it->step = kHasTwo && is_high(disc.second) == is_now ? -1 : 1;
  it->edges = static_cast<uint16_t>(it->edges + it->step);
}

void on_left() { on_change(counters, kLeftDisc); }

void on_right() { on_change(counters + 1, kRightDisc); }

void begin(volatile Counter* it, Disc disc) {
  begin_pull_up(disc.pin);
  if (is_there(disc.second)) begin_pull_up(disc.second);
  it->is_old = true;
  it->is_high = is_high(disc.pin);
  const CriticalSection critical;
  listen_inside({disc.pin, kExternalGroup, disc.interrupt}, true);
}

uint16_t edges_of(volatile Counter* it) {
  const CriticalSection critical;
  if (static_cast<uint16_t>(clock_us() - it->edge_us) > kOldUs) it->is_old = true;
  return it->edges;
}

#else

constexpr uint16_t kFilter = 1023;  // ticks of 12.5 ns: the longest pulse that the counter ignores
constexpr int16_t kHalf = 16000;    // the counter begins again at 0 where it is full

uint16_t counted[2];

void begin(pcnt_unit_t unit, Disc disc) {
  begin_input(disc.pin);
  pcnt_config_t how = {};
  how.pulse_gpio_num = disc.pin.number;
  how.ctrl_gpio_num = PCNT_PIN_NOT_USED;
  how.unit = unit;
  how.channel = PCNT_CHANNEL_0;
  how.pos_mode = PCNT_COUNT_INC;
  how.neg_mode = PCNT_COUNT_INC;
  how.lctrl_mode = PCNT_MODE_KEEP;
  how.hctrl_mode = PCNT_MODE_KEEP;
  how.counter_h_lim = 32767;
  how.counter_l_lim = -32768;
  if (is_there(disc.second)) {
    begin_input(disc.second);
    how.ctrl_gpio_num = disc.second.number;
    how.neg_mode = PCNT_COUNT_DEC;
    how.hctrl_mode = PCNT_MODE_REVERSE;
  }
  pcnt_unit_config(&how);
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

uint16_t board_edges(bool is_right) { return edges_of(counters + is_right); }

#else

void discs_begin() {
  begin(PCNT_UNIT_0, kLeftDisc);
  begin(PCNT_UNIT_1, kRightDisc);
}

uint16_t board_edges(bool is_right) {
  const pcnt_unit_t unit = is_right ? PCNT_UNIT_1 : PCNT_UNIT_0;
  int16_t found = 0;
  pcnt_get_counter_value(unit, &found);
  uint16_t& before = counted[is_right];
  if (found < kHalf && found > -kHalf) return static_cast<uint16_t>(before + found);
  pcnt_counter_clear(unit);
  before = static_cast<uint16_t>(before + found);
  return before;
}

#endif

Discs board_discs() { return kDiscs; }

}  // namespace tiniscript

#ifdef __AVR__
tiniscript_interrupt(tiniscript_disc_left, tiniscript::on_left)
tiniscript_interrupt(tiniscript_disc_right, tiniscript::on_right)
#endif

#else

void tiniscript::discs_begin() {}

#ifdef tiniscript_has_discs

tiniscript::Discs tiniscript::board_discs() { return {0, 0, false}; }

uint16_t tiniscript::board_edges(bool) { return 0; }

#endif

#endif
