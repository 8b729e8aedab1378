// Copies a few dozen bytes, for which what the compiler makes of a memcpy takes much longer than they need.
#pragma once

#include <string.h>

namespace tilenca {

inline void copy(void* to, const void* from, int bytes) {
    char* target = static_cast<char*>(to);
    const char* source = static_cast<const char*>(from);
    for (; bytes >= 16; bytes -= 16, target += 16, source += 16) {
        memcpy(target, source, 16);
    }
    for (int part : {8, 4, 2, 1}) {
        if (bytes & part) {
            memcpy(target, source, part);
            target += part;
            source += part;
        }
    }
}

} // namespace tilenca
