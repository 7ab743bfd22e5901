// The main loop looks at everything: on this chip it first takes what the link has received.

#ifndef TINISCRIPT_ESP32_ATTENTION_H_
#define TINISCRIPT_ESP32_ATTENTION_H_

namespace tiniscript {

void pay_attention();

}  // namespace tiniscript

#endif  // TINISCRIPT_ESP32_ATTENTION_H_
