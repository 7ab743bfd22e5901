// In the place of the console, where a robot reads no text: nobody talks to it, and nothing is said.

#pragma once

#include <stdint.h>

#include "../text/remarks.h"

namespace tiniscript {

class Console {
 public:
  static void pass(uint16_t, uint16_t) {}
  static constexpr bool is_due() { return false; }
  static constexpr bool is_in_block() { return false; }
  static constexpr bool is_open() { return false; }
  static constexpr bool is_talking() { return false; }
  static void drop() {}
  static void discard_briefly() {}
  static void tell(Remark, bool) {}
  static void pick_up() {}
  static void hang_up() {}
  static void forget_client() {}
};

}  // namespace tiniscript
