#include "verify.h"

#include "shape.h"

namespace tiniscript {

namespace {

enum class Kind : uint8_t { kCode, kIf, kRepeat, kCount };

constexpr uint16_t kFarAway = 0xffff;  // an offset behind any code

// An open block. An IF counts as one word, a loop as two.
struct Block {
  uint16_t end;    // 0: a loop that names none and has no BREAK yet
  uint16_t start;  // of a loop
  Kind kind;
};

// The rules write what they find into `rule`; the first one stays. After that the pass ends with
// the instruction, so a rule may go on as long as it keeps to its memory.
class Verifier {
 public:
  Rule run(const uint8_t* code, uint16_t length, uint8_t sensors, uint8_t actuators);
  uint16_t at() const { return at_; }

 private:
  struct Join {
    uint16_t target;
    uint8_t depth;  // values there
  };
  struct Def {
    uint16_t start;
    uint8_t counters;
    uint8_t calls;
  };

  void refuse(Rule rule);
  void instruction();

  // what every instruction keeps
  void arrive();
  void operand(uint8_t kind);
  void stack(uint8_t pops, uint8_t pushes);
  void empty();
  void between();

  // blocks
  void open(Kind kind);
  void needs(uint8_t counters, uint8_t calls);

  // a rule for each role that needs one
  void join();
  void until();
  void if_();
  void else_();
  void close_loop(Kind kind);
  void leave(Kind kind);
  void def();
  void return_();
  void call();

  Rule rule_;  // the first that is broken
  const uint8_t* code_;
  const uint8_t* reading_;  // the next operand
  uint16_t length_;
  uint8_t limits_[8];      // of operands of one byte: the first value that is too much
  uint8_t depth_;          // values on the stack
  uint8_t words_;          // of open blocks
  uint8_t counters_;       // counted loops open in this routine
  uint8_t most_counters_;  // in this routine, its calls included
  uint8_t most_calls_;
  uint16_t at_;         // where the instruction that is looked at begins
  uint16_t after_;      // where the next one begins
  uint16_t target_;     // where the instruction jumps; 0: nowhere
  uint16_t check_;      // where the open check of an UNTIL begins, or 0
  uint16_t def_start_;  // of the open DEF
  uint16_t def_end_;    // or 0 where none is open

  Block* top_;              // the innermost block that is open
  Join* join_;              // the one that ends first
  Def* def_;                // where the next procedure is noted
  Join joins_[kJoins + 1];  // the first one ends behind any code
  Def defs_[kDefs];
  Block blocks_[kNestWords + 1];  // the first one is the code itself
};

__attribute__((noinline)) Rule Verifier::run(const uint8_t* code, uint16_t length, uint8_t sensors,
                                             uint8_t actuators) {
  code_ = code;
  length_ = length;
  limits_[static_cast<uint8_t>(Operand::kPower)] = kPowerHigh + 1;
  limits_[static_cast<uint8_t>(Operand::kPercent)] = 2 * kPercentHigh + 1;
  limits_[static_cast<uint8_t>(Operand::kCount)] = 255;
  limits_[static_cast<uint8_t>(Operand::kVariable)] = kVariables;
  limits_[static_cast<uint8_t>(Operand::kSensor)] = sensors;
  limits_[static_cast<uint8_t>(Operand::kActuator)] = actuators;
  top_ = blocks_;
  join_ = joins_;
  join_->target = kFarAway;
  def_ = defs_;
  while (at_ < length_) {
    instruction();
    if (rule_ != Rule::kNone) return rule_;
    at_ = after_;
  }
  arrive();
  between();
  if (top_ != blocks_ || def_end_ != 0) refuse(Rule::kStillOpen);
  return rule_;
}

__attribute__((noinline)) void Verifier::refuse(Rule rule) {
  if (rule_ == Rule::kNone) rule_ = rule;
}

void Verifier::instruction() {
  arrive();
  const Shape shape = shape_of(code_[at_]);
  if (shape.row == nullptr) return refuse(Rule::kUnknownOpcode);
  after_ = static_cast<uint16_t>(at_ + shape.size());
  if (after_ > length_) return refuse(Rule::kCutOperand);
  reading_ = code_ + at_ + 1;
  target_ = 0;
  uint16_t operands = shape.operands();
  if (shape.has_third()) operands |= static_cast<uint8_t>(Operand::kFwd8) << 8;
  for (; operands != 0; operands = static_cast<uint16_t>(operands >> 4)) operand(operands & 15);
  stack(shape.pops(), shape.pushes());

  const Role role = shape.role();
  // from `plain` on, but for the two that have rules of their own
  const bool is_between = role >= Role::kPlain && role != Role::kUntil && role != Role::kEnd;
  if (is_between) between();
  switch (role) {
    case Role::kValue:
    case Role::kPlain:
      return;
    case Role::kRead:
      return empty();
    case Role::kJoin:
      return join();
    case Role::kWatch:
      check_ = after_;
      return;
    case Role::kUntil:
      return until();
    case Role::kIf:
      return if_();
    case Role::kElse:
      return else_();
    case Role::kRepeat:
      return open(Kind::kRepeat);
    case Role::kCount:
      open(Kind::kCount);
      counters_++;
      return needs(counters_, most_calls_);
    case Role::kNext:
      counters_--;
      return close_loop(Kind::kCount);
    case Role::kAgain:
      return close_loop(Kind::kRepeat);
    case Role::kBreak:
      return leave(Kind::kRepeat);
    case Role::kDrop:
      return leave(Kind::kCount);
    case Role::kDef:
      return def();
    case Role::kReturn:
      return return_();
    case Role::kCall:
      return call();
    case Role::kEnd:
      return refuse(Rule::kBadEnd);
  }
}

// Closes what ends at this offset.
void Verifier::arrive() {
  for (; join_->target <= at_; join_--) {
    if (join_->target != at_) return refuse(Rule::kMissedTarget);
    if (join_->depth != depth_) return refuse(Rule::kStackNotEmpty);
  }
  while (top_->kind == Kind::kIf && top_->end <= at_) {
    if (top_->end != at_ || depth_ != 0 || check_ != 0) return refuse(Rule::kMissedTarget);
    top_--;
    words_--;
  }
  if (def_end_ != 0 && at_ >= def_end_) refuse(Rule::kBadDef);
}

void Verifier::operand(uint8_t kind) {
  const Operand operand = static_cast<Operand>(kind);
  uint8_t value = *reading_++;
  if (operand >= Operand::kFwd8) {
    // kAny32 is skipped as it is: nothing follows it
    uint16_t distance = value;
    if (operand >= Operand::kAny16) distance |= static_cast<uint16_t>(*reading_++ << 8);
    if (operand == Operand::kBack8 || operand == Operand::kBack16) {
      // where it leads to before the code, this is more than `after_`: no start of anything
      target_ = static_cast<uint16_t>(after_ - distance);
    } else {
      target_ = static_cast<uint16_t>(after_ + distance);
      if (target_ < after_) target_ = kFarAway;
    }
    return;
  }
  if (operand == Operand::kAny8) return;
  if (operand == Operand::kPercent) value = static_cast<uint8_t>(value + kPercentHigh);
  if (operand == Operand::kCount) value--;
  if (value < limits_[kind]) return;
  refuse(operand >= Operand::kSensor ? Rule::kNoSuchDevice : Rule::kBadOperand);
}

void Verifier::stack(uint8_t pops, uint8_t pushes) {
  if (depth_ < pops) return refuse(Rule::kStackUnderflow);
  depth_ = static_cast<uint8_t>(depth_ - pops + pushes);
  if (depth_ > kStackValues) refuse(Rule::kStackOverflow);
}

void Verifier::empty() {
  if (depth_ != 0 || join_ != joins_) refuse(Rule::kStackNotEmpty);
}

// Instructions but those of expressions leave the stack empty and stand in no check.
void Verifier::between() {
  empty();
  if (check_ != 0) refuse(Rule::kInsideCheck);
}

// Opens a block that ends at the target; an IF shares the block around it that ends there too.
// A loop without a target ends where its first BREAK says.
void Verifier::open(Kind kind) {
  const uint16_t end = target_;
  if (end != 0) {
    if (end > length_) return refuse(Rule::kBadTarget);
    if (top_->end != 0 && end >= top_->end) {
      // the end of a loop lies behind what closes it
      if (end != top_->end || top_->kind != Kind::kIf) return refuse(Rule::kBadTarget);
      if (kind == Kind::kIf) return;
    }
  }
  words_ = static_cast<uint8_t>(words_ + (kind == Kind::kIf ? 1 : 2));
  if (words_ > kNestWords) return refuse(Rule::kTooDeep);
  top_++;
  top_->end = end;
  top_->start = after_;
  top_->kind = kind;
}

// Notes what is open at once, and refuses what is too deep.
__attribute__((noinline)) void Verifier::needs(uint8_t counters, uint8_t calls) {
  if (counters > kCounters || calls > kCalls) refuse(Rule::kTooDeep);
  if (most_counters_ < counters) most_counters_ = counters;
  if (most_calls_ < calls) most_calls_ = calls;
}

void Verifier::join() {
  if (join_ == joins_ + kJoins) return refuse(Rule::kTooDeep);
  if (target_ >= length_ || target_ > join_->target) return refuse(Rule::kBadTarget);
  join_++;
  join_->target = target_;
  join_->depth = static_cast<uint8_t>(depth_ + 1);
}

void Verifier::until() {
  if (check_ == 0) return refuse(Rule::kNotOpen);
  empty();
  if (target_ != check_) refuse(Rule::kBadLoopStart);
  check_ = 0;
}

void Verifier::if_() {
  if (top_->kind == Kind::kRepeat && top_->end == target_) return;  // it leaves the loop
  open(Kind::kIf);
}

void Verifier::else_() {
  if (top_->kind != Kind::kIf || top_->end != after_) return refuse(Rule::kNotOpen);
  top_--;
  words_--;
  open(Kind::kIf);
}

void Verifier::close_loop(Kind kind) {
  if (top_->kind == Kind::kIf) return refuse(Rule::kStillOpen);
  if (top_->kind != kind) return refuse(Rule::kNotOpen);
  if (target_ != top_->start) refuse(Rule::kBadLoopStart);
  if (top_->end != 0 && top_->end != after_) refuse(Rule::kBadLoopEnd);
  top_--;
  words_ = static_cast<uint8_t>(words_ - 2);
}

void Verifier::leave(Kind kind) {
  Block* loop = top_;
  while (loop->kind == Kind::kIf) loop--;
  if (loop->kind != kind) return refuse(Rule::kNotOpen);
  if (target_ > length_) return refuse(Rule::kBadTarget);
  if (loop->end == 0) loop->end = target_;
  if (loop->end != target_) refuse(Rule::kBadLoopEnd);
}

void Verifier::def() {
  if (top_ != blocks_ || def_end_ != 0) return refuse(Rule::kBadDef);
  if (def_ == defs_ + kDefs) return refuse(Rule::kTooManyDefs);
  def_start_ = after_;
  def_end_ = target_;
  most_counters_ = most_calls_ = 0;
}

void Verifier::return_() {
  if (def_end_ == 0) return refuse(Rule::kNotOpen);
  if (top_ != blocks_) return refuse(Rule::kStillOpen);
  if (def_end_ != after_) return refuse(Rule::kBadDef);
  Def* const noted = def_++;
  noted->start = def_start_;
  noted->counters = most_counters_;
  noted->calls = most_calls_;
  def_end_ = 0;
}

void Verifier::call() {
  for (const Def* each = def_; each != defs_;) {
    each--;
    if (each->start == target_) {
      return needs(static_cast<uint8_t>(counters_ + each->counters),
                   static_cast<uint8_t>(each->calls + 1));
    }
  }
  refuse(Rule::kBadCall);
}

}  // namespace

Verdict verify(const uint8_t* code, size_t length, uint8_t sensors, uint8_t actuators) {
  if (length > kCodeBytes) return {Rule::kCodeLength, 0};
  Verifier verifier = Verifier();  // all members are 0
  const Rule rule = verifier.run(code, static_cast<uint16_t>(length), sensors, actuators);
  return {rule, verifier.at()};
}

}  // namespace tiniscript
