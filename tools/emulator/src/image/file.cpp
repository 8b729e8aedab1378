#include "image/file.h"

#include "image/image.h"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>

namespace tilenca {

std::vector<uint8_t> read_file(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    if (!file) {
        throw ImageError(path + ": " + std::strerror(errno) + "; build the firmware first");
    }
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

} // namespace tilenca
