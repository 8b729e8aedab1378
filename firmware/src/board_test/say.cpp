#include "board_test/say.h"

#include "board/usart.h"

namespace tilenca {

void say(char character) {
    const uint8_t byte = static_cast<uint8_t>(character);
    while (!board::usart_write(board::kHostUsart, &byte, 1)) {
    }
}

void say(PGM_P text) {
    for (char character; (character = static_cast<char>(pgm_read_byte(text))) != '\0'; ++text) {
        say(character);
    }
}

void say(board::Pin pin) {
    say('P');
    say(pin.port);
    say(static_cast<char>('0' + pin.bit));
}

void say_number(uint16_t value) {
    if (value >= 10) {
        say_number(value / 10);
    }
    say(static_cast<char>('0' + value % 10));
}

void say_hex(uint8_t value) {
    for (uint8_t shift = 8; shift != 0; shift -= 4) {
        const uint8_t digit = value >> (shift - 4) & 0xF;
        say(static_cast<char>(digit < 10 ? '0' + digit : 'A' - 10 + digit));
    }
}

void say_pass(PGM_P step) {
    say(step);
    say(PSTR(": pass"));
}

void say_fail(PGM_P step) {
    say(step);
    say(PSTR(": FAIL, "));
}

void say_end() {
    say('\r');
    say('\n');
}

} // namespace tilenca
