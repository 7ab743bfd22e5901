// The memory layout of a reader for `reader_avr.S`. `reader_layout_avr.cpp` asserts every number.

#pragma once

// in a Reader
#define tini_buffer_at 0
#define tini_waiting_at 2
#define tini_code_length_at 8
#define tini_problem_at 9
#define tini_value_at 10

#define tini_problem_full 29
#define tini_shorts 8

// opcodes
#define tini_push_num_0 0xb0
#define tini_push_8 0x01
#define tini_push_16 0x02
#define tini_push_32 0x04
#define tini_push_tenths 0x0c
#define tini_push_milli 0x03
