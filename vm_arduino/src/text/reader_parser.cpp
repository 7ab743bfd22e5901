// The reader's parser: what each token means in the place where it stands.

#include "reader_parts.h"

namespace tiniscript {

namespace {

bool ends(uint8_t token) { return token == ';' || token == kNewline; }

bool is_word(uint8_t token) { return token >= kFirstWord && token < kNameToken; }

bool is_command(uint8_t token) { return token >= kFirstWord && token < kFirstWord + kCommands; }

// The problem with a token where an instruction should begin, or has none.
Problem no_instruction(uint8_t token) {
  if (token == ')') return Problem::kClose;
  if (!is_word(token)) return Problem::kInstruction;
  if (token >= kWordPing && token <= kWordCheckConnection) return Problem::kSetup;
  return Problem::kReserved;
}

}  // namespace

void Reader::token(uint8_t token) {
  if (problem_ != Problem::kNone) return;
  if (token == kNewline && brackets_ != 0) return;
  switch (state_) {
    case kBegin:
      if (token == kNewline) return;
      state_ = kInstruction;
      if (token >= kWordPing && token <= kWordSb) {
        setup_ = token == kWordPing ? kStartPing : static_cast<uint8_t>(token - kWordSi);
        state_ = kBar;
        return;
      }
      break;
    case kBar:
      if (token != '|') report(Problem::kSetup);
      state_ = setup_ == kStartPing ? kCheckConnection : kInstruction;
      return;
    case kCheckConnection:
      if (token != kWordCheckConnection) report(Problem::kPing);
      state_ = kNothingMore;
      return;
    case kNothingMore:
      if (!ends(token)) report(Problem::kPing);
      return;
    case kInstruction:
      break;
    case kAfterName:
      after_name(token);
      return;
    case kArguments:
      if (token != '(') report(Problem::kOpen);
      brackets_ = 1;
      begin_value();
      return;
    case kDefName:
      define(token);
      return;
    case kAfterMove:
      end_move(token);
      return;
    case kSeparator:
      if (!ends(token)) report(token == ')' ? Problem::kClose : Problem::kSeparator);
      state_ = kInstruction;
      return;
    case kFunction:
      if (token != '(') report(Problem::kOpen);
      open_bracket();
      return;
    case kArgument:
    case kOperand:
    case kAfterMinus:
      operand(token);
      return;
    default:
      operators(token);
      return;
  }
  if (!ends(token)) instruction(token);
}

// A token begins an instruction.
void Reader::instruction(uint8_t token) {
  first_ = length_;
  known_ = read_;
  depth_ = 0;
  what_ = token;
  state_ = kSeparator;
  if (token == kNameToken) {
    state_ = kAfterName;
  } else if (is_command(token)) {
    command(token);
  } else if (token == kWordS || token == kWordStop) {
    emit(byte_of(Op::kStop));
  } else if (token == kWordDef) {
    state_ = kDefName;
  } else if (token == kWordElse) {
    next_arm();
  } else if (token == kWordBreak) {
    leave_loop();
  } else if (token >= kWordEndif && token <= kWordEnddef) {
    close(static_cast<uint8_t>(kWordEndif + (token - kWordEndif) % 4));
  } else if (token != kWordStart) {
    report(no_instruction(token));
  }
}

// A word that takes arguments.
void Reader::command(uint8_t word) {
  state_ = kArguments;
  what_ = word;
  is_forever_ = false;
  kinds_ = flash_byte(kCommandRows[word - kFirstWord]);
  if (word == kWordUntil) {
    report(Problem::kUntil);
  } else if (word == kWordElseif) {
    next_arm();
  } else if (word == kWordWhile) {
    emit(byte_of(Op::kWhile));
    emit(0);
    open(kWordEndWhile, static_cast<uint8_t>(length_ - 1));
    first_ = length_;
  }
}

// What follows a name at the begin of an instruction.
void Reader::after_name(uint8_t token) {
  state_ = kInstruction;
  target_ = number_;
  if (token == token_of(Op::kEq)) {
    if (found_ == 0) {
      if (variables_ == kVariables) report(Problem::kLimit);
      target_ = variables_;
      add_name(variables_, 0);
    } else if ((found_ & kIsVariable) == 0) {
      report(Problem::kTaken);
    }
    if ((found_ & kIsYesNo) != 0) target_ |= kNameYesNo;
    kinds_ = kAnyKind;
    begin_value();
    state_ = kOperand;
  } else if (found_ == 0) {
    report(Problem::kUnknownWord);
  } else if (token == '(' && (found_ & kIsActuator) != 0) {
    kinds_ = (found_ & kIsYesNo) != 0 ? kYesNoKind : kDeviceRange;
    brackets_ = 1;
    begin_value();
  } else if (!ends(token)) {
    report(Problem::kSeparator);
  } else if ((found_ & kIsSensor) != 0) {
    emit_numbered(byte_of(Op::kRead), byte_of(Op::kRead0), number_);
    read_ |= static_cast<SensorBits>(SensorBits{1} << number_);
  } else if (found_ == kIsDef) {
    call();
  } else {
    report((found_ & kIsActuator) != 0 ? Problem::kOpen : Problem::kInstruction);
  }
}

// The brackets of a command have closed.
void Reader::end_arguments() {
  brackets_ = 0;
  state_ = kSeparator;
  if (what_ == kNameToken) {
    emit_numbered(byte_of(Op::kSet), byte_of(Op::kSet0), target_);
    return;
  }
  uint8_t op = flash_byte(kCommandRows[what_ - kFirstWord] + 1);
  switch (what_) {
    case kWordM:
    case kWordBeep:
    case kWordUntil:
      break;
    case kWordShow:
      if ((value_kinds_ & 1) != 0) op++;
      break;
    case kWordLoop:
      if (is_forever_) {
        emit(byte_of(Op::kForever));
        open(kForeverLoop, 0);
      } else {
        emit(op);
        emit(0);
        open(kWordEndLoop, static_cast<uint8_t>(length_ - 1));
      }
      return;
    case kWordIf:
      emit(op);
      emit(0);
      open(kWordEndif, 0);
      return;
    case kWordElseif:
      emit(op);
      emit(0);
      top()->to = length_;
      top()->taken = known_;
      return;
    case kWordWhile:
      emit(op);
      link(&top()->ends);
      return;
    default:
      state_ = kAfterMove;
      return;
  }
  emit(op);
}

// What follows the brackets of a move or a wait: its UNTIL, or its end.
void Reader::end_move(uint8_t token) {
  const bool is_wait = what_ == kWordW;
  uint8_t op = flash_byte(kCommandRows[what_ - kFirstWord] + 1);
  if (token == kWordUntil) {
    constexpr uint8_t kWatchMove = byte_of(Op::kWatchF) - byte_of(Op::kMoveF);
    constexpr uint8_t kForeverMove = byte_of(Op::kWatchForeverF) - byte_of(Op::kWatchF);
    constexpr uint8_t kWatchWait = byte_of(Op::kWatchWait) - byte_of(Op::kWait);
    constexpr uint8_t kForeverWait = byte_of(Op::kWatchForeverWait) - byte_of(Op::kWatchWait);
    op = static_cast<uint8_t>(op + (is_wait ? kWatchWait : kWatchMove));
    if (is_forever_) op = static_cast<uint8_t>(op + (is_wait ? kForeverWait : kForeverMove));
    emit(op);
    first_ = length_;
    known_ = 0;
    depth_ = 0;
    what_ = kWordUntil;
    kinds_ = kYesNoKind;
    is_forever_ = false;
    state_ = kArguments;
    return;
  }
  if (!ends(token)) report(token == ')' ? Problem::kClose : Problem::kSeparator);
  if (is_forever_) report(Problem::kForever);
  emit(op);
  state_ = kInstruction;
}

// The value of an assignment has ended. The kind of a variable is that of its first one.
void Reader::end_assignment() {
  const uint8_t number = target_ & (kVariables - 1);
  uint8_t kind = value_kinds_ & 1 ? kNameYesNo : 0;
  if (number == variables_) {
    variables_++;
    *names_ |= kind;
  } else if ((target_ & kNameYesNo) != kind) {
    report(Problem::kKind);
  }
  emit_numbered(byte_of(Op::kSetVar), byte_of(Op::kSetVar0), number);
  state_ = kInstruction;
}

}  // namespace tiniscript
