#include "app/command.h"

namespace tilenca {

namespace {

constexpr uint8_t kNoDigit = 0xFF;

uint8_t value_of_digit(uint8_t byte) {
    if (byte >= '0' && byte <= '9') {
        return byte - '0';
    }
    return byte >= 'A' && byte <= 'F' ? byte - 'A' + 10 : kNoDigit;
}

} // namespace

CommandReader::Result CommandReader::feed(uint8_t byte) {
    if (byte == '$') {
        const bool cut_off = stage_ != Stage::Outside && (size_ != 0 || stage_ != Stage::Body);
        stage_ = Stage::Body;
        size_ = 0;
        fields_ = 1;
        checksum_ = 0;
        return cut_off ? Result::Damaged : Result::Pending;
    }
    if (stage_ == Stage::Outside) {
        return Result::Pending;
    }
    if (stage_ == Stage::Body) {
        return body(byte);
    }
    const uint8_t digit = value_of_digit(byte);
    if (digit == kNoDigit) {
        return end(Result::Damaged);
    }
    if (stage_ == Stage::FirstDigit) {
        checksum_ ^= digit << 4;
        stage_ = Stage::SecondDigit;
        return Result::Pending;
    }
    return end(checksum_ == digit ? Result::Ready : Result::Damaged);
}

CommandReader::Result CommandReader::body(uint8_t byte) {
    if (byte == '*') {
        bytes_[size_] = '\0';
        stage_ = Stage::FirstDigit;
        return Result::Pending;
    }
    if (byte < ' ' || byte > '~') {
        return end(Result::Damaged);
    }
    if (size_ == sizeof bytes_ - 1) {
        return end(Result::TooLong);
    }
    checksum_ ^= byte;
    fields_ += byte == ',';
    bytes_[size_++] = byte == ',' ? '\0' : static_cast<char>(byte);
    return Result::Pending;
}

CommandReader::Result CommandReader::end(Result result) {
    stage_ = Stage::Outside;
    return result;
}

const char* CommandReader::field(uint8_t index) const {
    uint8_t at = 0;
    while (index != 0 && at < size_) {
        index -= bytes_[at++] == '\0';
    }
    return index == 0 ? bytes_ + at : "";
}

bool number_of(const char* field, uint16_t most, uint16_t* number) {
    uint32_t value = 0;
    for (const char* at = field; *at != '\0'; ++at) {
        if (*at < '0' || *at > '9' || value > most) {
            return false;
        }
        value = 10 * value + static_cast<uint8_t>(*at - '0');
    }
    if (*field == '\0' || value > most) {
        return false;
    }
    *number = static_cast<uint16_t>(value);
    return true;
}

} // namespace tilenca
