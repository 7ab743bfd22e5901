// The reader's expressions: operators that wait, and the kinds of what they are applied to.

#include "kit_words.h"
#include "reader_parts.h"

namespace tiniscript {

namespace {

constexpr uint32_t kLargestWhole = 2147483;
constexpr uint32_t kLargest = 0x7fffffff;

// How tightly an operator binds, from OR to a minus before its operand; 0 for brackets.
enum Binding : uint8_t { kNone, kOrs, kAnds, kNots, kComparisons, kSums, kProducts, kMinuses };

uint8_t binding_of(uint8_t op) {
  if (op >= kBracket) return kNone;
  if (op >= byte_of(Op::kNot)) return static_cast<uint8_t>(byte_of(Op::kNot) + kNots - op);
  if (op >= byte_of(Op::kEq)) return kComparisons;
  if (op == byte_of(Op::kNeg)) return kMinuses;
  return op >= byte_of(Op::kMul) ? kProducts : kSums;
}

int32_t flash_long(const uint8_t* at) {
  uint32_t value = 0;
  for (uint8_t k = 4; k != 0; k--) value = value << 8 | flash_byte(at + k - 1);
  return static_cast<int32_t>(value);
}

}  // namespace

// An argument, or the value of an assignment.
void Reader::begin_value() {
  push(kBase);
  shape_ = kFresh;
  state_ = kArgument;
}

void Reader::push_kind(bool is_yes_no) {
  if (depth_ == kStackValues) report(Problem::kLimit);
  depth_++;
  value_kinds_ = static_cast<uint16_t>(value_kinds_ << 1 | is_yes_no);
  state_ = kOperator;
}

// A token where an operand should begin.
void Reader::operand(uint8_t token) {
  const uint8_t shape = shape_;
  shape_ = kNoPlain;
  switch (token) {
    case kNumberToken:
      if (shape == kFresh || shape == kMinusFirst) shape_ = kPlain;
      number();
      return;
    case kNameToken:
      name_value();
      return;
    case kWordTrue:
    case kWordFalse:
      emit(token == kWordTrue ? byte_of(Op::kPushTrue) : byte_of(Op::kPushFalse));
      push_kind(true);
      return;
    case kWordTime:
      emit(byte_of(Op::kTime));
      push_kind(false);
      return;
    case kWordForever:
      if (state_ == kArgument &&
          (what_ == kWordLoop || (what_ <= kWordW && (kinds_ & 15) == kTimeRange))) {
        is_forever_ = true;
        stack_++;  // its value
        state_ = kAfterForever;
      } else {
        report(Problem::kForever);
      }
      return;
    case kWordNot:
      if (binding_of(*stack_) > kNots) report(Problem::kNot);
      push(byte_of(Op::kNot));
      state_ = kOperand;
      return;
    case token_of(Op::kSub):
      if (shape == kFresh) shape_ = kMinusFirst;
      push(byte_of(Op::kNeg));
      state_ = kAfterMinus;
      return;
    case '(':
      push(kBracket);
      open_bracket();
      return;
    default:
      break;
  }
  if (token < kWordRound || token > kWordRandom) {
    report(token >= kFirstWord && token < kNameToken ? Problem::kReserved : Problem::kValue);
    return;
  }
  uint8_t op = static_cast<uint8_t>(byte_of(Op::kAbs) + token - kWordAbs);
  if (token == kWordRound) op = byte_of(Op::kRound);
  if (token == kWordRandom) op = byte_of(Op::kRandom);
  push(kBracket | op);
  state_ = kFunction;
}

void Reader::open_bracket() {
  brackets_++;
  if (brackets_ == 255) report(Problem::kFull);
  state_ = kOperand;
}

void Reader::number() {
  const bool has_minus = state_ == kAfterMinus;
  if (has_minus) stack_++;
  while (places_ < 3) {
    rest_ = static_cast<uint16_t>(rest_ * 10);
    places_++;
  }
  if (value_ > kLargestWhole) {
    report(Problem::kTooBig);
    return;
  }
  if (rest_ == 1000) {
    rest_ = 0;
    value_++;
  }
  const uint32_t whole = value_;
  const uint32_t value = whole * 1000 + rest_;
  const bool is_minus = has_minus && value != 0;
  if (value > kLargest + is_minus) report(Problem::kTooBig);
  emit_number(value, whole, rest_, is_minus);
  value_ = is_minus ? 0 - value : value;
  push_kind(false);
}

void Reader::name_value() {
  const uint8_t number = number_;
  if ((found_ & kIsSensor) != 0) {
    read_first(number);
    emit_numbered(byte_of(Op::kPushSensor), byte_of(Op::kPushSensor0), number);
  } else if ((found_ & kIsVariable) != 0 && number != variables_) {
    emit_numbered(byte_of(Op::kPushVar), byte_of(Op::kPushVar0), number);
  } else {
    report((found_ & (kIsActuator | kIsDef)) != 0 ? Problem::kTaken : Problem::kUnknownValue);
  }
  push_kind((found_ & kIsYesNo) != 0);
}

// A token where an operand has ended.
void Reader::operators(uint8_t token) {
  if (state_ == kOperator) {
    if (token >= kBinary) {
      binary(token & static_cast<uint8_t>(~kBinary));
      return;
    }
    const bool is_end = token == ';' || token == kNewline;
    if (!is_end && token != ',' && token != ')') {
      report(brackets_ != 0 ? Problem::kClose : Problem::kSeparator);
      return;
    }
    const uint8_t bracket = reduce();
    if (bracket != kBase) {
      if (token == ')') {
        stack_++;
        brackets_--;
        if (bracket == kBracket) return;
        const uint8_t op = bracket & static_cast<uint8_t>(~(kBracket | kSecond));
        if ((bracket & kSecond) == 0 && op != byte_of(Op::kAbs)) report(Problem::kCount);
        apply(op);
      } else if (token == ',' && bracket != kBracket && (bracket & kSecond) == 0 &&
                 bracket != (kBracket | byte_of(Op::kAbs))) {
        *stack_ |= kSecond;
        state_ = kOperand;
      } else {
        report(token == ',' ? Problem::kCount : Problem::kClose);
      }
      return;
    }
    end_value();
    if (brackets_ == 0) {
      if (!is_end) report(token == ')' ? Problem::kClose : Problem::kSeparator);
      end_assignment();
      return;
    }
  }
  kinds_ >>= 4;
  if (token == ',' && kinds_ != 0) {
    begin_value();
  } else if (token == ')' && kinds_ == 0) {
    end_arguments();
  } else {
    report(token == ',' || token == ')' ? Problem::kCount : Problem::kClose);
  }
}

void Reader::binary(uint8_t op) {
  const uint8_t binding = binding_of(op);
  shape_ = kNoPlain;
  while (binding_of(*stack_) >= binding) {
    if (binding == kComparisons && binding_of(*stack_) == kComparisons) {
      report(Problem::kCompare);
      return;
    }
    apply(*stack_++);
  }
  if (binding <= kAnds) {
    emit(byte_of(binding == kAnds ? Op::kAndThen : Op::kOrElse));
    push(static_cast<uint8_t>(length_ - first_));
    emit(0);
  }
  push(op);
  state_ = kOperand;
}

// Applies what waits since the innermost open bracket, and returns that.
uint8_t Reader::reduce() {
  while (*stack_ < kBracket) apply(*stack_++);
  return *stack_;
}

void Reader::apply(uint8_t op) {
  const bool is_unary =
      op == byte_of(Op::kNot) || op == byte_of(Op::kNeg) || op == byte_of(Op::kAbs);
  const uint8_t all = is_unary ? 1 : 3;
  const uint8_t kinds = static_cast<uint8_t>(value_kinds_ & all);
  const bool is_yes_no = op >= byte_of(Op::kEq);
  if (!is_yes_no) {
    if (kinds != 0) report(Problem::kWantsNumber);
  } else if (op >= byte_of(Op::kNot)) {
    if (kinds != all) report(Problem::kWantsYesNo);
  } else if (kinds != 0 && (kinds != all || op > byte_of(Op::kNe))) {
    report(Problem::kCompare);
  }
  if (!is_unary) {
    value_kinds_ >>= 1;
    depth_--;
  }
  value_kinds_ = static_cast<uint16_t>((value_kinds_ & ~1) | is_yes_no);
  if (op > byte_of(Op::kNot)) {
    const uint8_t at = static_cast<uint8_t>(first_ + *stack_++);
    buffer_[at] = static_cast<uint8_t>(length_ - at - 1);
  } else {
    emit(op);
  }
}

// An argument or the value of an assignment has ended: is it one that belongs there?
void Reader::end_value() {
  stack_++;
  const uint8_t kind = kinds_ & 15;
  const bool is_yes_no = (value_kinds_ & 1) != 0;
  if (kind == kYesNoKind) {
    if (!is_yes_no) report(Problem::kWantsYesNo);
    return;
  }
  if (kind == kAnyKind) return;
  if (is_yes_no) report(Problem::kWantsNumber);
  if (kind < kFirstRange || shape_ != kPlain) return;
  const uint8_t* const range = kind == kDeviceRange ? entry_ : kArgumentRanges[kind - kFirstRange];
  const int32_t value = static_cast<int32_t>(value_);
  if (value < flash_long(range) || value > flash_long(range + 4)) report(Problem::kRange);
}

}  // namespace tiniscript
