// A chip as the board, a debugger and whoever saves it reach it.
#include "avr/chip.h"

namespace tilenca::avr {

// Drops the edges of a wire that nobody will ask for again.
void Chip::forget_past(PinId pin) {
    uint64_t needed = spi_->needs_line_from(cpu_.cycle);
    for (auto& usart : usarts_) {
        if (usart->receive_pin() == pin) {
            needed = usart->needs_line_from(needed);
        }
    }
    gpio_->line(pin)->forget_before(needed);
}

void Chip::push_edge(PinId pin, uint64_t cycle, Drive drive) {
    Line& line = *gpio_->line(pin);
    if (line.edges() > 32) {
        forget_past(pin);
    }
    line.push(cycle, drive);
    gpio_->line_changed(pin);
    line_changed(pin);
}

void Chip::line_changed(PinId pin) {
    for (auto& usart : usarts_) {
        if (usart->receive_pin() == pin) {
            usart->line_changed();
        }
    }
}

double Chip::duty(PinId pin) {
    if (!gpio_->is_output(pin)) {
        return 0;
    }
    for (auto& timer : timers_) {
        if (!gpio_->is_taken(pin)) {
            break;
        }
        if (const double share = timer->duty(pin, cpu_.cycle); share >= 0) {
            return share;
        }
    }
    return gpio_->port_bit(pin) ? 1 : 0;
}

uint64_t Chip::wakes_at() {
    uint64_t due = 0;
    schedule_.next(&due);
    const bool idle = cpu_.asleep && !(cpu_.requests != 0 && cpu_.interrupts_on);
    return idle ? due : cpu_.cycle;
}

// --- traps ---

void Chip::update_trap(uint32_t word) {
    const bool wanted = breakpoints_.count(word) + marks_.count(word) != 0;
    if (wanted == (program_->traps().count(word) != 0)) {
        return;
    }
    if (program_.use_count() > 1) {
        program_ = std::make_shared<Program>(*program_);
        cpu_.use(*program_);
        self_programming_->program_changed();
    }
    program_->set_trap(word, wanted);
}

void Chip::set_breakpoint(uint32_t word, bool set) {
    if (set) {
        breakpoints_.insert(word);
    } else {
        breakpoints_.erase(word);
    }
    update_trap(word);
}

void Chip::set_mark(uint32_t word, bool set) {
    if (set) {
        marks_.insert(word);
    } else {
        marks_.erase(word);
    }
    update_trap(word);
}

bool Chip::trapped(uint32_t word, uint64_t cycle) {
    const bool stops = breakpoints_.count(word) != 0;
    if (!stops && marks_.count(word) != 0) {
        marks_passed_.push_back({word, cycle});
    }
    return stops;
}

void Chip::lift_trap(uint32_t word, bool lifted) {
    program_->lift_trap(word, lifted);
}

void Chip::step_halted() {
    if (!is_trapped()) {
        cpu_.halted = false;
        return;
    }
    if (marks_.count(cpu_.pc()) != 0) {
        marks_passed_.push_back({cpu_.pc(), cpu_.cycle});
    }
    cpu_.leave_breakpoint();
}

// --- saving and loading ---

void Chip::flash_state(Archive& archive) {
    bool changed = self_programming_->has_changed_flash();
    archive(changed);
    if (!archive.loading()) {
        if (changed) {
            std::vector<uint8_t> bytes(program_->bytes(), program_->bytes() + kFlashBytes);
            archive.bytes(bytes.data(), bytes.size());
        }
        return;
    }
    const std::set<uint32_t> traps = program_->traps();
    auto program = image_;
    if (changed || !traps.empty()) {
        program = std::make_shared<Program>(*image_);
    }
    if (changed) {
        std::vector<uint8_t> bytes(kFlashBytes);
        archive.bytes(bytes.data(), bytes.size());
        program->write(0, bytes.data(), kFlashBytes);
    }
    for (const uint32_t word : traps) {
        program->set_trap(word, true);
    }
    program_ = program;
    cpu_.use(*program_);
    self_programming_->set_changed_flash(changed);
}

void Chip::state(Archive& archive) {
    for (uint8_t pin = 0; pin < 8 * kPorts; pin++) { // how much of the past is still there tells nothing
        if (const PinId id{static_cast<uint8_t>(pin / 8), static_cast<uint8_t>(pin % 8)};
            !archive.loading() && gpio_->line(id) != nullptr) {
            forget_past(id);
        }
    }
    for (auto& timer : timers_) {
        timer->take_back();
    }
    flash_state(archive);
    archive(cpu_, schedule_, warnings_);
    for (Peripheral* peripheral : all_) {
        peripheral->clock_state(archive);
        peripheral->state(archive);
    }
    archive(vectors_movable_until_, prescaler_changeable_until_, jtag_changeable_until_, jtag_wanted_,
            stack_before_, stack_written_until_, prescaler_, own_prescaler_, hardware_, random_, told_read_,
            told_write_);
    if (archive.loading()) {
        self_programming_->program_changed();
        marks_passed_.clear();
    }
}

} // namespace tilenca::avr
