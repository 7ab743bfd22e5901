// Stands for components/freertos/include/freertos/task.h of ESP-IDF.

#pragma once

#include <freertos/FreeRTOS.h>

typedef int BaseType_t;
typedef unsigned int UBaseType_t;
typedef uint32_t TickType_t;
typedef void (*TaskFunction_t)(void*);
typedef void* TaskHandle_t;

#define pdPASS 1

extern "C" {
BaseType_t xTaskCreatePinnedToCore(TaskFunction_t pvTaskCode, const char* const pcName,
                                   const uint32_t usStackDepth, void* const pvParameters,
                                   UBaseType_t uxPriority, TaskHandle_t* const pvCreatedTask,
                                   const BaseType_t xCoreID);
TaskHandle_t xTaskGetIdleTaskHandleForCPU(UBaseType_t cpuid);
void vTaskDelay(const TickType_t xTicksToDelay);
}
