#include "app/sentence.h"

namespace tilenca {

namespace {

char hex_digit(uint8_t value) {
    return static_cast<char>(value < 10 ? '0' + value : 'A' - 10 + value);
}

} // namespace

void Sentence::begin(const char* name) {
    bytes_[0] = '$';
    size_ = 1;
    checksum_ = 0;
    while (*name != '\0') {
        put(*name++);
    }
}

void Sentence::number(uint32_t value) {
    char digits[10];
    uint8_t count = 0;
    do {
        digits[count++] = static_cast<char>('0' + value % 10);
        value /= 10;
    } while (value != 0);
    put(',');
    while (count != 0) {
        put(digits[--count]);
    }
}

void Sentence::hex(uint16_t value, uint8_t digits) {
    put(',');
    for (uint8_t i = digits; i > 0; --i) {
        put(hex_digit(value >> (4 * (i - 1)) & 0xF));
    }
}

void Sentence::more_hex(uint8_t value) {
    put(hex_digit(value >> 4));
    put(hex_digit(value & 0xF));
}

void Sentence::end() {
    bytes_[size_++] = '*';
    bytes_[size_++] = hex_digit(checksum_ >> 4);
    bytes_[size_++] = hex_digit(checksum_ & 0xF);
    bytes_[size_++] = '\r';
    bytes_[size_++] = '\n';
}

void Sentence::put(char character) {
    if (size_ < kMaxSentence - kEndSize) {
        bytes_[size_++] = character;
        checksum_ ^= static_cast<uint8_t>(character);
    }
}

} // namespace tilenca
