#include "translate/registers.h"

#include <cctype>

namespace tilenca::translate {

namespace {

std::string name(unsigned reg) {
    return reg == kStackPointer ? "sp" : "r" + std::to_string(reg);
}

bool is_name(char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
}

// Which register is named there; kVariables: none.
unsigned named(const std::string& text, size_t begin, size_t end) {
    if (text.compare(begin, end - begin, "sp") == 0) {
        return kStackPointer;
    }
    unsigned number = 0;
    for (size_t i = begin + 1; i < end; i++) {
        if (text[i] < '0' || text[i] > '9') {
            return kVariables;
        }
        number = number * 10 + static_cast<unsigned>(text[i] - '0');
    }
    return text[begin] == 'r' && end - begin >= 2 && number < 32 ? number : kVariables;
}

} // namespace

std::string joint_name(unsigned first) {
    return "v" + std::to_string(first);
}

void Registers::join(unsigned first, unsigned count) {
    for (unsigned reg = first; reg < first + count; reg++) {
        if (reg >= kStackPointer || count_[reg] != 0) {
            return;
        }
    }
    for (unsigned reg = first; reg < first + count; reg++) {
        first_[reg] = first;
        count_[reg] = count;
    }
}

void Registers::note(const std::string& text, Kind kind) {
    unsigned put = 0; // operands of a put() that follow
    for (size_t begin = 0, end = 0; begin < text.size(); begin = end + 1) {
        for (end = begin; end < text.size() && is_name(text[end]);) {
            end++;
        }
        if (end == begin) {
            continue;
        }
        const unsigned reg = named(text, begin, end);
        if (reg != kVariables) {
            used_[reg] = true;
            written_[reg] = written_[reg] || put != 0 || text.compare(end, 3, " = ") == 0;
        }
        put = text.compare(begin, end - begin, "put") == 0 ? 2 : (put == 0 ? 0 : put - 1);
    }
    if (kind == Kind::Call || kind == Kind::DynamicCall) {
        used_[kStackPointer] = written_[kStackPointer] = true;
    }
}

std::string Registers::declared() const {
    std::string text;
    for (unsigned reg = 0; reg < kStackPointer; reg++) {
        const std::string number = std::to_string(reg);
        if (count_[reg] == 0) {
            text += used_[reg] ? "uint32_t " + name(reg) + " = DATA(" + number + ");\n" : "";
            continue;
        }
        const unsigned shift = 8 * (reg - first_[reg]);
        const std::string joint = joint_name(first_[reg]);
        text += (shift == 0 ? "uint32_t " + joint + " = " : joint + " |= ") + "STORED(" + number + ") << " +
                std::to_string(shift) + "; const Byte<" + std::to_string(shift) + ", " +
                std::to_string(count_[reg]) + "> " + name(reg) + "{" + joint + "};\n";
    }
    return text + (used_[kStackPointer] ? "uint32_t sp = DATA(0x5D) | DATA(0x5E) << 8;\n" : "");
}

std::string Registers::written_back() const {
    std::string text;
    for (unsigned reg = 0; reg < kStackPointer; reg++) {
        if (written_[reg]) {
            text += " DATA(" + std::to_string(reg) + ") = static_cast<uint8_t>(" + name(reg) + ");";
        }
    }
    if (written_[kStackPointer]) {
        text += " DATA(0x5D) = static_cast<uint8_t>(sp); DATA(0x5E) = static_cast<uint8_t>(sp >> 8);";
    }
    return text;
}

} // namespace tilenca::translate
