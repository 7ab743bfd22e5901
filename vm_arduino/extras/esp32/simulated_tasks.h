// The tasks of a simulated chip: in turn on one thread, or on threads of their own.

#pragma once

#include <stdint.h>

// When the next task goes on, in microseconds of the chip's time; and has those that are due go on.
extern uint64_t (*next_task_us)();
extern void (*run_tasks)();
