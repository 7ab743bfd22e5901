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
    "the quotient that is built has its first two bits then: too large as well": (
        ("if (high >= divisor) return 0xffffffff;",
         "if (high > divisor) return 0xffffffff;"),
        ("if (high >= divisor) return 0xffffffff;",
         ";"),
    ),
    "3 decimals are kept by what follows too": (
        ("if (places >= 3) return size;",
         "if (places > 3) return size;"),
        ("if (places >= 3) return size;",
         "if (places >= 4) return size;"),
    ),
    "0 - 0 is 0": (
        ("if (op == Op::kAbs && a >= 0) return Fault::kNone;",
         "if (op == Op::kAbs && a > 0) return Fault::kNone;"),
        ("if (op == Op::kAbs && a >= 0) return Fault::kNone;",
         "if (op == Op::kAbs && a >= 1) return Fault::kNone;"),
    ),
    "where both are the same, each is right": (
        ("if ((a < b) != (op == Op::kMin)) a = b;",
         "if ((a <= b) != (op == Op::kMin)) a = b;"),
        ("return value < low ? low : value > high ? high : static_cast<int16_t>(value);",
         "return value <= low ? low : value > high ? high : static_cast<int16_t>(value);"),
        ("return value < low ? low : value > high ? high : static_cast<int16_t>(value);",
         "return value < low ? low : value >= high ? high : static_cast<int16_t>(value);"),
    ),
    "0 exchanged is 0": (
        ("int32_t count = whole(high) - first; if (count < 0) { first += count;",
         "int32_t count = whole(high) - first; if (count <= 0) { first += count;"),
        ("int32_t count = whole(high) - first; if (count < 0) { first += count;",
         "int32_t count = whole(high) - first; if (count < 1) { first += count;"),
    ),
    "the sign comes from above too": (
        ("bool negative(int32_t value) { return static_cast<int8_t>(value >> 24) < 0; }",
         "bool negative(int32_t value) { return static_cast<int8_t>(value >> 25) < 0; }"),
    ),
    "too large as well": (
        ("if (high >= divisor) return 0xffffffff;",
         "if (high >= divisor) return 4294967294;"),
    ),
    "the quotient is the same": (
        ("const uint32_t most = 0x7fffffff / kOne;",
         "const uint32_t most = 2147483648 / kOne;"),
        ("const uint32_t most = 0x7fffffff / kOne;",
         "const uint32_t most = 2147483646 / kOne;"),
    ),
    "the first family lies where its first opcode says": (
        ("if (code >= kFamilies) {",
         "if (code > kFamilies) {"),
    ),
    "neither is a row": (
        ("if (code % 8 >= kFamilyOps) code = 0xff;",
         "if (code % 8 >= kFamilyOps) code = 254;"),
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
    "the first tick sets it": (
        ("code_ = code; now_ms_ = now_ms; task_.random = seed;",
         "code_ = code; ; task_.random = seed;"),
    ),
    "the program has ended: nobody reads the variable": (
        ("raise(Fault::kBadCode); number = 0; }",
         "raise(Fault::kBadCode); number = 1; }"),
    ),
    "8f is no opcode": (
        ("const int32_t* const value = code < 0x90 ? variable(number) : sensor(number, code >= 0xa0);",
         "const int32_t* const value = code < 143 ? variable(number) : sensor(number, code >= 0xa0);"),
    ),
    "9f is no opcode": (
        ("const int32_t* const value = code < 0x90 ? variable(number) : sensor(number, code >= 0xa0);",
         "const int32_t* const value = code < 0x90 ? variable(number) : sensor(number, code >= 159);"),
    ),
    "instructions without operands do not look": (
        ("uint16_t operand = 0; // the first one or two bytes",
         "uint16_t operand = 1; // the first one or two bytes"),
    ),
    "the next case does nothing": (
        ("task_.pc = to; return; case Op::kForever:",
         "task_.pc = to; ; case Op::kForever:"),
    ),
    "only test_instructions.cpp looks into a program that has ended": (
        ("must_stop_ = true; task_.pc = at_; return;",
         "must_stop_ = true; ; return;"),
    ),
    "the case that follows, behind compared branches, does nothing": (
        ("task_.pc = at_; return;",
         "task_.pc = at_; ;"),
    ),
    "nothing waits yet": (
        ("task_.wake_ms = now_ms;",
         ";"),
    ),
}
# fmt: on

EQUIVALENT = {pair: reason for reason, pairs in _REASONS.items() for pair in pairs}
