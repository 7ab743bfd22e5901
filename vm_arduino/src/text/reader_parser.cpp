// The reader's parser: what each token means in the place where it stands.

#include "reader_parts.h"

namespace tiniscript {

namespace {

// The distance from a move or a wait to the one with a check; half as far from there is the endless
// one.
constexpr uint8_t kWatchMove = byte_of(Op::kWatchF) - byte_of(Op::kMoveF);
constexpr uint8_t kWatchWait = byte_of(Op::kWatchWait) - byte_of(Op::kWait);
static_assert(byte_of(Op::kWatchForeverF) - byte_of(Op::kWatchF) == kWatchMove / 2, "");
static_assert(byte_of(Op::kWatchForeverWait) - byte_of(Op::kWatchWait) == kWatchWait / 2, "");

}  // namespace

Problem Reader::end_problem(uint8_t token) {
  if (ends(token)) return Problem::kNone;
  return token == ')' ? Problem::kClose : Problem::kSeparator;
}

void Reader::token(uint8_t token) {
  if (problem_ != Problem::kNone) return;
  if (token == kNewline) {
    if (brackets_ != 0 || state_ == kBegin) return;
    // what is missing belongs after the last character
    token_column_ = last_column_;
    if (token_column_ != 255) token_column_++;
    token = ';';
  }
  const Problem problem = parse(token);
  if (problem != Problem::kNone) report(problem);
  previous_column_ = token_column_;
}

// The problem with what stands before this token.
Problem Reader::at_previous_token(Problem problem) {
  token_column_ = previous_column_;
  return problem;
}

Problem Reader::parse(uint8_t token) {
  if (!kReadsDefs && token >= kWordTask && token <= kWordEndwhen) return Problem::kLacks;
  const uint8_t state = state_;
  if (kReadsDefs && state >= kAfterDefName) return def_head(token);
  switch (state) {
    case kBegin:
      if (token >= kWordSi && token <= kWordPing) {
        setup_ = static_cast<uint8_t>(token - kWordSi);
        has_setup_ = true;
        state_ = kBar;
        return Problem::kNone;
      }
      // fall through
    case kInstruction:
      state_ = kInstruction;
      return ends(token) ? Problem::kNone : instruction(token);
    case kBar:
      state_ = setup_ == kStartPing ? kCheckConnection : kInstruction;
      return token == '|' ? Problem::kNone : Problem::kSetup;
    case kCheckConnection:
      state_ = kNothingMore;
      return token == kWordCheckConnection ? Problem::kNone : Problem::kPing;
    case kNothingMore:
      return ends(token) ? Problem::kNone : Problem::kPing;
    case kAfterName:
      return after_name(token);
    case kArguments:
    case kFunction:
      if (token != '(') return Problem::kOpen;
      open_bracket();
      if (state == kArguments) begin_value();
      return Problem::kNone;
    case kDefName:
      if (kReadsDefs) return define(token);
      // fall through
    case kAfterMove:
      return end_move(token);
    case kSeparator:
      state_ = kInstruction;
      return end_problem(token);
    case kArgument:
    case kOperand:
    case kAfterMinus:
      return operand(token);
    default:
      return operators(token);
  }
}

// A token begins an instruction.
Problem Reader::instruction(uint8_t token) {
  code_start_ = length_;
  known_sensors_ = read_sensors_;
  depth_ = 0;
  command_ = token;
  if (kReadsDefs) callee_ = 0;
  if (token == kNameToken) {
    state_ = kAfterName;
    return Problem::kNone;
  }
  if (token == kWordDef) {
    if (!kReadsDefs) return Problem::kLacks;
    state_ = kDefName;
    return Problem::kNone;
  }
  if (token >= kWordS) {
    state_ = kSeparator;
    if (token <= kWordStop) {
      emit(byte_of(Op::kStop));
      return Problem::kNone;
    }
    if (token == kWordStart) return Problem::kNone;
    if (token == kWordElse) return next_arm();
    if (token == kWordBreak) return leave_loop();
    if (token <= kWordEnddef) return close((token - kWordEndif) & 3);
    if (kReadsDefs) {
      if (token == kWordTask || token == kWordWhen) return begin_task(token == kWordWhen);
      if (token == kWordEndTask || token == kWordEndtask) return close(kTaskBlock);
      if (token == kWordEndWhen || token == kWordEndwhen) return close(kWhenBlock);
    }
    return token < kNameToken ? Problem::kReserved : Problem::kInstruction;
  }
  if (token < kFirstWord) return token == ')' ? Problem::kClose : Problem::kInstruction;
  state_ = kArguments;
  forever_column_ = 0;
  if (kReadsDefs) is_by_distance_ = false;
  const uint8_t* const row = kCommandRows[token - kFirstWord];
  kinds_ = flash_byte(row);
  op_ = flash_byte(row + 1);
  if (token == kWordUntil) return Problem::kUntil;
  if (token == kWordElseif) return next_arm();
  if (token == kWordWhile) {
    emit_open(byte_of(Op::kWhile), kWhileBlock);
    code_start_ = length_;
  }
  return Problem::kNone;
}

// The part after a name at the beginning of an instruction.
Problem Reader::after_name(uint8_t token) {
  const uint8_t kind = name_kind_;
  state_ = kInstruction;
  target_ = number_;
  if (token == token_of(Op::kEq)) {
    if (take_word()) {
      if (variables_ == kVariables) return at_previous_token(Problem::kLimit);
      target_ = variables_;
      add_name(variables_, 0);
    } else if ((kind & kIsVariable) == 0) {
      return at_previous_token(Problem::kTaken);
    }
    if ((kind & kIsYesNo) != 0) target_ |= kNameYesNo;
    kinds_ = kAnyKind;
    begin_value();
    state_ = kOperand;
    return Problem::kNone;
  }
  if (kind == 0 || (kReadsDefs && kind == kIsOfOtherDef))
    return at_previous_token(Problem::kUnknownWord);
  if ((kind & kIsActuator) != 0) {
    if (token != '(') return Problem::kOpen;
    kinds_ = (kind & kIsYesNo) != 0 ? kYesNoKind : kDeviceRange;
    brackets_ = 1;
    begin_value();
    return Problem::kNone;
  }
  if ((kind & kIsVariable) != 0) return at_previous_token(Problem::kInstruction);
  if (kReadsDefs && kind == kIsDef) return begin_call(token);
  if (!ends(token)) return Problem::kSeparator;
  emit_numbered(byte_of(Op::kRead), byte_of(Op::kRead0), number_);
  read_sensors_ |= ask();
  return Problem::kNone;
}

// The brackets of a command have closed.
void Reader::end_arguments() {
  brackets_ = 0;
  state_ = kSeparator;
  const uint8_t command = command_;
  if (is_call()) return call();
  if (command == kNameToken) {
    emit_numbered(byte_of(Op::kSet), byte_of(Op::kSet0), target_);
    return;
  }
  if (command <= kWordW) {
    state_ = kAfterMove;
    return;
  }
  uint8_t op = op_;
  if (command == kWordShow && (value_kinds_ & 1) != 0) op++;
  if (command == kWordLoop && is_forever()) {
    emit(byte_of(Op::kForever));
    open(kForeverBlock, 0);
  } else if (command == kWordLoop) {
    emit_open(op, kLoopBlock);
  } else if (command == kWordIf) {
    emit(op);
    emit(0);
    open(kIfBlock, 0);
  } else {
    emit(op);
    if (command == kWordWhile) {
      link(&top()->ends);
    } else if (command == kWordElseif) {
      emit(0);
      top()->code_start = length_;
      top()->known_before = known_sensors_;
    }
  }
}

// The part after the brackets of a move or a wait: its UNTIL, or its end.
Problem Reader::end_move(uint8_t token) {
  uint8_t op = op_;
  if (kReadsDefs && is_by_distance_) emit(byte_of(Op::kEscape));
  const bool has_until = token == kWordUntil;
  if (has_until || (kReadsDefs && is_forever())) {
    const uint8_t step = command_ == kWordW ? kWatchWait : kWatchMove;
    op = static_cast<uint8_t>(op + step);
    if (is_forever()) op = static_cast<uint8_t>(op + step / 2);
    emit(op);
  }
  if (has_until) {
    code_start_ = length_;
    known_sensors_ = 0;
    depth_ = 0;
    command_ = kWordUntil;
    op_ = byte_of(Op::kUntil);
    kinds_ = kYesNoKind;
    state_ = kArguments;
    return Problem::kNone;
  }
  if (is_forever()) {
    if (!kReadsDefs) {
      token_column_ = forever_column_;
      return Problem::kForeverHere;
    }
    // parallel to other tasks: only the end of the program shows whether there are any
    if (lone_forever_column_ == 0) lone_forever_column_ = forever_column_;
    emit(byte_of(Op::kPushFalse));
    op = byte_of(Op::kUntil);
  }
  emit(op);
  state_ = kInstruction;
  return end_problem(token);
}

// The value of an assignment has ended. The kind of a variable is that of its first one.
Problem Reader::end_assignment(uint8_t token) {
  const uint8_t number = target_ & (kVariables - 1);
  const uint8_t kind = value_kinds_ & 1 ? kNameYesNo : 0;
  if (number == variables_) {
    variables_++;
    *names_ |= kind;
  } else if (((target_ ^ kind) & kNameYesNo) != 0) {
    return at_previous_token(Problem::kKind);
  }
  emit_numbered(byte_of(Op::kSetVar), byte_of(Op::kSetVar0), number);
  state_ = kInstruction;
  return end_problem(token);
}

}  // namespace tiniscript
