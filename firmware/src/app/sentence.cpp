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
    more(name);
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

void Sentence::hex(uint32_t value, uint8_t digits) {
    put(',');
    more_hex(value, digits);
}

void Sentence::text(const char* characters) {
    put(',');
    more(characters);
}

void Sentence::more_hex(uint32_t value, uint8_t digits) {
    while (digits != 0) {
        --digits;
        put(hex_digit(static_cast<uint8_t>(value >> (4 * digits)) & 0xF));
    }
}

void Sentence::more(const char* characters) {
    while (*characters != '\0') {
        put(*characters++);
    }
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
