// The reader of text: compiles a program while its bytes arrive.
//
// One pass: bytes become tokens, a token drives the parser, and the parser emits code, which lies
// in the buffer from its beginning. Data to remember (names, open blocks, operators that wait)
// grows from the end of the buffer towards the code. Knows no link, no clock and no robot but the
// words of its kit. Accepts what the compiler accepts; its code is plain: nothing is folded, and
// each operator is one instruction.

#pragma once

#include <stdint.h>

#include "../vm/build.h"
#include "../vm/small.h"
#include "problems.h"

namespace tiniscript {

enum class TextState : uint8_t {
  kOpenLine,   // the line has not ended
  kNothing,    // the line has ended: no program has begun
  kOpenBlock,  // the line has ended: a block or a bracket is open
  kProgram,    // the line has ended, and with it a whole program
  kProblem,    // the line has ended: there is a problem in it, and the program is lost
};

class Reader {
 public:
  // Begins a program: call it first, and after kProgram and kProblem.
  void begin(uint8_t* buffer, uint16_t room);

  // Takes a byte. CR, LF or both end a line.
  tini_noinline TextState put(uint8_t byte);

  // Goes on in another buffer. The words that were read last are forgotten. The one before has at
  // most 255 bytes, and lies elsewhere.
  void move(uint8_t* buffer, uint16_t room);

  // Whether the buffer may be too small for the next token.
  bool wants_room() const;

  // Whether the program begins with a SETUP word.
  bool has_setup() const { return has_setup_; }

  // Whether there is no open bracket and no open block.
  bool may_end() const { return brackets_ == 0 && stack_ == names_; }

  // Whether the code after this number of bytes consists only of S.
  bool is_stop_after(uint8_t start) const;

  // Whether the program so far is S.
  bool is_stop() const { return !has_setup_ && is_stop_after(0); }

  // After kProblem: the number of the first word in a table of words in flash, if that is what is
  // wrong. Otherwise the number of words there, or 255.
  uint8_t find_unknown(const uint8_t* table);

  // Whether an unknown word with these letters first begins the program. (Some code may look so, too.)
  bool begins_like(uint8_t first, uint8_t second) const {
    return problem_ == Problem::kUnknownWord && buffer_[0] == first &&
           (buffer_[1] & 0x7f) == second;  // the last letter of a word is marked
  }

  // After kMore: the word for which it waits, or ')'.
  uint8_t awaited_word() const;

  // After kProgram: how the program starts, and the length of its code in the buffer, which the
  // machine's verifier accepts.
  uint8_t start() const { return setup_; }
  uint8_t length() const { return length_; }

  // After kProblem: what it is, and its column from 1; all columns from 255 on are 255.
  Problem problem() const { return wants_tasks() ? Problem::kForeverHere : problem_; }
  uint8_t column() const { return token_column_; }

  // The column of the last byte.
  uint8_t last_column() const { return column_; }

  // Whether no further line of a text could mend it.
  bool has_problem() const { return problem_ != Problem::kNone; }

  // After kRange: the number in thousandths, and the least (0) or the most (4) that goes there.
  int32_t value() const { return static_cast<int32_t>(value_); }
  int32_t limit(uint8_t offset) const;

 private:
  struct Block;
  struct Def;
  struct Layout;  // of `reader_avr.S`

  // characters, in reader.cpp
  uint8_t character(uint8_t byte);
  bool takes_checksum(uint8_t letter);
  TextState end_line();
  void take(uint8_t letter);
  void sign(uint8_t letter);
  void add_letter(uint8_t letter);
  void digit(uint8_t value);
  tini_noinline void scale(uint8_t digit);
  void report(Problem problem) { problem_ = problem; }
  bool wants_tasks() const {
    return kReadsDefs && lone_forever_column_ != 0 && tasks_ == 0 && !has_problem();
  }

  // words, in reader_names.cpp
  void end_word();
  uint8_t find(const uint8_t* table, uint8_t unmark);
  uint8_t open_word();
  bool matches(const uint8_t** entry, bool in_flash);
  void find_in_kit();
  SensorBits ask();
  bool take_word();
  void find_name();
  void add_name(uint8_t info, uint8_t data_bytes);

  // instructions, in reader_parser.cpp
  void token(uint8_t token);
  Problem parse(uint8_t token);
  Problem instruction(uint8_t token);
  Problem after_name(uint8_t token);
  Problem at_previous_token(Problem problem);
  static Problem end_problem(uint8_t token);  // with a token where an instruction must end
  bool is_forever() const { return forever_column_ != 0; }
  void end_arguments();
  Problem end_move(uint8_t token);
  Problem end_assignment(uint8_t token);

  // blocks, in reader_blocks.cpp
  void open(uint8_t type, uint8_t end_operand);
  void emit_open(uint8_t op, uint8_t type);
  Problem close(uint8_t type);
  Problem next_arm();
  Problem leave_loop();

  // DEFs, tasks and ways, in reader_defs.cpp
  void open_routine(uint8_t type, uint8_t end_operand);
  void close_routine(Block* block);
  Problem define(uint8_t token);
  Problem def_head(uint8_t token);
  Problem def_value_name(uint8_t token);
  Problem begin_task(bool is_when);
  bool reach(uint16_t defs);
  Problem begin_call(uint8_t token);
  bool is_call() const { return kReadsDefs && callee_ != 0; }
  void set_call_value();
  void call();
  Problem end_distance(bool is_turn);

  // expressions, in reader_values.cpp
  void begin_value();
  void open_bracket();
  Problem operand(uint8_t token);
  void number();
  Problem name_value();
  Problem operators(uint8_t token);
  Problem binary(uint8_t op);
  void apply(uint8_t op);
  void push_kind(bool is_yes_no);
  Problem end_value();

  // code and memory, in reader_code.cpp
  void emit(uint8_t byte);
  void emit_numbered(uint8_t op, uint8_t first_short, uint8_t number);
  void emit_number(bool is_minus);
  void link(uint8_t* end_operand);
  void resolve(uint8_t offset);
  void read_first();
  tini_noinline void insert(uint8_t byte);
  void push(uint8_t byte);
  uint8_t pop();
  bool has_room(uint16_t bytes);
  Block* top() const { return reinterpret_cast<Block*>(stack_); }

  uint8_t* buffer_;
  uint8_t* stack_;  // the lowest byte of what waits
  uint8_t* names_;  // after what waits, before the names
  uint8_t* end_;
  uint8_t length_;  // of the code
  Problem problem_;
  uint32_t value_;      // of the number's digits so far; after the number its thousandths
  uint8_t code_start_;  // where the code of this instruction begins, after its readings

  // The members that the console uses, near the beginning: that takes less code.
  uint8_t setup_;
  bool has_setup_;
  uint8_t brackets_;  // that are open

  // characters
  uint8_t place_;
  uint8_t letters_;  // of the word after the code
  uint8_t column_;
  uint8_t token_column_;     // or that of the problem
  uint8_t previous_column_;  // of the token before
  uint8_t last_column_;      // of the last character but blanks and comments
  uint8_t lead_byte_;        // the first byte of a character of UTF-8 that is not whole
  uint8_t second_byte_;
  uint8_t byte_;
  uint8_t check_;  // what has come of a checksum
  bool is_damaged_;
  bool is_after_cr_;
  uint32_t crc_;
  int8_t places_;  // decimals that it may still have; -1 after the one that rounds it

  // the parser
  uint8_t state_;
  uint8_t command_;           // the instruction, by its word
  uint8_t op_;                // its opcode
  uint8_t kinds_;             // of its arguments from this one on
  uint8_t target_;            // the variable or the actuator that it sets
  uint8_t shape_;             // whether this argument is just a number
  uint8_t forever_column_;    // of FOREVER among these arguments, or 0
  uint8_t depth_;             // values that wait
  uint16_t value_kinds_;      // a bit for each, the last one lowest: whether it is a yes/no
  SensorBits read_sensors_;   // that are surely read
  SensorBits known_sensors_;  // the same, and those that this instruction has read
  SensorBits asked_sensors_;  // that have been read anywhere
  uint8_t variables_;
  uint8_t blocks_;

  // the name that was read last
  uint8_t name_kind_;
  uint8_t number_;
  const uint8_t* entry_;

  // DEFs, tasks and ways
  tini_with_defs uint8_t defs_;
  tini_with_defs uint8_t tasks_;
  tini_with_defs uint8_t max_blocks_;    // blocks open at once in this routine
  tini_with_defs uint8_t calls_;         // calls open at once in it
  tini_with_defs uint8_t other_blocks_;  // both in the other tasks, all of them together
  tini_with_defs uint8_t other_calls_;
  tini_with_defs Def* def_;                     // the DEF that is open, or null
  tini_with_defs uint16_t callee_;              // the called DEF, from the buffer's end, or 0
  tini_with_defs uint8_t missing_values_;       // values that this call still wants
  tini_with_defs bool is_in_task_;              // whether a task is open
  tini_with_defs uint16_t main_defs_;           // DEFs with values that the main task reaches,
  tini_with_defs uint16_t task_defs_;           // this task,
  tini_with_defs uint16_t ended_task_defs_;     // and those that have ended: a bit for each
  tini_with_defs uint8_t lone_forever_column_;  // of a FOREVER that wants tasks, or 0
  tini_with_defs bool is_by_distance_;          // whether this move goes one
};

#undef tini_with_defs

}  // namespace tiniscript

#ifdef __AVR__
#include "reader_calls_avr.h"
#endif
