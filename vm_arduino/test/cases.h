// What the machine must refuse and do: `cases.cpp`, made of `tests/cases`.

#pragma once

#include <doctest.h>

#include <string>

// Checks the answer to a request to run an image, which is as `../extras/chip/runner.h` reads it, in
// hexadecimal digits: the trace of `tsc run`, or the rule that the code breaks and where.
void check(const std::string& request, const std::string& answer);

// A test case of doctest for each of them.
#define CASE(title, request, answer) \
  TEST_CASE(title) { check(request, answer); }

extern const char kRequest[];  // one of tinibot
