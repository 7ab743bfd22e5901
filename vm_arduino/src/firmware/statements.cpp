#include "statements.h"

#include "../vm/build.h"
#include "../vm/decode_form.h"

#ifdef tiniscript_has_breakpoints

namespace tiniscript {

namespace {

bool jumps(ControlRole role) {
  switch (role) {
    case ControlRole::kIf:
    case ControlRole::kElse:
    case ControlRole::kWhile:
    case ControlRole::kLoop:
    case ControlRole::kAgain:
    case ControlRole::kNext:
    case ControlRole::kBreak:
    case ControlRole::kDrop:
    case ControlRole::kCall:
    case ControlRole::kDef:
    case ControlRole::kTask:
    case ControlRole::kWhen:
      return true;
    default:
      return false;
  }
}

// The target of an instruction whose last operand, one byte or two, ends before `operand_end`.
uint16_t target_of(const uint8_t* code, uint16_t operand_end, const DecodeForm& form) {
  const uint8_t* operand = code + operand_end - 1;
  uint16_t distance = *operand;
  if (form.is_far()) distance = static_cast<uint16_t>(distance << 8 | *--operand);
  return static_cast<uint16_t>(form.jumps_back() ? operand_end - distance : operand_end + distance);
}

}  // namespace

bool find_statement(const uint8_t* code, uint16_t length, uint16_t place, StatementInfo* info) {
  *info = {{place, length, kNoPlace}, false, false};
  bool is_inside = false;      // from `place` on
  bool is_check = false;       // of an UNTIL or a WHEN
  uint8_t depth = 0;           // values on the stack
  uint16_t join_end = 0;       // where the last AND_THEN or OR_ELSE ends that is open
  for (uint16_t offset = 0; offset < length;) {
    const bool is_statement_start = depth == 0 && offset >= join_end;
    if (is_inside && is_statement_start && !is_check) {
      info->statement.end = offset;
      return true;
    }
    if (offset == place) {
      if (!is_statement_start) return false;
      is_inside = true;
      info->is_in_check = is_check;
    }
    const DecodeForm form = decode_form_of(code[offset]);  // a prefix has one byte, and no effect
    const ControlRole role = form.role();
    offset = static_cast<uint16_t>(offset + form.size());
    if (code[offset - form.size()] == static_cast<uint8_t>(Op::kEscape)) continue;
    depth = static_cast<uint8_t>(depth - form.pops() + form.pushes());
    if (role == ControlRole::kJoin) {
      const uint16_t target = target_of(code, offset, form);
      if (target > join_end) join_end = target;
    } else if (role == ControlRole::kWatch || role == ControlRole::kWhen) {
      is_check = true;
    } else if (role == ControlRole::kUntil || role == ControlRole::kLook) {
      is_check = false;
    }
    if (!is_inside) continue;
    if (jumps(role)) info->statement.target = target_of(code, offset, form);
    if (role == ControlRole::kReturn) info->returns = true;
  }
  return is_inside;
}

}  // namespace tiniscript

#endif
