#include "translate/chains.h"

#include "avr/alu.h"

#include <algorithm>

namespace tilenca::translate {

namespace {

constexpr unsigned kMostBytes = 4;

struct Links {
    avr::Handler first, next;
    const char* effect;
    bool is_stored, first_has_constant, next_has_constant;
};

constexpr Links kLinks[] = {
    {avr::ops::add, avr::ops::adc, "add_wide", true, false, false},
    {avr::ops::sub, avr::ops::sbc, "subtract_wide", true, false, false},
    {avr::ops::subi, avr::ops::sbci, "subtract_wide", true, true, true},
    {avr::ops::cp, avr::ops::cpc, "subtract_wide", false, false, false},
    {avr::ops::cpi, avr::ops::cpc, "subtract_wide", false, true, false},
};

std::string operand(const avr::Instruction& in, bool is_constant) {
    return is_constant ? std::to_string(in.r) + "u" : "r" + std::to_string(in.r);
}

} // namespace

Chain chain_of(const std::vector<avr::Instruction>& instructions) {
    const avr::Instruction& first = instructions[0];
    const auto* const links = std::find_if(std::begin(kLinks), std::end(kLinks),
                                           [&](const Links& one) { return one.first == first.run; });
    if (links == std::end(kLinks)) {
        return {};
    }
    std::vector<std::string> bytes = {operand(first, links->first_has_constant)};
    for (unsigned i = 1; i < std::min<size_t>(kMostBytes, instructions.size()); i++) {
        const avr::Instruction& in = instructions[i];
        // The other number must not be one that the chain has changed already.
        const bool is_changed = !links->next_has_constant && in.r >= first.d && in.r < first.d + i;
        if (in.run != links->next || in.d != first.d + i || (is_changed && links->is_stored)) {
            break;
        }
        bytes.push_back(operand(in, links->next_has_constant));
    }
    if (bytes.size() < 2) {
        return {};
    }
    std::string other = "word(" + bytes[0] + ", " + bytes[1] + ")";
    for (size_t i = 2; i < bytes.size(); i++) {
        other += " | " + bytes[i] + " << " + std::to_string(8 * i);
    }
    return {static_cast<unsigned>(bytes.size()), first.d, other, links->effect, links->is_stored};
}

std::string Chain::text() const {
    const std::string joint = joint_name(first);
    return "w = " + operand + "; " + (is_stored ? joint + " = " : "") + effect + "<" +
           std::to_string(8 * count) + ">(" + joint + ", w, carry, zero, nvh);";
}

} // namespace tilenca::translate
