#include "avr/program.h"

#include "avr/flow.h"

#include <algorithm>
#include <cstring>

namespace tilenca::avr {

Program::Program()
    : bytes_(kFlashBytes, 0xFF), decoded_(kFlashWords + 2, Instruction{ops::erased, 0, 0, 0, 0}) {
    decoded_[kFlashWords].run = ops::beyond_flash;
    decoded_[kFlashWords + 1].run = ops::beyond_flash;
}

uint16_t Program::word(uint32_t index) const {
    index %= kFlashWords;
    return static_cast<uint16_t>(bytes_[2 * index] | bytes_[2 * index + 1] << 8);
}

void Program::write(uint32_t byte_address, const uint8_t* bytes, uint32_t count) {
    if (count == 0) {
        return;
    }
    std::memcpy(bytes_.data() + byte_address, bytes, count);
    const uint32_t first = byte_address / 2, last = (byte_address + count - 1) / 2;
    for (uint32_t i = first == 0 ? 0 : first - 1; i <= last; i++) {
        decode_word(i);
    }
}

void Program::decode_word(uint32_t index) {
    decoded_[index] = decode(word(index), word(index + 1), index);
    if (traps_.count(index) != 0) {
        decoded_[index].run = ops::trap;
    }
}

void Program::set_trap(uint32_t index, bool set) {
    if (set) {
        traps_.insert(index);
    } else {
        traps_.erase(index);
    }
    decode_word(index);
}

void Program::lift_trap(uint32_t index, bool lifted) {
    if (traps_.count(index) != 0) {
        decoded_[index].run = lifted ? decode(word(index), word(index + 1), index).run : ops::trap;
    }
}

} // namespace tilenca::avr
