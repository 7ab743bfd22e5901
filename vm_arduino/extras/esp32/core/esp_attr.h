// Stands for components/esp_common/include/esp_attr.h of ESP-IDF: where things lie.

#pragma once

#define IRAM_ATTR
#define RTC_NOINIT_ATTR __attribute__((section("rtc_noinit")))
