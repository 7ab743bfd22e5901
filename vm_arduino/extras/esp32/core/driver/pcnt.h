// Stands for the pulse counter of Espressif's IDF 4.4, as far as the discs use it.

#ifndef TINISCRIPT_STAND_IN_PCNT_H_
#define TINISCRIPT_STAND_IN_PCNT_H_

#include <esp_err.h>
#include <stdint.h>

#define PCNT_PIN_NOT_USED (-1)

typedef enum { PCNT_UNIT_0, PCNT_UNIT_1 } pcnt_unit_t;
typedef enum { PCNT_CHANNEL_0 } pcnt_channel_t;
typedef enum { PCNT_COUNT_DIS, PCNT_COUNT_INC, PCNT_COUNT_DEC } pcnt_count_mode_t;
typedef enum { PCNT_MODE_KEEP, PCNT_MODE_REVERSE, PCNT_MODE_DISABLE } pcnt_ctrl_mode_t;

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

esp_err_t pcnt_unit_config(const pcnt_config_t* pcnt_config);
esp_err_t pcnt_get_counter_value(pcnt_unit_t pcnt_unit, int16_t* count);
esp_err_t pcnt_counter_clear(pcnt_unit_t pcnt_unit);
esp_err_t pcnt_counter_resume(pcnt_unit_t pcnt_unit);
esp_err_t pcnt_set_filter_value(pcnt_unit_t unit, uint16_t filter_val);
esp_err_t pcnt_filter_enable(pcnt_unit_t unit);

#endif  // TINISCRIPT_STAND_IN_PCNT_H_
