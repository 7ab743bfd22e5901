// Stands for components/log/include/esp_log.h of ESP-IDF.

#ifndef TINISCRIPT_CORE_ESP_LOG_H_
#define TINISCRIPT_CORE_ESP_LOG_H_

typedef enum { ESP_LOG_NONE, ESP_LOG_ERROR, ESP_LOG_WARN } esp_log_level_t;

extern "C" void esp_log_level_set(const char* tag, esp_log_level_t level);

#endif  // TINISCRIPT_CORE_ESP_LOG_H_
