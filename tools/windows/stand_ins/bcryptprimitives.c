// What wine 8 lacks of Windows: random bytes for programs in Rust, such as wasmtime.
#include <stddef.h>

__declspec(dllimport) unsigned char __stdcall SystemFunction036(void* bytes, unsigned long count);

__declspec(dllexport) int __stdcall ProcessPrng(unsigned char* bytes, size_t count) {
  return SystemFunction036(bytes, (unsigned long)count);
}
