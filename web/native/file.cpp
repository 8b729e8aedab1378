// Files as WebAssembly sees them: whoever loads the module has them (web/src/module.js).
#include "image/file.h"

#include "image/image.h"

#define TILENCA_IMPORT(name) __attribute__((import_module("files"), import_name(name)))

extern "C" {
// The bytes of a file; below 0: there is no such file.
TILENCA_IMPORT("size") int tilenca_file_size(const char* path, size_t length);
// Copies all of them.
TILENCA_IMPORT("read") void tilenca_file_read(const char* path, size_t length, uint8_t* bytes);
}

namespace tilenca {

std::vector<uint8_t> read_file(const std::string& path) {
    const int size = tilenca_file_size(path.data(), path.size());
    if (size < 0) {
        throw ImageError(path + ": no such file; hand its bytes over first");
    }
    std::vector<uint8_t> bytes(static_cast<size_t>(size));
    tilenca_file_read(path.data(), path.size(), bytes.data());
    return bytes;
}

} // namespace tilenca
