// One target of a program under libFuzzer: FUZZ_TARGET=frames in the environment.
#include <stdio.h>
#include <stdlib.h>

#include "targets.h"

namespace {

tilenca::fuzz::Target target = nullptr;

} // namespace

extern "C" int LLVMFuzzerInitialize(int*, char***) {
    const char* name = getenv("FUZZ_TARGET");
    target = name == nullptr ? nullptr : tilenca::fuzz::target_of(name);
    if (target == nullptr) {
        fprintf(stderr, "FUZZ_TARGET is one of %s\n", tilenca::fuzz::names().c_str());
        exit(2);
    }
    return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size) {
    target(bytes, size);
    return 0;
}
