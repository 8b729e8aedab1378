// CRC-16/IBM-3740: polynomial 0x1021, initial value 0xFFFF, not reflected, no final XOR.
#pragma once

#include <stdint.h>

namespace tilenca {

uint16_t crc16(const uint8_t* bytes, uint8_t size);

} // namespace tilenca
