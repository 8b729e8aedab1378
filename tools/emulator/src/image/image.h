// What goes into a chip: flash and EEPROM contents, from an ELF file or an Intel HEX file.
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

namespace tilenca {

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

    // The function that contains a byte of flash, or "".
    std::string function_at(uint32_t byte_address) const;
};

// Reads an ELF file for AVR. Throws ImageError.
Image load_elf(const std::string& path, const std::vector<uint8_t>& bytes);

// Reads Intel HEX, flash only. Throws ImageError.
Image load_hex(const std::string& path, const std::string& text);

// Reads either, by content. Throws ImageError.
Image load_image(const std::string& path);

} // namespace tilenca
