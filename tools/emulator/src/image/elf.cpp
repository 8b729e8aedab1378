// ELF32, little-endian, as avr-gcc writes it.
#include "image/image.h"

#include <algorithm>

namespace tilenca {

namespace {

constexpr uint32_t kHeaderBytes = 52, kSegmentBytes = 32, kSectionBytes = 40, kSymbolBytes = 16;
constexpr uint16_t kMachineAvr = 83;
constexpr uint32_t kArchitectureMask = 0x7F, kArchitectureAvr6 = 6;
constexpr uint32_t kSegmentLoad = 1, kSectionSymbols = 2;
constexpr uint32_t kFlashEnd = 0x40000, kEepromStart = 0x810000, kEepromBytes = 4096;
constexpr uint32_t kFuseStart = 0x820000, kLockStart = 0x830000;
constexpr uint32_t kMostSymbolNameBytes = 4096;

class Reader {
  public:
    Reader(const std::string& path, const std::vector<uint8_t>& bytes) : path_(path), bytes_(bytes) {}

    [[noreturn]] void fail(const std::string& fact, const std::string& remedy) const {
        throw ImageError(path_ + ": " + fact + "; " + remedy);
    }
    void need(uint64_t offset, uint64_t count, const char* what) const {
        if (offset + count > bytes_.size()) {
            fail("truncated: " + std::string(what) + " ends at byte " + std::to_string(offset + count) +
                     " of a file of " + std::to_string(bytes_.size()),
                 "build or copy it again");
        }
    }
    uint32_t word(uint64_t at) const { return half(at) | static_cast<uint32_t>(half(at + 2)) << 16; }
    uint16_t half(uint64_t at) const { return static_cast<uint16_t>(bytes_[at] | bytes_[at + 1] << 8); }
    const std::vector<uint8_t>& bytes() const { return bytes_; }
    std::string text(uint64_t at, uint64_t end) const {
        end = std::min<uint64_t>({end, bytes_.size(), at + kMostSymbolNameBytes});
        std::string name;
        for (; at < end && bytes_[at] != 0; at++) {
            name += static_cast<char>(bytes_[at]);
        }
        return name;
    }

  private:
    const std::string& path_;
    const std::vector<uint8_t>& bytes_;
};

void check_header(const Reader& file) {
    const std::vector<uint8_t>& bytes = file.bytes();
    const bool magic =
        bytes.size() >= 4 && bytes[0] == 0x7F && bytes[1] == 'E' && bytes[2] == 'L' && bytes[3] == 'F';
    if (!magic) {
        file.fail("neither an ELF nor an Intel HEX file", "give the firmware.elf of a build");
    }
    file.need(0, kHeaderBytes, "the header");
    if (bytes[4] != 1 || bytes[5] != 1 || file.half(18) != kMachineAvr) {
        file.fail("an ELF file for another machine (e_machine " + std::to_string(file.half(18)) +
                      ", AVR is 83)",
                  "build for the ATmega2560");
    }
    if (const uint32_t architecture = file.word(36) & kArchitectureMask; architecture != kArchitectureAvr6) {
        file.fail("built for AVR architecture " + std::to_string(architecture) + ", the ATmega2560 is avr6",
                  "build with -mmcu=atmega2560");
    }
    if (file.half(16) != 2) {
        file.fail("not a linked program (e_type " + std::to_string(file.half(16)) + ")",
                  "give the linked .elf");
    }
}

void read_segment(const Reader& file, uint64_t header, Image& image) {
    const uint32_t offset = file.word(header + 4), address = file.word(header + 12),
                   size = file.word(header + 16);
    if (file.word(header) != kSegmentLoad || size == 0) {
        return;
    }
    file.need(offset, size, "a segment");
    const auto from = file.bytes().begin() + offset;
    const std::vector<uint8_t> bytes(from, from + size);
    if (address < kFlashEnd) {
        if (size > kFlashEnd - address) {
            file.fail("its program ends beyond the 256 KiB of flash", "make it smaller");
        }
        image.flash.push_back({address, bytes});
    } else if (address >= kEepromStart && address < kEepromStart + kEepromBytes) {
        if (size > kEepromStart + kEepromBytes - address) {
            file.fail("its EEPROM contents end beyond 4 KiB", "make them smaller");
        }
        image.eeprom.push_back({address - kEepromStart, bytes});
    }
    if (address == kFuseStart) {
        image.fuses = bytes;
    } else if (address == kLockStart) {
        image.lock = bytes;
    }
}

void read_symbols(const Reader& file, uint64_t section, uint64_t sections, uint64_t count, Image& image) {
    const uint32_t offset = file.word(section + 16), size = file.word(section + 20),
                   link = file.word(section + 24);
    if (link >= count) {
        return;
    }
    file.need(offset, size, "the symbol table");
    const uint64_t strings = sections + uint64_t{link} * kSectionBytes;
    const uint64_t names = file.word(strings + 16), names_end = names + file.word(strings + 20);
    for (uint64_t at = offset; at + kSymbolBytes <= uint64_t{offset} + size; at += kSymbolBytes) {
        const unsigned type = file.bytes()[at + 12] & 15;
        const bool is_defined = file.half(at + 14) != 0;
        if (type <= 2 && is_defined) { // an object, a function, or an address of the linker's
            const std::string name = file.text(names + file.word(at), names_end);
            if (!name.empty()) {
                image.symbols.push_back({name, file.word(at + 4), file.word(at + 8)});
            }
        }
    }
}

} // namespace

Image load_elf(const std::string& path, const std::vector<uint8_t>& bytes) {
    const Reader file(path, bytes);
    check_header(file);
    Image image;
    const uint64_t segments = file.word(28), segment_count = file.half(44);
    if (segment_count != 0 && file.half(42) != kSegmentBytes) {
        file.fail("program headers of an unknown size", "build it again");
    }
    file.need(segments, segment_count * kSegmentBytes, "the program headers");
    for (uint64_t i = 0; i < segment_count; i++) {
        read_segment(file, segments + i * kSegmentBytes, image);
    }
    if (image.flash.empty()) {
        file.fail("contains no program", "give the linked .elf");
    }
    const uint64_t sections = file.word(32), section_count = sections == 0 ? 0 : file.half(48);
    if (section_count != 0 && file.half(46) == kSectionBytes) {
        file.need(sections, section_count * kSectionBytes, "the section headers");
        for (uint64_t i = 0; i < section_count; i++) {
            if (const uint64_t at = sections + i * kSectionBytes; file.word(at + 4) == kSectionSymbols) {
                read_symbols(file, at, sections, section_count, image);
            }
        }
    }
    return image;
}

} // namespace tilenca
