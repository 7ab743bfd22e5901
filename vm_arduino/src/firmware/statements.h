// The statements of verified code: where each begins, and where a program may be next after one.
//
// A statement begins where the stack is empty and no part of an expression is open. The check of an
// UNTIL belongs to the move before it, and that of a WHEN to the WHEN; their own begins may be places
// all the same, and are statements then that end with the check.

#pragma once

#include <stdint.h>

namespace tiniscript {

constexpr uint16_t kNoPlace = 0xffff;

// It goes on at its end, or where it jumps to: no statement has two jumps.
struct Statement {
  uint16_t start;
  uint16_t end;     // where the next one begins that is no check, or the code's length
  uint16_t target;  // or kNoPlace
};

struct StatementInfo {
  Statement statement;
  bool returns;      // it goes on after the call that has led here
  bool is_in_check;  // it is part of one
};

// Finds the statement that begins at a place. False: none begins there.
bool find_statement(const uint8_t* code, uint16_t length, uint16_t place, StatementInfo* info);

}  // namespace tiniscript
