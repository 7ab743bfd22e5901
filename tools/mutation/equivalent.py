"""Changes of the C++ machine that change nothing, so that no test can notice them.

Why that is so, and the lines: what a line is (with single blanks, a short one with its neighbours)
and what it becomes. `mutation.py --all` says which lines are no longer there: they leave this list.
"""

from __future__ import annotations

# fmt: off
_REASONS = {
    "both sides are kDevices there": (
        ("sensors_ = sensors < kDevices ? sensors : kDevices;",
         "sensors_ = sensors < (kDevices + 1) ? sensors : kDevices;"),
        ("sensors_ = sensors < kDevices ? sensors : kDevices;",
         "sensors_ = sensors <= kDevices ? sensors : kDevices;"),
    ),
    "0 is 0 either way": (
        ("return value < 0 ? 0 - bits : bits;",
         "return value <= 0 ? 0 - bits : bits;"),
        ("return value < 0 ? 0 - bits : bits;",
         "return value < 1 ? 0 - bits : bits;"),
        ("uint32_t duration(int32_t time) { return time < 0 ? 0 : static_cast<uint32_t>(time); }",
         "uint32_t duration(int32_t time) { return time <= 0 ? 0 : static_cast<uint32_t>(time); }"),
        ("uint32_t duration(int32_t time) { return time < 0 ? 0 : static_cast<uint32_t>(time); }",
         "uint32_t duration(int32_t time) { return time < 1 ? 0 : static_cast<uint32_t>(time); }"),
    ),
    "the first family lies where its first opcode says": (
        ("if (code >= kFamilies) {",
         "if (code > kFamilies) {"),
    ),
    "it is that already": (
        ("if (routine->counters < most_counters) routine->counters = most_counters;",
         "if (routine->counters <= most_counters) routine->counters = most_counters;"),
        ("if (routine->calls < most_calls) routine->calls = most_calls;",
         "if (routine->calls <= most_calls) routine->calls = most_calls;"),
        ("if (routine->counters < counters) routine->counters = counters;",
         "if (routine->counters <= counters) routine->counters = counters;"),
    ),
    "both lie behind any code": (
        ("constexpr uint16_t kFarAway = 0xffff; // an offset behind any code",
         "constexpr uint16_t kFarAway = 65534; // an offset behind any code"),
    ),
    "room that is not used": (
        ("Join joins[kJoins + 1]; // the first one ends behind any code",
         "Join joins[kJoins + 2]; // the first one ends behind any code"),
        ("Def defs[kDefs + 1]; // behind the closed ones: the one that is looked at",
         "Def defs[kDefs + 2]; // behind the closed ones: the one that is looked at"),
        ("Block blocks[kNestWords + 1]; // the first one is the code itself",
         "Block blocks[kNestWords + 2]; // the first one is the code itself"),
    ),
    "it is set before it is read": (
        ("uint16_t after = 0; // where the next one begins",
         "uint16_t after = 1; // where the next one begins"),
    ),
    "the next case does just that": (
        ("target = 0; break; case Role::kWhile:",
         "target = 0; ; case Role::kWhile:"),
    ),
    "END runs again, and ends again": (
        ("if (status_ >= Status::kDone) return status_;",
         "if (status_ > Status::kDone) return status_;"),
    ),
    "instructions without operands do not look": (
        ("uint16_t operand = 0; // the first one or two bytes",
         "uint16_t operand = 1; // the first one or two bytes"),
    ),
}
# fmt: on

EQUIVALENT = {pair: reason for reason, pairs in _REASONS.items() for pair in pairs}
