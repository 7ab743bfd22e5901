#include "verify.h"

#include "../robot.h"
#include "shape.h"

namespace tiniscript {

namespace {

constexpr uint16_t kFarAway = 0xffff;  // an offset behind any code

// The upper two bits of a byte of a Block.
enum class Kind : uint8_t { kCode = 0, kIf = 0x40, kRepeat = 0x80, kCount = 0xc0 };

constexpr uint8_t kKindBits = 0xc0;
static_assert(kNestWords + 2 <= 0xff - kKindBits, "words are in the other bits");

// An open block.
struct Block {
  uint16_t end;    // 0: a loop that names none and has no BREAK yet
  uint16_t start;  // of a loop
  // Its kind and its words with those around it; an IF counts as one word, a loop as two. In one
  // byte: nothing lies deeper on the stack of an ATmega328P than these blocks.
  uint8_t kind_and_words;

  Kind kind() const { return static_cast<Kind>(kind_and_words & kKindBits); }
  uint8_t words() const { return kind_and_words & static_cast<uint8_t>(~kKindBits); }
};

// The target of an AND_THEN or an OR_ELSE.
struct Join {
  uint16_t target;
  uint8_t depth;  // values there
};

// A DEF or a task, and the most that is open in it at once, including its calls.
struct Def {
  uint16_t start;
  uint16_t end;  // 0: it is the code outside of all others
  uint8_t counters;
  uint8_t calls;
};

struct Memory {
  uint16_t devices;              // the hash of those that are used so far
  Join joins[kJoins + 1];        // the first one ends behind any code
  Def defs[kDefs + 1];           // behind the closed ones: the one that is looked at
  Block blocks[kNestWords + 1];  // the first one is the code itself
#ifdef tiniscript_has_tasks
  Def tasks[kTasks + 1];  // the first one is the main task
  bool may_have_tasks;

  Def* outermost() { return tasks; }
  void allow(bool has_tasks) { may_have_tasks = has_tasks; }
  bool lacks(Role role) const { return !may_have_tasks && role >= Role::kTask; }

  // Whether more is open in all tasks together than a machine remembers.
  bool is_too_deep(uint8_t begun) const {
    uint16_t counters = 0;
    uint16_t calls = 0;
    for (uint8_t k = 0; k <= begun; k++) {
      counters = static_cast<uint16_t>(counters + tasks[k].counters);
      calls = static_cast<uint16_t>(calls + tasks[k].calls);
    }
    return counters > kCounters || calls > kCalls;
  }
#else
  Def* outermost() { return defs; }
  void allow(bool) {}
  bool lacks(Role) const { return false; }
  bool is_too_deep(uint8_t) const { return false; }
#endif
};

void open(Def* routine) {
  routine->end = 0;
  routine->counters = 0;
  routine->calls = 0;
}

bool in_range(Byte kind, uint8_t value) {
  const uint8_t* const range = kRanges[static_cast<uint8_t>(kind)];
  return static_cast<uint8_t>(value - flash_byte(range)) <= flash_byte(range + 1);
}

// Adds a device to the hash: bytecode_spec.md defines it.
uint16_t with_device(uint16_t hash, uint16_t device) {
  const uint16_t carry = hash & 0x8000 ? kDevicesPolynomial : 0;
  return static_cast<uint16_t>(hash << 1) ^ carry ^ robot_device_hash(device);
}

// The loop that a role opens, closes or leaves: they come in pairs.
Kind loop_of(Role role) {
  static_assert(static_cast<uint8_t>(Role::kForever) % 2 == 0, "the first one does not count");
  return static_cast<uint8_t>(role) % 2 == 0 ? Kind::kRepeat : Kind::kCount;
}

// The steps of `bytecode_spec.md`, with the names that they have there and in `verify.py`. It is
// one function so that most of its state stays in registers: a class with a method for each role
// takes about 100 bytes more.
__attribute__((noinline)) Verdict pass(const uint8_t* code, uint16_t length, uint8_t sensors,
                                       uint8_t actuators, Memory* memory) {
  uint16_t at = 0;              // where the instruction that is looked at begins
  uint16_t after = 0;           // where the next one begins
  bool is_checking = false;     // the check of an UNTIL or of a WHEN is open
  uint8_t depth = 0;            // values on the stack
  uint8_t joins = 0;            // that are open
  uint8_t defs = 0;             // that are closed
  uint8_t counters = 0;         // counted loops that are open in this routine
  Join* join = memory->joins;   // the one that ends first
  Def* routine = memory->outermost();  // that is looked at
  Block* top = memory->blocks;  // the innermost block that is open
  uint8_t tasks = 0;            // that have begun beside the main one
  bool is_looking = false;      // the check is that of a WHEN
  Role opener = Role::kNone;    // of the routine
  bool reads_inside = false;    // a reading was pushed above other values, or in an open join
  join->target = kFarAway;
  open(routine);
  top->end = 0;
  top->kind_and_words = static_cast<uint8_t>(Kind::kCode);
  memory->devices = 0;

  for (;; at = after) {
    // arrive
    for (; join->target <= at; join--, joins--) {
      if (join->target != at) return {Rule::kMissedTarget, at};
      if (join->depth != depth) return {Rule::kStackNotEmpty, at};
    }
    for (; top->kind() == Kind::kIf && top->end <= at; top--) {
      if (top->end != at || depth != 0 || joins != 0 || is_checking) {
        return {Rule::kMissedTarget, at};
      }
    }
    if (routine->end != 0 && routine->end <= at) return {Rule::kBadDef, at};
    if (at >= length) break;

    // opcode: an invalid one has one byte, and its role refuses it
    const Shape shape = shape_of(code[at]);
    if (kHasTasks && memory->lacks(shape.role())) return {Rule::kUnknownOpcode, at};
    after = static_cast<uint16_t>(at + shape.size());
    if (after > length) return {Rule::kCutOperand, at};

    // operands
    const uint8_t* operand = code + at;
    for (uint8_t kinds = shape.kinds; kinds != 0; kinds = static_cast<uint8_t>(kinds >> 4)) {
      const Byte kind = static_cast<Byte>(kinds & 15);
      // a one-byte instruction holds its operand in its code
      const uint8_t value = shape.size() == 1 ? code[at] % kShorts : *++operand;
      if (!in_range(kind, value)) return {Rule::kBadOperand, at};
      if (kind < Byte::kSensor) continue;
      if (value >= (kind == Byte::kSensor ? sensors : actuators)) {
        return {Rule::kNoSuchDevice, at};
      }
      const uint16_t first = kind == Byte::kSensor ? 0 : sensors;
      memory->devices = with_device(memory->devices, static_cast<uint16_t>(first + value));
    }

    // stack
    if (depth < shape.pops()) return {Rule::kStackUnderflow, at};
    depth = static_cast<uint8_t>(depth - shape.pops() + shape.pushes());
    if (depth > kStackValues) return {Rule::kStackOverflow, at};

    // the target of a jump comes from the last one or two bytes
    const uint8_t* last = code + after - 1;
    uint16_t distance = *last;
    if (shape.is_far()) distance = static_cast<uint16_t>(distance << 8 | *--last);
    uint16_t target = static_cast<uint16_t>(after + distance);
    if (target < after) target = kFarAway;
    // a target before the code wraps to more than `after`, where nothing starts
    if (shape.jumps_back()) target = static_cast<uint16_t>(after - distance);

    // place
    if (kHasTasks && shape.family == Family::kPushRead && (depth > 1 || joins != 0)) {
      // there it would end a turn with values on the stack
      if (tasks != 0) return {Rule::kStackNotEmpty, at};
      reads_inside = true;
    }
    const Role role = shape.role();
    if (role >= Role::kRead) {
      if (depth != 0 || joins != 0) return {Rule::kStackNotEmpty, at};
      const bool is_task = kHasTasks && (role == Role::kTask || role == Role::kWhen);
      if (is_task && reads_inside) return {Rule::kStackNotEmpty, at};
      if (role >= Role::kPlain && is_checking && !(kHasTasks && role == Role::kLook)) {
        return {Rule::kInsideCheck, at};
      }
    }

    // a step for each role, those of tasks first
    if (kHasTasks && role == Role::kLook) {
      if (!is_looking) return {Rule::kNotOpen, at};
      is_checking = is_looking = false;
      continue;
    }
    if (kHasTasks && role >= Role::kEndTask) {
      const Role begin = role == Role::kEndTask ? Role::kTask : Role::kWhen;
      if (routine->end == 0 || opener != begin) return {Rule::kNotOpen, at};
      if (top->kind() != Kind::kCode) return {Rule::kStillOpen, at};
      if (routine->end != after) return {Rule::kBadDef, at};
      routine = memory->outermost();
      continue;
    }
    if (kHasTasks && role >= Role::kTask) {
      if (top->kind() != Kind::kCode || routine->end != 0) return {Rule::kBadDef, at};
      if (tasks == kTasks) return {Rule::kTooManyTasks, at};
      opener = role;
      routine = memory->outermost() + ++tasks;
      *routine = {after, target, 0, 0};
      if (role == Role::kWhen) is_checking = is_looking = true;
      continue;
    }
    Kind kind = loop_of(role);
    switch (role) {
      case Role::kNone:
        return {Rule::kUnknownOpcode, at};
      case Role::kEnd:
        return {Rule::kBadEnd, at};
      case Role::kValue:
      case Role::kRead:
      case Role::kPlain:
        continue;

      case Role::kJoin:
        if (joins == kJoins) return {Rule::kTooDeep, at};
        if (target >= length || target > join->target) return {Rule::kBadTarget, at};
        joins++;
        *++join = {target, static_cast<uint8_t>(depth + 1)};
        continue;

      case Role::kWatch:
        is_checking = true;
        continue;
      case Role::kUntil:
        if (!is_checking || (kHasTasks && is_looking)) return {Rule::kNotOpen, at};
        is_checking = false;
        continue;

      // those that open a block: see `open` below
      case Role::kElse:
        if (top->kind() != Kind::kIf || top->end != after) return {Rule::kNotOpen, at};
        top--;
        kind = Kind::kIf;
        break;
      case Role::kIf:
        if (top->kind() == Kind::kRepeat && top->end == target) continue;  // it leaves the loop
        kind = Kind::kIf;
        break;
      case Role::kForever:
      case Role::kCount:
        target = 0;
        break;
      case Role::kWhile:
      case Role::kLoop:
        break;

      case Role::kAgain:
      case Role::kNext:
      case Role::kBreak:
      case Role::kDrop: {  // close, leave
        const bool closes = role <= Role::kNext;
        const uint16_t end = closes ? after : target;
        Block* loop = top;
        if (closes && loop->kind() == Kind::kIf) return {Rule::kStillOpen, at};
        while (loop->kind() == Kind::kIf) loop--;
        if (loop->kind() != kind) return {Rule::kNotOpen, at};
        if (end > length) return {Rule::kBadTarget, at};
        if (closes) {
          if (target != loop->start) return {Rule::kBadLoopStart, at};
          if (kind == Kind::kCount) counters--;
          top--;
        }
        if (loop->end == 0) loop->end = end;
        if (loop->end != end) return {Rule::kBadLoopEnd, at};
        continue;
      }

      case Role::kDef:
        if (top->kind() != Kind::kCode || routine->end != 0) return {Rule::kBadDef, at};
        if (defs == kDefs) return {Rule::kTooManyDefs, at};
        opener = role;
        if (kHasTasks) routine = memory->defs + defs;
        *routine = {after, target, 0, 0};
        continue;
      case Role::kReturn:
        if (routine->end == 0 || (kHasTasks && opener != Role::kDef)) return {Rule::kNotOpen, at};
        if (top->kind() != Kind::kCode) return {Rule::kStillOpen, at};
        if (routine->end != after) return {Rule::kBadDef, at};
        if (kHasTasks) {
          routine = memory->outermost();
        } else {
          open(++routine);
        }
        defs++;
        continue;
      case Role::kCall: {
        const Def* called = kHasTasks ? memory->defs + defs : routine;
        uint8_t left = defs;
        do {
          if (left-- == 0) return {Rule::kBadCall, at};
          called--;
        } while (called->start != target);
        const uint8_t most_counters = static_cast<uint8_t>(counters + called->counters);
        const uint8_t most_calls = static_cast<uint8_t>(called->calls + 1);
        if (most_counters > kCounters || most_calls > kCalls) return {Rule::kTooDeep, at};
        if (routine->counters < most_counters) routine->counters = most_counters;
        if (routine->calls < most_calls) routine->calls = most_calls;
        if (memory->is_too_deep(tasks)) return {Rule::kTooDeep, at};
        continue;
      }
      default:  // those of tasks are above
        __builtin_unreachable();
    }

    // open: a block that ends at the target; an IF shares the one around it that ends there too
    if (target > length) return {Rule::kBadTarget, at};
    // where both are known: behind 0, less 1, nothing lies
    if (target > static_cast<uint16_t>(top->end - 1)) {
      // the end of a loop lies behind what closes it
      if (target != top->end || top->kind() != Kind::kIf) return {Rule::kBadTarget, at};
      if (kind == Kind::kIf) continue;
    }
    const uint8_t words = static_cast<uint8_t>(top->words() + (kind == Kind::kIf ? 1 : 2));
    if (words > kNestWords) return {Rule::kTooDeep, at};
    *++top = {target, after, static_cast<uint8_t>(static_cast<uint8_t>(kind) | words)};
    if (kind == Kind::kCount) {
      static_assert(kNestWords / 2 <= kCounters, "no more loops are open at once");
      counters++;
      if (routine->counters < counters) routine->counters = counters;
      if (memory->is_too_deep(tasks)) return {Rule::kTooDeep, at};
    }
  }

  // finish
  if (depth != 0 || joins != 0) return {Rule::kStackNotEmpty, at};
  if (is_checking) return {Rule::kInsideCheck, at};
  if (top->kind() != Kind::kCode || routine->end != 0) return {Rule::kStillOpen, at};
  return {Rule::kNone, at};
}

}  // namespace

#ifdef tiniscript_has_tasks
Verdict verify(const uint8_t* code, size_t length, uint8_t sensors, uint8_t actuators,
               uint16_t* devices, bool may_have_tasks) {
#else
Verdict verify(const uint8_t* code, size_t length, uint8_t sensors, uint8_t actuators,
               uint16_t* devices) {
  constexpr bool may_have_tasks = false;
#endif
  if (length > kCodeBytes) return {Rule::kCodeLength, 0};
  Memory memory;  // not cleared, which takes longer than most code: it is written before it is read
  memory.allow(may_have_tasks);
  const Verdict verdict = pass(code, static_cast<uint16_t>(length), sensors, actuators, &memory);
  *devices = memory.devices;
  return verdict;
}

}  // namespace tiniscript
