// What a stack may do: how deep it has been, and where the data begin.
#include "avr/cpu.h"

#include <algorithm>
#include <cstdio>

namespace tilenca::avr {

namespace {

// A stack pointer that is written further down than this starts another stack, and is no large frame.
constexpr int kLargestFrame = 512;

} // namespace

void Cpu::set_stack_low(uint16_t low) {
    stack_low = low;
    stack_room = static_cast<uint16_t>(kDataBytes - low);
}

void Cpu::set_stack_floor(uint16_t floor) {
    stack_floor = std::clamp<uint16_t>(floor, kSramStart, kDataBytes - 1);
    set_stack_low(std::max(stack_deepest, stack_floor));
}

// A stack that was put below the floor in one step is one of many, as in programs with tasks of their own.
void Cpu::stack_pointer_written(uint16_t from, uint16_t to) {
    const bool is_frame = to < from && from - to <= kLargestFrame;
    if (to >= stack_floor) {
        stack_is_elsewhere = false;
    } else if (!is_frame) {
        stack_is_elsewhere = true;
    }
    if (to < from && !stack_is_elsewhere) {
        grow_stack(from, static_cast<uint16_t>(to + 1));
    }
}

bool Cpu::grow_stack(uint16_t from, uint16_t lowest) {
    if (lowest >= kDataBytes || from >= kDataBytes) {
        return true;
    }
    if (lowest >= stack_floor) {
        set_stack_low(std::min(stack_low, lowest));
        stack_deepest = std::min(stack_deepest, lowest);
        return true;
    }
    if (from >= stack_floor) {
        stack_is_elsewhere = false;
    } else if (from + 1 < stack_floor) {
        stack_is_elsewhere = true; // it has not grown there, or that would have been seen
    }
    if (stack_is_elsewhere) {
        return true;
    }
    char text[96];
    std::snprintf(text, sizeof text, "the stack, grown down to 0x%04X, meets the data, which end at 0x%04X",
                  lowest, stack_floor - 1);
    fail(text);
    return false;
}

} // namespace tilenca::avr
