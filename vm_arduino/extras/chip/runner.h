// Runs one image on a chip and says what the robot did.

#pragma once

#include "request.h"
#include "traced_robot.h"

namespace tiniscript {

// Reads and verifies the image of a request, and runs it with a simulated clock as `vm/runner.py` does.
// The answer is the trace, and a last line: RAN and where the code was at the end and how many
// instructions ran; REFUSED and the reason; BREAKS and the rule and the offset; or NO ROOM. If it
// is not verified, the request has code in place of an image, whatever it is.
void answer_run(Request request, bool is_verified = true, const Pace& pace = kAtOnce);

// The same at a pace, with which the request begins.
void answer_run_at_pace(Request request);

}  // namespace tiniscript
