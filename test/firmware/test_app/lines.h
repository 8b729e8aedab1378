// The sentences both twins agree on, and what a tile has said.
#pragma once

#include <doctest/doctest.h>

#include <string>

#include "app/sentence.h"

namespace tilenca {
namespace test {

// The line of the shared table with this name.
inline const char* line_of(const std::string& name) {
    struct Line {
        const char* name;
        const char* text;
    };
    static const Line lines[] = {
#define CASE(name, text) {name, text "\r\n"},
#include "sentences.inc"
#undef CASE
    };
    for (const Line& line : lines) {
        if (name == line.name) {
            return line.text;
        }
    }
    FAIL("no such line: " << name);
    return nullptr;
}

inline std::string text_of(const Sentence& sentence) {
    return {sentence.bytes(), sentence.size()};
}

} // namespace test
} // namespace tilenca
