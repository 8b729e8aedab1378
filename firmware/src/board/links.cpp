#include "board/links.h"

#include "board/gpio.h"
#include "board/south_uart.h"
#include "board/usart.h"

namespace tilenca {
namespace board {

namespace {

constexpr uint32_t kLinkBaud = 38400;

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
            usart_begin(kSideUsart[i], kLinkBaud);
        }
    }
}

bool link_read(Side side, uint8_t* byte) {
    return side == Side::South ? south_read(byte) : usart_read(usart_of(side), byte);
}

uint16_t link_overruns(Side side) {
    return side == Side::South ? south_overruns() : usart_overruns(usart_of(side));
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

} // namespace board
} // namespace tilenca
