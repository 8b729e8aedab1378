#include "app/host.h"

#include <string.h>

namespace tilenca {

namespace {

constexpr uint16_t kPaperPeriodMs = 2000;
constexpr uint16_t kPaperUpdates = 30;

bool equal(const char* a, const char* b) {
    return strcmp(a, b) == 0;
}

} // namespace

Host::Result Host::receive(uint8_t byte, Tile* tile, uint32_t now_ms, Sentence* sentence) {
    switch (reader_.feed(byte)) {
    case CommandReader::Result::Pending:
        return Result::Nothing;
    case CommandReader::Result::Damaged:
        write_nak(*tile, "CHECKSUM", "", sentence);
        return Result::Answer;
    case CommandReader::Result::TooLong:
        write_nak(*tile, "LONG", "", sentence);
        return Result::Answer;
    case CommandReader::Result::Ready:
        break;
    }
    return obey(tile, now_ms, sentence);
}

Host::Result Host::obey(Tile* tile, uint32_t now_ms, Sentence* sentence) {
    const char* name = reader_.field(0);
    uint16_t seconds;
    if (equal(name, "ASK") && reader_.fields() == 1) {
        write_hello(*tile, boot_, sentence);
    } else if (equal(name, "CHIP") && reader_.fields() == 1) {
        write_chip(*tile, boot_, sentence);
    } else if (equal(name, "SET") && reader_.fields() == 3) {
        return begin_set(*tile, sentence);
    } else if (equal(name, "BLINK") && reader_.fields() == 2 &&
               number_of(reader_.field(1), kMaxBlinkS, &seconds)) {
        blinking_ = true;
        blink_until_ms_ = now_ms + 1000UL * seconds;
        begin_ack(*tile, sentence);
        sentence->number(seconds);
        sentence->end();
    } else if (equal(name, "RESTART") && reader_.fields() == 1) {
        tile->restart();
        begin_ack(*tile, sentence);
        sentence->end();
    } else {
        const bool known = equal(name, "ASK") || equal(name, "CHIP") || equal(name, "SET") ||
                           equal(name, "BLINK") || equal(name, "RESTART");
        write_nak(*tile, known ? "VALUE" : "UNKNOWN", name, sentence);
    }
    return Result::Answer;
}

Host::Result Host::begin_set(const Tile& tile, Sentence* sentence) {
    wanted_ = tile.settings();
    if (!change(tile.model().directions ? 2 : 1, &wanted_)) {
        write_nak(tile, "VALUE", reader_.field(0), sentence);
        return Result::Answer;
    }
    return Result::Store;
}

// Changes the setting that the command names. False if there is no such setting or value.
bool Host::change(uint16_t most_leds, Settings* settings) const {
    const char* name = reader_.field(1);
    const char* text = reader_.field(2);
    uint16_t number = 0;
    if (equal(name, "preset")) {
        const bool paper = equal(text, "paper");
        settings->period_ms = paper ? kPaperPeriodMs : defaults_.period_ms;
        settings->updates = paper ? kPaperUpdates : defaults_.updates;
        return paper || equal(text, "default");
    }
    if (equal(name, "id") && number_of(text, 0xFF, &number)) {
        settings->tile_id = static_cast<uint8_t>(number);
    } else if (equal(name, "period") && number_of(text, kMaxPeriodMs, &number) && number >= kMinPeriodMs) {
        settings->period_ms = number;
    } else if (equal(name, "updates") && number_of(text, 0xFFFF, &number)) {
        settings->updates = number;
    } else if (equal(name, "brightness") && number_of(text, 0xFF, &number)) {
        settings->brightness = static_cast<uint8_t>(number);
    } else if (equal(name, "leds") && number_of(text, most_leds, &number)) {
        settings->leds = number == 2 ? kLedsMissing : number == 1 ? kLedsLinks : kLedsDark;
    } else {
        return false;
    }
    return true;
}

void Host::end_set(bool stored, Tile* tile, Sentence* sentence) {
    if (!stored) {
        write_nak(*tile, "EEPROM", reader_.field(0), sentence);
        return;
    }
    tile->apply(wanted_);
    begin_ack(*tile, sentence);
    sentence->text(reader_.field(1));
    sentence->text(reader_.field(2));
    sentence->end();
}

bool Host::blinking(uint32_t now_ms) {
    // A latch, since the clock wraps.
    blinking_ = blinking_ && static_cast<int32_t>(blink_until_ms_ - now_ms) > 0;
    return blinking_;
}

void Host::begin_ack(const Tile& tile, Sentence* sentence) const {
    sentence->begin("ACK");
    sentence->number(tile.settings().tile_id);
    sentence->text(reader_.field(0));
}

void Host::write_nak(const Tile& tile, const char* reason, const char* name, Sentence* sentence) const {
    sentence->begin("NAK");
    sentence->number(tile.settings().tile_id);
    sentence->text(reason);
    sentence->text(name);
    sentence->end();
}

} // namespace tilenca
