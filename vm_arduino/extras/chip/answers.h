// Answers of every machine but the smallest: fields in a row, numbers little-endian.

#pragma once

#include "request.h"

namespace tiniscript {

// Answers a request that begins with the letter of what it asks: R to run an image, P to do so at a pace, or
// about many at once: V for verdicts of codes, I for headers of images, A for arithmetic. False: it is another
// one.
bool answer_any(Request request, size_t end);

}  // namespace tiniscript
