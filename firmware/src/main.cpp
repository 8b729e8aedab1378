// A tile: read the four sides, tick, write what it says, show it.
#include <Arduino.h>

#include "app/button.h"
#include "app/telemetry.h"
#include "app/tile.h"
#include "board/chip.h"
#include "board/face.h"
#include "board/links.h"
#include "board/pins.h"
#include "board/usart.h"
#include "model/model.h"

using namespace tilenca;

namespace {

constexpr uint32_t kHostBaud = 115200;
constexpr Settings kDefaults = {0, TILENCA_PERIOD_MS, TILENCA_UPDATES};
static_assert(TILENCA_PERIOD_MS >= kMinPeriodMs && TILENCA_PERIOD_MS <= kMaxPeriodMs, "see platformio.ini");

Settings read_settings() {
    uint8_t block[kSettingsSize];
    board::read_eeprom(block, sizeof block);
    Settings settings = kDefaults;
    parse_settings(block, &settings);
    return settings;
}

Tile tile(model::kModel, read_settings(), 0);
Telemetry telemetry;
Sentence sentence;
Button button;

void say_sentence() {
    board::usart_write(board::kHostUsart, reinterpret_cast<const uint8_t*>(sentence.bytes()),
                       sentence.size());
}

void read_sides(uint32_t now_ms) {
    for (uint8_t i = 0; i < kSides; ++i) {
        uint8_t byte;
        while (board::link_read(side_at(i), &byte)) {
            tile.receive(side_at(i), byte, now_ms);
        }
    }
}

void tick(uint32_t now_ms) {
    if (button.pressed(board::button_closed(), now_ms)) {
        tile.restart();
    }
    if (tile.tick(now_ms)) {
        telemetry.period_ended(tile);
    }
}

void write_sides() {
    for (uint8_t i = 0; i < kSides; ++i) {
        const Side side = side_at(i);
        if (tile.has_frame(side) && board::link_idle(side)) {
            uint8_t wire[kMaxFrame];
            board::link_write(side, wire, tile.take_frame(side, wire));
        }
    }
}

void show() {
    static uint8_t shown = Tile::kNothing;
    if (tile.shown() != shown) {
        shown = tile.shown();
        const Look look = shown == Tile::kNothing ? Look{} : tile.model().looks[shown];
        board::show_segments(look.segments);
        board::show_colour(look.red, look.green, look.blue);
    }
    for (uint8_t i = 0; i < kSides; ++i) {
        board::show_led(i, tile.link(side_at(i)).alive());
    }
}

void report(uint32_t now_ms) {
    while (telemetry.next(tile, now_ms, &sentence)) {
        say_sentence();
    }
}

} // namespace

void setup() {
    board::clock_begin();
    board::links_begin();
    board::face_begin();
    board::usart_begin(board::kHostUsart, kHostBaud);
    write_hello(tile, board::take_reset_cause(), &sentence);
    say_sentence();
}

void loop() {
    const uint32_t now_ms = board::now_ms();
    read_sides(now_ms);
    tick(now_ms);
    write_sides();
    show();
    report(now_ms);
    if (!tile.busy()) {
        board::sleep();
    }
}
