#include "board/links.h"

#include <avr/io.h>

#include "board/gpio.h"
#include "board/ring.h"
#include "board/south_uart.h"
#include "board/usart.h"
#include "board/usart_layout.h"

namespace tilenca {
namespace board {

namespace {

constexpr uint32_t us_of_bits(uint32_t bits, uint32_t baud) {
    return bits * 1000000 / baud;
}

constexpr uint8_t kByteBits = 10; // start, eight data, stop
static_assert(us_of_bits(kByteBits*(QUARTER_BYTES - 1), kRowBaud) >= kReadEveryUs, "a USART's queue");
static_assert(us_of_bits(sizeof(Page) - 1, kLinkBaud) >= kReadEveryUs, "the south link's ring of edges");

uint8_t usart_of(Side side) {
    return kSideUsart[index_of(side)];
}

} // namespace

void links_begin() {
    for (uint8_t i = 0; i < kSides; ++i) {
        if (side_at(i) == Side::South) {
            south_begin();
        } else {
            pull_up(kSideRx[i]);
            link_begin(side_at(i), baud_of(side_at(i)));
        }
    }
}

void link_begin(Side side, uint32_t baud) {
    usart_begin(usart_of(side), baud);
}

bool link_read(Side side, uint8_t* byte) {
    return side == Side::South ? south_read(byte) : usart_read(usart_of(side), byte);
}

bool link_idle(Side side) {
    return side == Side::South ? south_idle() : usart_idle(usart_of(side));
}

void link_write(Side side, const uint8_t* bytes, uint8_t size) {
    if (side == Side::South) {
        south_write(bytes, size);
    } else {
        usart_write(usart_of(side), bytes, size);
    }
}

uint16_t link_framing_errors(Side side) {
    return side == Side::South ? south_framing_errors() : usart_framing_errors(usart_of(side));
}

uint8_t low_lines() {
    static_assert(kSideRx[0].port == 'H' && kSideRx[1].port == 'D' && kSideRx[3].port == 'J',
                  "PINH, PIND, PINJ");
    uint8_t low = 0;
    low |= PINH & mask_of(kSideRx[0]) ? 0 : 1 << 0;
    low |= PIND & mask_of(kSideRx[1]) ? 0 : 1 << 1;
    low |= PINK & mask_of(kSouthRx) ? 0 : 1 << 2;
    low |= PINJ & mask_of(kSideRx[3]) ? 0 : 1 << 3;
    return low;
}

uint16_t link_overruns(Side side) {
    return side == Side::South ? south_overruns() : usart_overruns(usart_of(side));
}

} // namespace board
} // namespace tilenca
