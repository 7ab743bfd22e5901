// Tasks that go on in the chip's time, one after the other: each run repeats. All are on one thread
// of this computer: to let threads take turns takes eight times as long.

#include <freertos/task.h>
#include <sanitizer/common_interface_defs.h>
#include <stdlib.h>
#include <ucontext.h>

#include <memory>
#include <vector>

#include "simulated_chip.h"
#include "simulated_tasks.h"

namespace {

constexpr uint32_t kLongestMs = 10000;       // that a task calculates without a pause
constexpr size_t kStackBytes = 1024 * 1024;  // of this computer, with what its sanitizers add

struct Task {
  TaskFunction_t code;
  void* parameters;
  uint64_t due_us;
  std::unique_ptr<char[]> memory;
  ucontext_t context;
  const void* stack;  // which the sanitizers are told of
  size_t stack_bytes;
  void* fake_stack;
};

std::vector<std::unique_ptr<Task>> tasks;
Task main_loop;
Task* current = &main_loop;
Task* previous;

// After a switch, in the task that goes on.
void arrive() {
  __sanitizer_finish_switch_fiber(current->fake_stack, &previous->stack, &previous->stack_bytes);
}

void switch_to(Task* task) {
  previous = current;
  current = task;
  __sanitizer_start_switch_fiber(&previous->fake_stack, task->stack, task->stack_bytes);
  swapcontext(&previous->context, &task->context);
  arrive();
}

void run_task() {
  arrive();
  current->code(current->parameters);
  abort();  // a task of FreeRTOS does not return
}

uint64_t next_us() {
  uint64_t next = ~uint64_t{0};
  for (const auto& task : tasks) {
    if (task->due_us < next) next = task->due_us;
  }
  return next;
}

void run_due_tasks() {
  for (size_t k = 0; k < tasks.size(); k++) {
    if (tasks[k]->due_us <= chip.now_us) switch_to(tasks[k].get());
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
  std::unique_ptr<Task> task(new Task());
  task->code = pvTaskCode;
  task->parameters = pvParameters;
  task->due_us = chip.now_us + 1000;
  task->memory.reset(new char[kStackBytes]);
  task->stack = task->memory.get();
  task->stack_bytes = kStackBytes;
  getcontext(&task->context);
  task->context.uc_stack.ss_sp = task->memory.get();
  task->context.uc_stack.ss_size = kStackBytes;
  makecontext(&task->context, run_task, 0);
  task->context.uc_stack.ss_size = 0;  // else ASan clears its shadow at each switch
  tasks.push_back(std::move(task));
  next_task_us = next_us;
  run_tasks = run_due_tasks;
  return 1;
}

void vTaskDelay(const TickType_t xTicksToDelay) {
  expect_free("vTaskDelay in a critical section");
  if (current == &main_loop) {
    chip.sleep_count++;
    chip.slept_us += xTicksToDelay * 1000;
    return advance_us(uint64_t{xTicksToDelay} * 1000);
  }
  current->due_us = chip.now_us + uint64_t{xTicksToDelay} * 1000;
  switch_to(&main_loop);
}

}  // extern "C"
