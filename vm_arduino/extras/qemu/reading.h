// The reader of text on an emulated chip.

#pragma once

#include "../chip/request.h"

namespace tiniscript {

// The request: the bytes of the reader's buffer (2), the table of `kit_words.h` and texts, each with
// its length before. Each text is one program, whatever lines it has. The answer is for each text
// 0, how it starts, the length of its code, and the code; or 1, the problem and its column; or 2:
// a block is open.
void answer_texts(Request request, size_t end);

}  // namespace tiniscript
