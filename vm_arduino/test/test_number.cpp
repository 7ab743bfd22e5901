// Whole numbers: how they are rounded, and compared.

#include <doctest.h>

#include <initializer_list>

#include "../src/vm/number.h"

using namespace tiniscript;

TEST_CASE("whole numbers are rounded half away from zero") {
  CHECK(whole(499) == 0);
  CHECK(whole(500) == 1);
  CHECK(whole(-499) == 0);
  CHECK(whole(-500) == -1);
  CHECK(whole(INT32_MAX) == 2147484);
  CHECK(whole(INT32_MIN) == -2147484);
}

TEST_CASE("a number is compared to a whole one") {
  const int32_t values[] = {thousandths(-32768), -1, 0, 1, thousandths(32767)};
  for (const int32_t value : values) {
    for (const int16_t limit : {int16_t{-32768}, int16_t{0}, int16_t{32767}}) {
      CHECK(compare(&value, limit, 0) == (value == limit * 1000));
      CHECK(compare(&value, limit, 1) == (value != limit * 1000));
      CHECK(compare(&value, limit, 2) == (value < limit * 1000));
      CHECK(compare(&value, limit, 3) == (value <= limit * 1000));
      CHECK(compare(&value, limit, 4) == (value > limit * 1000));
      CHECK(compare(&value, limit, 5) == (value >= limit * 1000));
    }
  }
}
