// CRC-32 as in Ethernet, zlib and Python's binascii.crc32. A firmware's id is the CRC-32 of its image.
#pragma once

#include <stdint.h>

namespace tilenca {

class Crc32 {
  public:
    // Takes the next bytes.
    void add(const uint8_t* bytes, uint8_t size);

    // Of all bytes so far.
    uint32_t value() const { return ~register_; }

  private:
    uint32_t register_ = 0xFFFFFFFF;
};

} // namespace tilenca
