#include "image/image.h"

#include "image/file.h"

namespace tilenca {

std::string Image::function_at(uint32_t byte_address) const {
    const Symbol* best = nullptr;
    for (const Symbol& symbol : symbols) {
        if (symbol.address <= byte_address && byte_address < symbol.address + symbol.size &&
            (best == nullptr || symbol.address > best->address)) {
            best = &symbol;
        }
    }
    return best == nullptr ? "" : best->name;
}

const Symbol* Image::find(const std::string& name) const {
    for (const Symbol& symbol : symbols) {
        if (symbol.name == name) {
            return &symbol;
        }
    }
    return nullptr;
}

uint32_t Image::data_end() const {
    for (const char* name : {"__heap_start", "_end"}) {
        if (const Symbol* end = find(name); end != nullptr && end->address >= kDataStart) {
            return (end->address - kDataStart) & 0xFFFF;
        }
    }
    return 0;
}

Image load_image(const std::string& path) {
    const std::vector<uint8_t> bytes = read_file(path);
    if (bytes.empty()) {
        throw ImageError(path + ": cannot be read, or empty; give the ELF or Intel HEX file of a build");
    }
    if (bytes[0] == ':') {
        return load_hex(path, std::string(bytes.begin(), bytes.end()));
    }
    return load_elf(path, bytes);
}

} // namespace tilenca
