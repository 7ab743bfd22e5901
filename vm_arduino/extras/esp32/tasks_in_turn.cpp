// Tasks that go on in the chip's time, one after the other: each run repeats.

#include <freertos/task.h>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "simulated_chip.h"
#include "simulated_tasks.h"

namespace {

struct Task {
  TaskFunction_t code;
  void* parameters;
  uint64_t due_us;
};

constexpr uint32_t kLongestMs = 10000;  // that a task calculates without a pause

std::vector<std::unique_ptr<Task>> tasks;
std::mutex turn;
std::condition_variable changed;
Task* active;  // nullptr: the main loop
thread_local Task* own;

void wait_for(Task* task, std::unique_lock<std::mutex>* lock) {
  changed.wait(*lock, [task] { return active == task; });
}

void live(Task* task) {
  std::unique_lock<std::mutex> lock(turn);
  own = task;
  wait_for(task, &lock);
  lock.unlock();
  task->code(task->parameters);
}

uint64_t next_us() {
  uint64_t next = ~uint64_t{0};
  for (const auto& task : tasks) {
    if (task->due_us < next) next = task->due_us;
  }
  return next;
}

void run_due() {
  for (size_t k = 0; k < tasks.size(); k++) {
    Task* const task = tasks[k].get();
    if (task->due_us > chip.now_us) continue;
    std::unique_lock<std::mutex> lock(turn);
    active = task;
    changed.notify_all();
    wait_for(nullptr, &lock);
  }
}

}  // namespace

extern "C" {

BaseType_t xTaskCreatePinnedToCore(TaskFunction_t pvTaskCode, const char* const, const uint32_t,
                                   void* const pvParameters, UBaseType_t, TaskHandle_t* const,
                                   const BaseType_t xCoreID) {
  expect(xCoreID < portNUM_PROCESSORS, "a task on a core that the chip does not have");
  if (chip.is_heap_full) return 0;
  expect(!chip.watches_idle || chip.restart_ms == 0 || chip.restart_ms >= kLongestMs,
         "a task that calculates for long beside an idle task that is watched");
  tasks.emplace_back(new Task{pvTaskCode, pvParameters, chip.now_us + 1000});
  std::thread(live, tasks.back().get()).detach();
  next_task_us = next_us;
  run_tasks = run_due;
  return 1;
}

void vTaskDelay(const TickType_t xTicksToDelay) {
  expect_free("vTaskDelay in a critical section");
  if (own == nullptr) {  // the main loop
    chip.rests++;
    chip.slept_us += xTicksToDelay * 1000;
    return pass_us(uint64_t{xTicksToDelay} * 1000);
  }
  std::unique_lock<std::mutex> lock(turn);
  own->due_us = chip.now_us + uint64_t{xTicksToDelay} * 1000;
  active = nullptr;
  changed.notify_all();
  wait_for(own, &lock);
}

}  // extern "C"
