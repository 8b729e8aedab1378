// What the chip says of itself: fuses, bootloader, EEPROM. Each says its result, and returns whether it
// passes.
#pragma once

namespace tilenca {

bool check_fuses();

// By its id, unless the lock bits hide it.
bool check_bootloader();

// Writes two patterns to a byte that no setting uses, and puts back what was there. Takes 10 ms.
bool check_eeprom();

} // namespace tilenca
