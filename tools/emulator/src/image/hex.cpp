// Intel HEX: the form in which bootloaders are shipped.
#include "image/image.h"

#include <sstream>

namespace tilenca {

namespace {

constexpr uint32_t kFlashEnd = 0x40000;

int digit(char c) {
    if (c >= '0' && c <= '9') {
        return c - '0';
    }
    if (c >= 'A' && c <= 'F') {
        return c - 'A' + 10;
    }
    return c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1;
}

// The bytes of one record, checked; empty: not a record.
std::vector<uint8_t> record(const std::string& line) {
    std::vector<uint8_t> bytes;
    if (line.size() < 11 || line[0] != ':' || line.size() % 2 == 0) {
        return {};
    }
    uint8_t sum = 0;
    for (size_t i = 1; i < line.size(); i += 2) {
        const int high = digit(line[i]), low = digit(line[i + 1]);
        if (high < 0 || low < 0) {
            return {};
        }
        bytes.push_back(static_cast<uint8_t>(high << 4 | low));
        sum = static_cast<uint8_t>(sum + bytes.back());
    }
    return sum == 0 && bytes.size() == bytes[0] + 5u ? bytes : std::vector<uint8_t>{};
}

} // namespace

Image load_hex(const std::string& path, const std::string& text) {
    Image image;
    std::istringstream lines(text);
    std::string line;
    uint32_t base = 0;
    for (int number = 1; std::getline(lines, line); number++) {
        while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) {
            line.pop_back();
        }
        if (line.empty()) {
            continue;
        }
        const std::string where = path + ":" + std::to_string(number) + ": ";
        const std::vector<uint8_t> bytes = record(line);
        if (bytes.empty()) {
            throw ImageError(where + "not a sound Intel HEX record; build or copy it again");
        }
        const uint32_t address = base + (bytes[1] << 8 | bytes[2]), count = bytes[0];
        if (bytes[3] == 1) {
            if (image.flash.empty()) {
                throw ImageError(path + ": contains no program; give the .hex of a build");
            }
            return image;
        }
        if ((bytes[3] == 2 || bytes[3] == 4) && count == 2) {
            base = static_cast<uint32_t>(bytes[4] << 8 | bytes[5]) << (bytes[3] == 2 ? 4 : 16);
        } else if (bytes[3] == 0 && count != 0) {
            if (address >= kFlashEnd || count > kFlashEnd - address) {
                throw ImageError(where + "beyond the 256 KiB of flash; build for the ATmega2560");
            }
            image.flash.push_back({address, {bytes.begin() + 4, bytes.end() - 1}});
        } else if (bytes[3] != 0 && bytes[3] != 3 && bytes[3] != 5) { // those two: where a PC would begin
            throw ImageError(where + "a record of a kind or length that there is not (" +
                             std::to_string(bytes[3]) + "); build or copy it again");
        }
    }
    throw ImageError(path + ": truncated: no end record; build or copy it again");
}

} // namespace tilenca
