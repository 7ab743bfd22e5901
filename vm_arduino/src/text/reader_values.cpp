// The reader's expressions: operators that wait, and the kinds of what they are applied to.

#include "kit_words.h"
#include "reader_parts.h"

namespace tiniscript {

namespace {

// The precedence of an operator, from OR to a minus before its operand; 0 for brackets.
enum Binding : uint8_t { kNone, kOrs, kAnds, kNots, kComparisons, kSums, kProducts, kMinuses };

tini_noinline uint8_t binding_of(uint8_t op) {
  if (op >= kBracket) return kNone;
  if (op >= byte_of(Op::kNot)) return static_cast<uint8_t>(byte_of(Op::kNot) + kNots - op);
  if (op >= byte_of(Op::kEq)) return kComparisons;
  if (op == byte_of(Op::kNeg)) return kMinuses;
  return op >= byte_of(Op::kMul) ? kProducts : kSums;
}

}  // namespace

// An argument, or the value of an assignment.
void Reader::begin_value() {
  push(kBase);
  shape_ = kFresh;
  state_ = kArgument;
}

void Reader::open_bracket() {
  brackets_++;
  if (brackets_ == 255) report(Problem::kFull);
  state_ = kOperand;
}

void Reader::push_kind(bool is_yes_no) {
  if (depth_ == kStackValues) report(Problem::kLimit);
  depth_++;
  value_kinds_ = static_cast<uint16_t>(value_kinds_ << 1 | is_yes_no);
  state_ = kOperator;
}

// A token where an operand should begin.
Problem Reader::operand(uint8_t token) {
  const uint8_t shape = shape_;
  shape_ = kNotPlain;
  if (token == kNumberToken) {
    if (shape != kNotPlain) shape_ = kPlain;
    number();
  } else if (token == kNameToken) {
    return name_value();
  } else if (token >= kWordFalse && token <= kWordTime) {
    uint8_t op = byte_of(Op::kTime);
    if (token != kWordTime) op = static_cast<uint8_t>(byte_of(Op::kPushFalse) + token - kWordFalse);
    emit(op);
    push_kind(token != kWordTime);
  } else if (token == kWordForever) {
    const uint8_t command = command_;
    if (state_ != kArgument || (command != kWordLoop && command > kWordW))
      return Problem::kForeverHere;
    forever_column_ = token_column_;
    state_ = kAfterForever;
  } else if (token == kWordNot) {
    if (binding_of(*stack_) > kNots) return Problem::kNot;
    push(byte_of(Op::kNot));
    state_ = kOperand;
  } else if (token == token_of(Op::kSub)) {
    if (shape == kFresh) shape_ = kMinusFirst;
    push(byte_of(Op::kNeg));
    state_ = kAfterMinus;
  } else if (token == '(') {
    push(kBracket);
    open_bracket();
  } else if (token >= kWordAbs && token <= kWordRandom) {
    uint8_t op = static_cast<uint8_t>(byte_of(Op::kAbs) + token - kWordAbs);
    if (token == kWordRandom) op = byte_of(Op::kRandom);
    push(kBracket | op);
    state_ = kFunction;
  } else {
    return token >= kFirstWord && token < kNameToken ? Problem::kReserved : Problem::kValue;
  }
  return Problem::kNone;
}

void Reader::number() {
  bool is_minus = state_ == kAfterMinus;
  if (is_minus) pop();
  for (; places_ > 0; places_--) scale(0);
  if (value_ == 0) is_minus = false;
  if (static_cast<int32_t>(value_ - is_minus) < 0) report(Problem::kTooBig);
  emit_number(is_minus);
  if (is_minus) value_ = 0 - value_;
  push_kind(false);
}

Problem Reader::name_value() {
  const uint8_t number = number_;
  if ((name_kind_ & kIsSensor) != 0) {
    read_first();
    emit_numbered(byte_of(Op::kPushSensor), byte_of(Op::kPushSensor0), number);
  } else if ((name_kind_ & kIsVariable) != 0 && number != variables_) {
    emit_numbered(byte_of(Op::kPushVar), byte_of(Op::kPushVar0), number);
  } else {
    return (name_kind_ & (kIsActuator | kIsDef)) != 0 ? Problem::kTaken : Problem::kUnknownValue;
  }
  push_kind((name_kind_ & kIsYesNo) != 0);
  return Problem::kNone;
}

// A token where an operand has ended.
Problem Reader::operators(uint8_t token) {
  const bool is_comma = token == ',';
  if (state_ == kOperator) {
    if (token >= kBinary) return binary(token & static_cast<uint8_t>(~kBinary));
    const bool is_end = token == ';';
    while (*stack_ < kBracket) apply(pop());
    const uint8_t bracket = *stack_;
    const uint8_t op = bracket & static_cast<uint8_t>(~(kBracket | kSecond));
    // whether its argument may be the last one
    const bool is_last = bracket == kBase
                             ? kinds_ < 16
                             : (bracket & kSecond) != 0 || op == 0 || op == byte_of(Op::kAbs);
    if (kReadsDefs && bracket == kBase && (token == kWordCm || token == kWordDeg)) {
      return end_distance(token == kWordDeg);
    }
    if (!is_end && !is_comma && token != ')') {
      if (brackets_ == 0) return Problem::kSeparator;
      return is_last ? Problem::kClose : Problem::kComma;
    }
    if (bracket != kBase) {
      if (is_end) return Problem::kClose;
      if (is_comma == is_last) return Problem::kCount;
      if (is_comma) {
        *stack_ |= kSecond;
        state_ = kOperand;
      } else {
        pop();
        brackets_--;
        if (op != 0) apply(op);
      }
      return Problem::kNone;
    }
    const Problem problem = end_value();
    if (problem != Problem::kNone) return problem;
    if (brackets_ == 0) return end_assignment(token);
  } else {
    pop();  // FOREVER leaves no value
  }
  if (is_call()) {
    set_call_value();
  } else {
    kinds_ = static_cast<uint8_t>(kinds_ / 16);
  }
  if (!is_comma && token != ')') return Problem::kClose;
  if (is_comma == (kinds_ == 0)) return Problem::kCount;
  if (is_comma) {
    begin_value();
    state_ = kOperand;
  } else {
    end_arguments();
  }
  return Problem::kNone;
}

Problem Reader::binary(uint8_t op) {
  const uint8_t binding = binding_of(op);
  shape_ = kNotPlain;
  for (;;) {
    const uint8_t waiting_binding = binding_of(*stack_);
    if (waiting_binding < binding) break;
    if (binding == kComparisons && waiting_binding == kComparisons) return Problem::kCompare;
    apply(pop());
  }
  if (binding <= kAnds) {
    emit(byte_of(binding == kAnds ? Op::kAndThen : Op::kOrElse));
    push(static_cast<uint8_t>(length_ - code_start_));
    emit(0);
  }
  push(op);
  state_ = kOperand;
  return Problem::kNone;
}

void Reader::apply(uint8_t op) {
  const bool is_unary =
      op == byte_of(Op::kNot) || op == byte_of(Op::kNeg) || op == byte_of(Op::kAbs);
  const uint8_t mask = is_unary ? 1 : 3;
  uint8_t low = static_cast<uint8_t>(value_kinds_);
  const uint8_t kinds = low & mask;
  const bool is_yes_no = op >= byte_of(Op::kEq);
  Problem problem = Problem::kNone;
  if (!is_yes_no) {
    if (kinds != 0) problem = Problem::kWantsNumber;
  } else if (op >= byte_of(Op::kNot)) {
    if (kinds != mask) problem = Problem::kWantsYesNo;
  } else if (kinds != 0 && (kinds != mask || op > byte_of(Op::kNe))) {
    problem = Problem::kCompare;
  }
  if (problem != Problem::kNone) report(at_previous_token(problem));
  if (!is_unary) {
    value_kinds_ >>= 1;
    depth_--;
  }
  value_kinds_ = static_cast<uint16_t>((value_kinds_ & 0xfffe) | is_yes_no);
  if (op > byte_of(Op::kNot)) {
    const uint8_t offset = static_cast<uint8_t>(code_start_ + pop());
    buffer_[offset] = 0;
    resolve(offset);
  } else {
    emit(op);
  }
}

// An argument or the value of an assignment has ended: is it one that belongs there?
Problem Reader::end_value() {
  pop();
  const uint8_t kind = kinds_ & 15;
  const bool is_yes_no = (static_cast<uint8_t>(value_kinds_) & 1) != 0;
  if (kind == kYesNoKind) return is_yes_no ? Problem::kNone : Problem::kWantsYesNo;
  if (kind == kAnyKind) return Problem::kNone;
  if (is_yes_no) return Problem::kWantsNumber;
  if (kind < kFirstRange || shape_ != kPlain) return Problem::kNone;
  if (value() < limit(0) || value() > limit(4)) return Problem::kRange;
  return Problem::kNone;
}

tini_noinline int32_t Reader::limit(uint8_t offset) const {
  const uint8_t kind = kinds_ & 15;
  const uint8_t* const range = kind == kDeviceRange ? entry_ : kArgumentRanges[kind - kFirstRange];
  return flash_long(range + offset);
}

}  // namespace tiniscript
