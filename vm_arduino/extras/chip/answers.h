// Answers about many codes, images or numbers at once: fields in a row, numbers little-endian.

#ifndef TINISCRIPT_CHIP_ANSWERS_H_
#define TINISCRIPT_CHIP_ANSWERS_H_

#include "request.h"

namespace tiniscript {

// Verdicts of the codes that the request ends with: the rule (1 byte) and the offset (2).
void answer_verdicts(Request request, size_t end);

// What is wrong with the headers of images: the refusal (1 byte).
void answer_images(Request request, size_t end);

// Results of operations: the fault (1 byte) and the result (4), which is 0 where there is a fault.
// Op::kEnd stands for `whole`.
void answer_arithmetic(Request request, size_t end);

}  // namespace tiniscript

#endif  // TINISCRIPT_CHIP_ANSWERS_H_
