// The only place that knows where files are: on a disk, or in a browser (web/native/file.cpp).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace tilenca {

// The whole content. Throws ImageError: there is no such file.
std::vector<uint8_t> read_file(const std::string& path);

} // namespace tilenca
