// What goes into a chip: flash and EEPROM contents, from an ELF file or an Intel HEX file.
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

namespace tilenca {

constexpr uint32_t kDataStart = 0x800000; // of data memory, in an ELF file's addresses

// One line: the file, the fact, the remedy.
struct ImageError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

struct Block {
    uint32_t address;
    std::vector<uint8_t> bytes;
};

struct Symbol {
    std::string name;
    uint32_t address; // flash: bytes from 0; data space: from 0x800000
    uint32_t size;
};

struct Image {
    std::vector<Block> flash;
    std::vector<Block> eeprom;
    std::vector<Symbol> symbols;
    std::vector<uint8_t> fuses; // low, high, extended, as far as the image has them
    std::vector<uint8_t> lock;

    // The function that contains a byte of flash, or "".
    std::string function_at(uint32_t byte_address) const;
    // A symbol by its name, or null.
    const Symbol* find(const std::string& name) const;
    // The first address in data memory that no variable lies at or beyond; 0: not known.
    uint32_t data_end() const;
};

// Reads an ELF file for AVR. Throws ImageError.
Image load_elf(const std::string& path, const std::vector<uint8_t>& bytes);

// Reads Intel HEX, flash only. Throws ImageError.
Image load_hex(const std::string& path, const std::string& text);

// Reads either, by content. Throws ImageError.
Image load_image(const std::string& path);

} // namespace tilenca
