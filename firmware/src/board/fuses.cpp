#include "board/fuses.h"

#include <avr/boot.h>
#include <util/atomic.h>

namespace tilenca {
namespace board {

Fuses fuses() {
    Fuses found = {};
    ATOMIC_BLOCK(ATOMIC_RESTORESTATE) { // the chip takes LPM for this for three cycles only
        found.low = boot_lock_fuse_bits_get(GET_LOW_FUSE_BITS);
        found.high = boot_lock_fuse_bits_get(GET_HIGH_FUSE_BITS);
        found.extended = boot_lock_fuse_bits_get(GET_EXTENDED_FUSE_BITS);
        found.lock = boot_lock_fuse_bits_get(GET_LOCK_BITS);
    }
    return found;
}

} // namespace board
} // namespace tilenca
