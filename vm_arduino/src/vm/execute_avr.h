// The memory layout of a machine for `execute_avr.S`. `vm_instructions.cpp` asserts every offset.

#ifndef TINISCRIPT_VM_EXECUTE_AVR_H_
#define TINISCRIPT_VM_EXECUTE_AVR_H_

#include "has_tasks.h"

// The bit of GPIOR0 that interrupts set: `boards/avr/attention.h`.
#define tini_attention_bit 0

// in a Machine
#define tini_fault_at 1
#define tini_sensors_at 2
#define tini_at_at 3
#define tini_left_at 5
#define tini_length_at 6
#define tini_code_at 8
#define tini_readings_at 10
#define tini_now_at 12
#define tini_pc_at 16
#define tini_depth_at 18
#define tini_framed_at 19
#ifdef tiniscript_has_tasks
#define tini_variables_at 44
#define tini_stack_at (tini_variables_at + 128 + 115)
#else
#define tini_variables_at 52
#define tini_stack_at (tini_variables_at + 128)
#endif
#define tini_frames_at (tini_stack_at + 68)
#define tini_frame_bytes 3

// in a TaskRecord
#define tini_clock_at 10

#endif  // TINISCRIPT_VM_EXECUTE_AVR_H_
