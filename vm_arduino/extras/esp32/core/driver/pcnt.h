// Stands for components/driver/include/driver/pcnt.h of ESP-IDF 4.4, as far as the discs use it; 5.1
// has the same in components/driver/deprecated, and warns of it. An ESP32-C3 has no pulse counter.

#pragma once

#ifndef CONFIG_IDF_TARGET_ESP32
#error "This chip has no pulse counter."
#endif

#include <stdint.h>

#include "../esp_err.h"

#define PCNT_PIN_NOT_USED (-1)

typedef enum { PCNT_UNIT_0, PCNT_UNIT_1, PCNT_UNIT_MAX = 8 } pcnt_unit_t;
typedef enum { PCNT_CHANNEL_0, PCNT_CHANNEL_1, PCNT_CHANNEL_MAX } pcnt_channel_t;
typedef enum { PCNT_COUNT_DIS, PCNT_COUNT_INC, PCNT_COUNT_DEC, PCNT_COUNT_MAX } pcnt_count_mode_t;
typedef enum { PCNT_MODE_KEEP, PCNT_MODE_REVERSE, PCNT_MODE_DISABLE, PCNT_MODE_MAX } pcnt_ctrl_mode_t;

typedef struct {
  int pulse_gpio_num;
  int ctrl_gpio_num;
  pcnt_ctrl_mode_t lctrl_mode;
  pcnt_ctrl_mode_t hctrl_mode;
  pcnt_count_mode_t pos_mode;
  pcnt_count_mode_t neg_mode;
  int16_t counter_h_lim;
  int16_t counter_l_lim;
  pcnt_unit_t unit;
  pcnt_channel_t channel;
} pcnt_config_t;

extern "C" {
esp_err_t pcnt_unit_config(const pcnt_config_t* pcnt_config);
esp_err_t pcnt_get_counter_value(pcnt_unit_t pcnt_unit, int16_t* count);
esp_err_t pcnt_counter_clear(pcnt_unit_t pcnt_unit);
esp_err_t pcnt_counter_resume(pcnt_unit_t pcnt_unit);
esp_err_t pcnt_set_filter_value(pcnt_unit_t unit, uint16_t filter_val);
esp_err_t pcnt_filter_enable(pcnt_unit_t unit);
}
