// The pulse counter of an ESP32 on a computer: what `core/driver/pcnt.h` declares, by variables.
//
// As chapter "Pulse Count Controller" of Espressif's reference manual has it, and pcnt.c of ESP-IDF
// 4.4: eight units, each with a filter, a counter of 16 bits that begins again at 0 at its limits,
// and a reset that only pcnt_counter_clear ends. What pcnt.c refuses ends the run. Of a unit's two
// channels the first is there.

#ifdef CONFIG_IDF_TARGET_ESP32

#include <driver/pcnt.h>

#include "simulated_chip.h"

namespace {

constexpr uint64_t kInputs = 0xff0efff03f;  // without the pins of the flash
constexpr uint64_t kPulledUp = kInputs & 0x3ffffffff;
constexpr uint64_t kTick = 25;  // of APB_CLK, 80 MHz, in half nanoseconds
constexpr uint16_t kMaxFilter = 1023;

// A line behind its filter, which has a change once it has lasted.
struct Line {
  int pin;
  bool level;
  bool input_level;     // what the pin has
  uint64_t changed_us;  // since then
};

struct Unit {
  bool is_set;
  bool is_in_reset;
  bool has_filter;
  uint16_t filter;
  pcnt_config_t config;
  int32_t count;
  Line pulse;
  Line control;
};

Unit units[PCNT_UNIT_MAX];

bool is_due(const Unit& unit, const Line& line, uint64_t at_us) {
  if (line.input_level == line.level) return false;
  const uint64_t lasts = unit.has_filter ? unit.filter * kTick : 0;
  return (at_us - line.changed_us) * 2000 >= lasts;
}

void count(Unit* unit) {
  unit->pulse.level = unit->pulse.input_level;
  const pcnt_ctrl_mode_t control =
      unit->control.level ? unit->config.hctrl_mode : unit->config.lctrl_mode;
  const pcnt_count_mode_t mode = unit->pulse.level ? unit->config.pos_mode : unit->config.neg_mode;
  if (unit->is_in_reset || mode == PCNT_COUNT_DIS || control == PCNT_MODE_DISABLE) return;
  unit->count += (mode == PCNT_COUNT_INC) == (control == PCNT_MODE_KEEP) ? 1 : -1;
  if (unit->count == unit->config.counter_h_lim || unit->count == unit->config.counter_l_lim) {
    unit->count = 0;
  }
}

// What has come through the filters until now, in the order in which it began.
void settle(Unit* unit) {
  const uint64_t now_us = chip.now_us;
  const bool has_pulse = is_due(*unit, unit->pulse, now_us);
  const bool has_control = is_due(*unit, unit->control, now_us);
  const bool is_first = has_control && unit->control.changed_us <= unit->pulse.changed_us;
  if (is_first) unit->control.level = unit->control.input_level;
  if (has_pulse) count(unit);
  if (has_control) unit->control.level = unit->control.input_level;
}

void change(Line* line, uint8_t pin, bool level) {
  if (line->pin != pin || line->input_level == level) return;
  line->input_level = level;
  line->changed_us = chip.now_us;
}

void on_input(uint8_t pin, bool level) {
  for (Unit& unit : units) {
    settle(&unit);
    change(&unit.pulse, pin, level);
    change(&unit.control, pin, level);
    settle(&unit);
  }
}

Line line_of(int pin) {
  if (pin < 0) return {pin, false, false, 0};
  SimulatedPin& simulated_pin = chip.pins[pin];
  simulated_pin.is_output = false;
  if ((kPulledUp >> pin & 1) != 0) {
    if (!simulated_pin.has_pull_up) simulated_pin.input = true;
    simulated_pin.has_pull_up = true;
  }
  return {pin, simulated_pin.input, simulated_pin.input, chip.now_us};
}

bool can_read(int pin) { return pin < 0 || (pin < 40 && (kInputs >> pin & 1) != 0); }

Unit* unit_of(pcnt_unit_t unit) {
  expect(unit < PCNT_UNIT_MAX, "a unit of the pulse counter that is not there");
  expect(units[unit].is_set, "a unit of the pulse counter that is not configured");
  settle(units + unit);
  return units + unit;
}

}  // namespace

extern "C" {

esp_err_t pcnt_unit_config(const pcnt_config_t* pcnt_config) {
  const pcnt_config_t& config = *pcnt_config;
  expect_free("the pulse counter configured in a critical section");
  expect(config.unit < PCNT_UNIT_MAX, "a unit of the pulse counter that is not there");
  expect(config.channel == PCNT_CHANNEL_0, "a channel that this stand-in does not have");
  expect(can_read(config.pulse_gpio_num), "a pulse on a pin that is not there");
  expect(can_read(config.ctrl_gpio_num), "a control signal on a pin that is not there");
  expect(config.pulse_gpio_num < 0 || config.pulse_gpio_num != config.ctrl_gpio_num,
         "one pin for both");
  expect(config.pos_mode < PCNT_COUNT_MAX && config.neg_mode < PCNT_COUNT_MAX, "a way to count");
  expect(config.hctrl_mode < PCNT_MODE_MAX && config.lctrl_mode < PCNT_MODE_MAX,
         "a way to control");
  expect(config.counter_h_lim >= 0 && config.counter_l_lim <= 0, "limits of the pulse counter");
  chip.on_input = on_input;
  const Line pulse = line_of(config.pulse_gpio_num);
  const Line control = line_of(config.ctrl_gpio_num);
  units[config.unit] = {true, true, false, units[config.unit].filter, config, 0, pulse, control};
  return ESP_OK;
}

esp_err_t pcnt_get_counter_value(pcnt_unit_t pcnt_unit, int16_t* value) {
  *value = static_cast<int16_t>(unit_of(pcnt_unit)->count);
  return ESP_OK;
}

esp_err_t pcnt_counter_clear(pcnt_unit_t pcnt_unit) {
  Unit* const unit = unit_of(pcnt_unit);
  unit->is_in_reset = false;
  unit->count = 0;
  return ESP_OK;
}

esp_err_t pcnt_counter_resume(pcnt_unit_t pcnt_unit) {
  unit_of(pcnt_unit);  // nobody has paused it
  return ESP_OK;
}

esp_err_t pcnt_set_filter_value(pcnt_unit_t unit, uint16_t filter_val) {
  expect(filter_val <= kMaxFilter, "a longer filter than the pulse counter has");
  unit_of(unit)->filter = filter_val;
  return ESP_OK;
}

esp_err_t pcnt_filter_enable(pcnt_unit_t unit) {
  unit_of(unit)->has_filter = true;
  return ESP_OK;
}

}  // extern "C"

#endif  // CONFIG_IDF_TARGET_ESP32
