// Adds words and numbers to the answer, as `tsc run` prints them.

#pragma once

#include <stdint.h>

namespace tiniscript {

void put_text(const char* text);
void put_size(unsigned long size);
void put_number(int32_t value);

// Thousandths as the shortest decimal: `12.5`, `-0.001`, `7`; or TRUE or FALSE.
void put_value(int32_t value, bool is_yes_no);

}  // namespace tiniscript
