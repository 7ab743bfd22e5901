// Stands for components/esp_common/include/esp_attr.h of ESP-IDF: where things lie.

#ifndef TINISCRIPT_CORE_ESP_ATTR_H_
#define TINISCRIPT_CORE_ESP_ATTR_H_

#define IRAM_ATTR
#define RTC_NOINIT_ATTR __attribute__((section("rtc_noinit")))

#endif  // TINISCRIPT_CORE_ESP_ATTR_H_
