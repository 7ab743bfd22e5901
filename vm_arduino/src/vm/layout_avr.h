// The memory layout of a machine, for assembly. `layout_avr.cpp` asserts each offset.

#pragma once

#include "build.h"

// The bit of GPIOR0 that interrupts set: `boards/avr/events.h`.
#define tini_event_bit 0

// Definitions for a chip whose calls leave three bytes on the stack, not two.
#ifdef __AVR_3_BYTE_PC__
#define tini_of_far_code(...) __VA_ARGS__
#else
#define tini_of_far_code(...)
#endif

// in a Machine
#define tini_fault_at 1
#define tini_sensors_at 2
#define tini_at_at 3
#define tini_budget_left_at 5
#define tini_length_at 6
#define tini_code_at 8
#define tini_readings_at 10
#define tini_now_at 12
#define tini_pc_at 16
#define tini_depth_at 18
#define tini_frame_count_at 19
#define tini_other_tasks_at 29
#define tini_is_quiet_at 30
#define tini_current_at 31
#define tini_move_end_at 33
#define tini_holder_at 35
#define tini_records_at (tini_variables_at + 128)
#ifdef tiniscript_has_tasks
#define tini_variables_at 37
#define tini_main_task_at (tini_records_at + tini_tasks * tini_record_bytes)
#define tini_stack_at (tini_main_task_at + tini_record_bytes)
#else
#define tini_variables_at 49
#define tini_stack_at (tini_variables_at + 128)
#endif
#define tini_frames_at (tini_stack_at + 68)
#define tini_frame_bytes 3

// in a TaskRecord, and bits of its state and its code
#define tini_task_code_at 1
#define tini_task_power_at 2
#define tini_task_frame_count_at 3
#define tini_task_pc_at 4
#define tini_task_start_at 6
#define tini_task_check_at 8
#define tini_clock_at 10
#define tini_task_rest_at 14
#define tini_task_own_powers_at 18
#define tini_record_bytes 20
#define tini_is_moving_bit 0
#define tini_has_time_bit 1
#define tini_drives_bit 2
#define tini_to_its_end_bit 3
#define tini_has_begun_bit 4
#define tini_holds_powers_bit 5
#define tini_keeps_bit 6
#define tini_has_waited_bit 7
#define tini_wants_motors 0x61
#define tini_waits_bit 4
#define tini_watches_bit 5

// bits of `other_tasks`
#define tini_is_first_round 1
#define tini_has_had_turn_bit 6

// other numbers
#define tini_tasks 4
#define tini_waiting 1
#define tini_done 2
#define tini_show 0x39
#define tini_wait 0x50
#define tini_call 0x7b
#define tini_check_ms 20
#define tini_late_ms 20
