// What of the firmware and of the emulator is fuzzed: each takes any bytes, and must neither misbehave nor
// break what it promises.
#pragma once

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <string>
#include <vector>

namespace tilenca {
namespace fuzz {

using Target = void (*)(const uint8_t* bytes, size_t size);

// Stops at what must not be, in every build.
inline void must(bool holds, const char* what) {
    if (!holds) {
        fprintf(stderr, "fuzz: %s\n", what);
        abort();
    }
}

// Bytes of a line, to a link of a tile.
void frames(const uint8_t* bytes, size_t size);

// Bytes of the host, to a tile with its EEPROM.
void commands(const uint8_t* bytes, size_t size);

// An EEPROM, which a tile starts with; the first byte says where the power fails.
void settings(const uint8_t* bytes, size_t size);

// A list of changes of a real snapshot, whose checksum is made right again; what loads must run and be saved.
void snapshots(const uint8_t* bytes, size_t size);

// An ELF or Intel HEX file.
void images(const uint8_t* bytes, size_t size);

// Calls of the emulator's C interface, one after the other, with any arguments.
void calls(const uint8_t* bytes, size_t size);

struct Named {
    const char* name;
    Target target;
};

// The targets of a program.
const std::vector<Named>& targets();

// Their names, and what stands between them; for its help.
inline std::string names() {
    std::string text;
    for (const Named& one : targets()) {
        const bool is_last = &one == &targets().back();
        text += (text.empty() ? "" : is_last ? " or " : ", ") + std::string(one.name);
    }
    return text;
}

// The target of a name; nullptr: this program has none.
inline Target target_of(const std::string& name) {
    for (const Named& one : targets()) {
        if (one.name == name) {
            return one.target;
        }
    }
    return nullptr;
}

} // namespace fuzz
} // namespace tilenca
