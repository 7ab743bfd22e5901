// The main loop looks at everything: on this chip it first takes the bytes that the link has received.

#pragma once

namespace tiniscript {

void poll_events();

}  // namespace tiniscript
