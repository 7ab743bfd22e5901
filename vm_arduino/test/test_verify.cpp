// What the machine must refuse.

#include <doctest.h>

#include <set>

#include "../src/vm/verify.h"
#include "cases.h"

using namespace tiniscript;

namespace {

Verdict verdict(const std::vector<uint8_t>& code, const cases::Kit& kit, uint8_t needs = 0) {
  return verify(code.data(), code.size(), static_cast<uint8_t>(kit.sensors.size()),
                static_cast<uint8_t>(kit.actuators.size()), needs);
}

}  // namespace

TEST_CASE("what breaks a rule is refused with the rule and the offset") {
  for (const cases::RefusedCase& each : cases::refused_cases()) {
    INFO(each.title);
    const Verdict found = verdict(each.code, cases::tinibot(), each.needs);
    CHECK(static_cast<int>(found.rule) == static_cast<int>(each.rule));
    CHECK(found.offset == each.offset);
  }
}

TEST_CASE("every rule refuses something") {
  std::set<int> rules;
  for (const cases::RefusedCase& each : cases::refused_cases()) {
    rules.insert(static_cast<int>(each.rule));
  }
  // the rest is too long for a case
  const int first = static_cast<int>(Rule::kCodeLength);
  for (int rule = first + 1; rule <= static_cast<int>(Rule::kTooManyTasks); rule++) {
    CAPTURE(rule);
    CHECK(rules.count(rule) == 1);
  }
  const std::vector<uint8_t> longest(kCodeBytes, static_cast<uint8_t>(Op::kStop));
  CHECK(verify(longest.data(), longest.size(), 0, 0).rule == Rule::kNone);
  const std::vector<uint8_t> longer(kCodeBytes + 1, static_cast<uint8_t>(Op::kStop));
  CHECK(verify(longer.data(), longer.size(), 0, 0).rule == Rule::kCodeLength);
}

TEST_CASE("every program is accepted, and no program that is cut inside an instruction") {
  for (const cases::ProgramCase& each : cases::program_cases()) {
    INFO(each.title);
    std::vector<uint8_t> code(each.image.begin() + kHeaderBytes, each.image.end());
    CHECK(verdict(code, each.kit, each.image[kNeedsAt]).rule == Rule::kNone);
  }
  CHECK(verdict({static_cast<uint8_t>(Op::kMove8F), 10}, cases::tinibot()).rule ==
        Rule::kCutOperand);
}
