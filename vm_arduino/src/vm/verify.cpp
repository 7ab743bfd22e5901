#include "verify.h"

#include "../robot.h"
#include "decode_form.h"

namespace tiniscript {

namespace {

constexpr uint16_t kFarAway = 0xffff;  // an offset past any code

enum class Kind : uint8_t { kCode, kIf, kRepeat, kCount };

// An open block: an IF is one of these, a loop two, its start below its end. This is the deepest
// point of the stack on an ATmega328P.
struct Block {
  uint16_t end;  // 0: a loop that names none and has no BREAK yet
  Kind kind;
};

// The target of an AND_THEN or an OR_ELSE.
struct Join {
  uint16_t target;
  uint8_t depth;  // values there
};

// Counters in the low byte, calls in the high one: the most that a routine has open at once,
// including what it calls.
using Depth = uint16_t;
constexpr Depth kCall = 0x100;

// Whether that is more than a machine remembers.
bool is_too_deep(Depth depth) { return (depth & 0xff) > kCounters || depth >= (kCalls + 1) * kCall; }

// A closed DEF.
struct Def {
  uint16_t start;
  Depth max_depth;
};

struct Memory {
  uint16_t devices;              // the hash of those that are used so far
  Join joins[kJoins + 1];        // the first one ends past any code
  Block blocks[kNestWords + 2];  // the first one is the code itself, the last one is too deep
  Def defs[kDefs];               // that are closed
};

bool is_in_range(Byte kind, uint8_t value) {
  const uint8_t* const range = kRanges[static_cast<uint8_t>(kind)];
  return static_cast<uint8_t>(value - flash_byte(range)) <= flash_byte(range + 1);
}

bool is_push_read(Family family) {
  return family == Family::kPushRead || family == Family::kPushReadShort;
}

// Adds a device to the hash: bytecode_spec.md defines it.
uint16_t add_device(uint16_t hash, uint16_t device) {
  const uint16_t carry = hash & 0x8000 ? kDevicesPolynomial : 0;
  return static_cast<uint16_t>(hash << 1) ^ carry ^ robot_device_hash(device);
}

// The loop that a role opens, closes or leaves: they come in pairs.
Kind loop_of(ControlRole role) {
  static_assert(static_cast<uint8_t>(ControlRole::kForever) % 2 == 0,
                "the first one does not count");
  return static_cast<uint8_t>(role) % 2 == 0 ? Kind::kRepeat : Kind::kCount;
}

// The steps of `bytecode_spec.md`, with the names that they have there and in `verify.py`. It is
// one function so that most of its state stays in registers: a class with a method for each role
// takes about 100 bytes more.
__attribute__((noinline)) Verdict pass(const uint8_t* code, uint16_t length, uint8_t sensors,
                                       uint8_t actuators, Memory* memory, uint8_t may_need) {
  uint16_t at = 0;               // where the instruction that is looked at begins
  uint16_t next_offset = 0;      // where the next one begins
  ControlRole checker =
      ControlRole::kNone;        // what ends the check of an UNTIL or of a WHEN that is open
  uint8_t depth = 0;             // values on the stack
  uint8_t joins = 0;             // that are open
  Def* defs_end = memory->defs;  // after the closed DEFs
  uint8_t counters = 0;          // counted loops that are open in this routine
  Join* join = memory->joins;    // the one that ends first
  uint16_t start = 0;            // of the routine that is looked at
  uint16_t end = 0;              // of it, 0: it is the code outside of all others
  Depth max_depth = 0;           // that it needs
  Depth main_depth = 0;          // that the code outside needs, while another routine is looked at
  Depth ended_depth = 0;         // that the tasks need that have ended, together
  Depth other_depth = 0;         // that others need which are open with this routine
  Block* top = memory->blocks;   // the innermost block that is open
  uint8_t tasks = 0;             // that have begun, besides the main one
  ControlRole closer = ControlRole::kNone;  // of the routine
  uint8_t needed = 0;            // of `needs`, except tasks
  uint8_t minor = 0;             // the version of its instructions, apart from their needs
  bool reads_inside = false;     // a reading was pushed above other values, or in an open join
  join->target = kFarAway;
  top->end = 0;
  top->kind = Kind::kCode;
  memory->devices = 0;

  for (;; at = next_offset) {
    // arrive
    for (; join->target <= at; join--, joins--) {
      if (join->target != at) return {Rule::kMissedTarget, at};
      if (join->depth != depth) return {Rule::kStackNotEmpty, at};
    }
    for (; top->kind == Kind::kIf && top->end <= at; top--) {
      if (top->end != at || depth != 0 || joins != 0 || checker != ControlRole::kNone) {
        return {Rule::kMissedTarget, at};
      }
    }
    if (end != 0 && end <= at) return {Rule::kBadDef, at};
    if (at >= length) break;

    // opcode: an invalid one has one byte, and its role refuses it
    const uint8_t* operand = code + at;
    next_offset = at;
    if (*operand == static_cast<uint8_t>(Op::kEscape) && (may_need & kNeedsWays) != 0) {
      if (++next_offset == length) return {Rule::kCutOperand, at};
      if (!is_way(*++operand)) return {Rule::kUnknownOpcode, at};
      needed = kNeedsWays;
    }
    if (minor_of_op(*operand) > minor) minor = minor_of_op(*operand);
    const DecodeForm form = decode_form_of(*operand);
    if (kHasTasks && (may_need & kNeedsTasks) == 0 && form.role() >= ControlRole::kTask) {
      return {Rule::kUnknownOpcode, at};
    }
    next_offset = static_cast<uint16_t>(next_offset + form.size());
    if (next_offset > length) return {Rule::kCutOperand, at};

    // operands
    for (uint8_t kinds = form.kinds; kinds != 0; kinds = static_cast<uint8_t>(kinds >> 4)) {
      const Byte kind = static_cast<Byte>(kinds & 15);
      // a one-byte instruction holds its operand in its code
      const uint8_t value = form.size() == 1 ? code[at] % kShorts : *++operand;
      if (!is_in_range(kind, value)) return {Rule::kBadOperand, at};
      if (kind < Byte::kSensor) continue;
      if (value >= (kind == Byte::kSensor ? sensors : actuators)) {
        return {Rule::kNoSuchDevice, at};
      }
      const uint16_t first = kind == Byte::kSensor ? 0 : sensors;
      memory->devices = add_device(memory->devices, static_cast<uint16_t>(first + value));
    }

    // stack
    if (depth < form.pops()) return {Rule::kStackUnderflow, at};
    depth = static_cast<uint8_t>(depth - form.pops() + form.pushes());
    if (depth > kStackValues) return {Rule::kStackOverflow, at};

    // the target of a jump comes from the last one or two bytes
    const uint8_t* operand_byte = code + next_offset - 1;
    uint16_t distance = *operand_byte;
    if (form.is_far()) distance = static_cast<uint16_t>(distance << 8 | *--operand_byte);
    uint16_t target = static_cast<uint16_t>(next_offset + distance);
    if (target < next_offset) target = kFarAway;
    // a target before the code wraps to more than `next_offset`, where nothing starts
    if (form.jumps_back()) target = static_cast<uint16_t>(next_offset - distance);

    // place
    if (kHasTasks && is_push_read(form.family) && (depth > 1 || joins != 0)) {
      // there it would end a turn with values on the stack
      if (tasks != 0) return {Rule::kStackNotEmpty, at};
      reads_inside = true;
    }
    const ControlRole role = form.role();
    if (role >= ControlRole::kRead) {
      if (depth != 0 || joins != 0) return {Rule::kStackNotEmpty, at};
      const bool is_task = kHasTasks && (role == ControlRole::kTask || role == ControlRole::kWhen);
      if (is_task && reads_inside) return {Rule::kStackNotEmpty, at};
      if (role >= ControlRole::kPlain && checker != ControlRole::kNone &&
          role != ControlRole::kLook) {
        return {Rule::kInsideCheck, at};
      }
    }

    // a step for each role
    Kind kind = loop_of(role);
    Depth needs = 0;
    switch (role) {
      case ControlRole::kNone:
        return {Rule::kUnknownOpcode, at};
      case ControlRole::kEnd:
        return {Rule::kBadEnd, at};
      case ControlRole::kValue:
      case ControlRole::kRead:
      case ControlRole::kPlain:
        continue;

      case ControlRole::kJoin:
        if (joins == kJoins) return {Rule::kTooDeep, at};
        if (target >= length || target > join->target) return {Rule::kBadTarget, at};
        joins++;
        *++join = {target, static_cast<uint8_t>(depth + 1)};
        continue;

      case ControlRole::kWatch:
        checker = ControlRole::kUntil;
        continue;
      case ControlRole::kUntil:
      case ControlRole::kLook:
        if (checker != role) return {Rule::kNotOpen, at};
        checker = ControlRole::kNone;
        continue;

      // those that open a block: see `open` below
      case ControlRole::kElse:
        if (top->kind != Kind::kIf || top->end != next_offset) return {Rule::kNotOpen, at};
        top--;
        kind = Kind::kIf;
        break;
      case ControlRole::kIf:
        if (top->kind == Kind::kRepeat && top->end == target) continue;  // it leaves the loop
        kind = Kind::kIf;
        break;
      case ControlRole::kForever:
      case ControlRole::kCount:
        target = 0;
        break;
      case ControlRole::kWhile:
      case ControlRole::kLoop:
        break;

      case ControlRole::kAgain:
      case ControlRole::kNext:
      case ControlRole::kBreak:
      case ControlRole::kDrop: {  // close, leave
        const bool closes = role <= ControlRole::kNext;
        const uint16_t loop_end = closes ? next_offset : target;
        Block* loop = top;
        if (closes && loop->kind == Kind::kIf) return {Rule::kStillOpen, at};
        while (loop->kind == Kind::kIf) loop--;
        if (loop->kind != kind) return {Rule::kNotOpen, at};
        if (loop_end > length) return {Rule::kBadTarget, at};
        if (closes) {
          if (target != loop[-1].end) return {Rule::kBadLoopStart, at};
          if (kind == Kind::kCount) counters--;
          top -= 2;
        }
        if (loop->end == 0) loop->end = loop_end;
        if (loop->end != loop_end) return {Rule::kBadLoopEnd, at};
        continue;
      }

      case ControlRole::kDef:
      case ControlRole::kTask:
      case ControlRole::kWhen:
        if (top->kind != Kind::kCode || end != 0) return {Rule::kBadDef, at};
        main_depth = max_depth;
        other_depth = 0;
        if (role == ControlRole::kDef) {
          if (defs_end == memory->defs + kDefs) return {Rule::kTooManyDefs, at};
        } else if (kHasTasks) {
          if (tasks++ == kTasks) return {Rule::kTooManyTasks, at};
          other_depth = static_cast<Depth>(ended_depth + main_depth);
          if (role == ControlRole::kWhen) checker = ControlRole::kLook;
        }
        closer = static_cast<ControlRole>(static_cast<uint8_t>(role) + 1);
        start = next_offset;
        max_depth = 0;
        end = target;
        continue;
      case ControlRole::kReturn:
      case ControlRole::kEndTask:
      case ControlRole::kEndWhen:
        if (end == 0 || closer != role) return {Rule::kNotOpen, at};
        if (top->kind != Kind::kCode) return {Rule::kStillOpen, at};
        if (end != next_offset) return {Rule::kBadDef, at};
        end = 0;
        if (role == ControlRole::kReturn) {
          *defs_end++ = {start, max_depth};
        } else if (kHasTasks) {
          ended_depth = static_cast<Depth>(ended_depth + max_depth);
        }
        max_depth = main_depth;
        other_depth = ended_depth;
        continue;
      case ControlRole::kCall: {
        const Def* callee = defs_end;
        do {
          if (callee == memory->defs) return {Rule::kBadCall, at};
          callee--;
        } while (callee->start != target);
        needs = static_cast<Depth>(callee->max_depth + kCall);
        break;
      }
    }

    if (role != ControlRole::kCall) {
      // open: a block that ends at the target; an IF shares the one around it that ends there too
      if (target > length) return {Rule::kBadTarget, at};
      // where both are known: after 0, less 1, nothing lies
      if (target > static_cast<uint16_t>(top->end - 1)) {
        // the end of a loop lies after what closes it
        if (target != top->end || top->kind != Kind::kIf) return {Rule::kBadTarget, at};
        if (kind == Kind::kIf) continue;
      }
      if (kind != Kind::kIf) (++top)->end = next_offset;
      if (top++ >= memory->blocks + kNestWords) return {Rule::kTooDeep, at};
      *top = {target, kind};
      if (kind != Kind::kCount) continue;
      counters++;
    }
    // needs
    needs = static_cast<Depth>(needs + counters);
    if ((max_depth & 0xff) < (needs & 0xff))
      max_depth = static_cast<Depth>((max_depth & 0xff00) | (needs & 0xff));
    if (max_depth >> 8 < needs >> 8)
      max_depth = static_cast<Depth>((max_depth & 0xff) | (needs & 0xff00));
    if (is_too_deep(static_cast<Depth>(max_depth + other_depth))) return {Rule::kTooDeep, at};
  }

  // finish
  if (depth != 0 || joins != 0) return {Rule::kStackNotEmpty, at};
  if (checker != ControlRole::kNone) return {Rule::kInsideCheck, at};
  if (top->kind != Kind::kCode || end != 0) return {Rule::kStillOpen, at};
  if (tasks != 0) needed |= kNeedsTasks;
  return {Rule::kNone, static_cast<uint16_t>(minor << 8 | needed)};
}

}  // namespace

Verdict verify(const uint8_t* code, size_t length, uint8_t sensors, uint8_t actuators,
               uint16_t* devices, uint8_t may_need) {
  if (length > kCodeBytes) return {Rule::kCodeLength, 0};
  Memory memory;  // not cleared, which takes longer than most code: it is written before it is read
  const Verdict verdict =
      pass(code, static_cast<uint16_t>(length), sensors, actuators, &memory, may_need);
  *devices = memory.devices;
  return verdict;
}

}  // namespace tiniscript
