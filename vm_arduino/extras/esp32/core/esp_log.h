// Stands for components/log/include/esp_log.h of ESP-IDF.

#pragma once

typedef enum { ESP_LOG_NONE, ESP_LOG_ERROR, ESP_LOG_WARN } esp_log_level_t;

extern "C" void esp_log_level_set(const char* tag, esp_log_level_t level);
