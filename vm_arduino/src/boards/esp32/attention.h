// The main loop looks at everything: on this chip it first takes what the link has received.

#pragma once

namespace tiniscript {

void pay_attention();

}  // namespace tiniscript
