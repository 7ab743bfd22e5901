// What the machine must refuse and do: `cases.cpp`, made of `tests/cases`.

#ifndef TINISCRIPT_TEST_CASES_H_
#define TINISCRIPT_TEST_CASES_H_

#include <string>
#include <vector>

// The request to run an image, as `../extras/chip/runner.h` reads it, in hexadecimal digits; and the
// answer: the trace of `tsc run`, or the rule that the code breaks and where.
struct Case {
  std::string title;
  std::string request;
  std::string answer;
};

const std::vector<Case>& cases();

#endif  // TINISCRIPT_TEST_CASES_H_
