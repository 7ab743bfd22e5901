// Tasks that go on whenever this computer lets them, beside the main loop: for the race checker.

#include <freertos/task.h>

#include <chrono>
#include <thread>

#include "simulated_chip.h"

extern "C" {

BaseType_t xTaskCreatePinnedToCore(TaskFunction_t pvTaskCode, const char* const, const uint32_t,
                                   void* const pvParameters, UBaseType_t, TaskHandle_t* const,
                                   const BaseType_t xCoreID) {
  expect(xCoreID < portNUM_PROCESSORS, "a task on a core that the chip does not have");
  std::thread(pvTaskCode, pvParameters).detach();
  return 1;
}

void vTaskDelay(const TickType_t) { std::this_thread::sleep_for(std::chrono::microseconds(50)); }

}  // extern "C"
