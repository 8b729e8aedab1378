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
    show_overlay(false);
    overlay_ = nullptr;
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
    show_overlay(false);
    if (set) {
        traps_.insert(index);
    } else {
        traps_.erase(index);
    }
    decode_word(index);
    show_overlay(is_overlaid());
}

void Program::show_overlay(bool shown) {
    for (size_t i = 0; overlay_ != nullptr && i < overlay_->size(); i++) {
        const uint32_t begin = overlay_->begin(i);
        decode_word(begin);
        if (shown) {
            decoded_[begin].run = overlay_->function(i);
        }
    }
}

bool Program::lay(std::shared_ptr<const Overlay> overlay) {
    if (counts_ != nullptr || !overlay->fits(*this)) {
        return false;
    }
    show_overlay(false);
    overlay_ = std::move(overlay);
    show_overlay(is_overlaid());
    return true;
}

Handler Program::alone(uint32_t index) const {
    return is_overlaid() && index < kFlashWords ? original(index).run : decoded_[index].run;
}

void Program::count_with(Handler counter) {
    show_overlay(false);
    overlay_ = nullptr;
    counts_ = std::make_shared<Counts>();
    counts_->executed.assign(decoded_.size(), 0);
    for (Instruction& instruction : decoded_) {
        counts_->handlers.push_back(instruction.run);
        instruction.run = counter;
    }
}

void Program::lift_trap(uint32_t index, bool lifted) {
    if (traps_.count(index) != 0) {
        decoded_[index].run = lifted ? decode(word(index), word(index + 1), index).run : ops::trap;
    }
}

} // namespace tilenca::avr
