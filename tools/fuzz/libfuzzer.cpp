// One target under libFuzzer: -DTARGET=frames.
#include "targets.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size) {
    tilenca::fuzz::TARGET(bytes, size);
    return 0;
}
