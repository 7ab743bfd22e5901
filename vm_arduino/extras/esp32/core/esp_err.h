// Stands for components/esp_common/include/esp_err.h of ESP-IDF.

#pragma once

typedef int esp_err_t;

#define ESP_OK 0
#define ESP_FAIL -1
#define ESP_ERR_INVALID_STATE 0x103
