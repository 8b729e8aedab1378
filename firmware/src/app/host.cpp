#include "app/host.h"

#include <string.h>

#ifdef __AVR__
#pragma GCC optimize("Os") // it runs once in a while, and flash is short
#endif

namespace tilenca {

namespace {

constexpr uint16_t kPaperPeriodMs = 2000;
constexpr uint16_t kPaperUpdates = 30;

bool equal(const char* a, const char* b) {
    return strcmp(a, b) == 0;
}

enum Command : uint8_t { kAsk, kChip, kSet, kMark, kBlink, kRestart, kNone };
constexpr const char* kCommands[kNone] = {"ASK", "CHIP", "SET", "MARK", "BLINK", "RESTART"};
constexpr uint8_t kFields[kNone] = {1, 1, 3, 0, 2, 1}; // the name is one; MARK has three or four

enum Setting : uint8_t { kId, kPeriod, kUpdates, kBrightness, kLeds, kNoSetting };
constexpr const char* kSettings[kNoSetting] = {"id", "period", "updates", "brightness", "leds"};
constexpr uint16_t kMost[kLeds] = {0xFF, kMaxPeriodMs, 0xFFFF, 0xFF}; // of the LEDs: by the model

// The index of a name, or the number of names.
template <uint8_t kNames>
uint8_t index_in(const char* const (&names)[kNames], const char* name) {
    uint8_t index = 0;
    while (index < kNames && !equal(names[index], name)) {
        ++index;
    }
    return index;
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
    const uint8_t command = index_in(kCommands, name);
    uint16_t seconds;
    if (command == kMark) {
        return begin_mark(*tile, sentence);
    }
    if (command == kNone || reader_.fields() != kFields[command]) {
        write_nak(*tile, command == kNone ? "UNKNOWN" : "VALUE", name, sentence);
    } else if (command == kAsk) {
        write_hello(*tile, boot_, sentence);
    } else if (command == kChip) {
        write_chip(*tile, boot_, sentence);
    } else if (command == kSet) {
        return begin_set(*tile, sentence);
    } else if (command == kRestart) {
        tile->restart();
        begin_ack(*tile, sentence);
        sentence->end();
    } else if (number_of(reader_.field(1), kMaxBlinkS, &seconds)) {
        blinking_ = true;
        blink_until_ms_ = now_ms + 1000UL * seconds;
        begin_ack(*tile, sentence);
        sentence->number(seconds);
        sentence->end();
    } else {
        write_nak(*tile, "VALUE", name, sentence);
    }
    return Result::Answer;
}

Host::Result Host::begin_set(const Tile& tile, Sentence* sentence) {
    wanted_ = tile.settings();
    wanted_in_ = Block::Settings;
    if (!change(tile.model().directions ? 2 : 1, &wanted_)) {
        write_nak(tile, "VALUE", reader_.field(0), sentence);
        return Result::Answer;
    }
    return Result::Store;
}

// A marking is for good: another one is refused, unless the command says that it is to replace it.
Host::Result Host::begin_mark(const Tile& tile, Sentence* sentence) {
    uint16_t revision = 0, serial = 0;
    const bool replace = equal(reader_.field(3), "replace");
    const char* refusal = nullptr;
    wanted_ = tile.settings();
    wanted_in_ = Block::Marking;
    if (!number_of(reader_.field(1), 0xFF, &revision) || !number_of(reader_.field(2), 0xFFFF, &serial) ||
        revision == 0 || reader_.fields() != (replace ? 4 : 3)) {
        refusal = "VALUE";
    } else if (wanted_.revision != 0 && !replace &&
               (wanted_.revision != revision || wanted_.serial != serial)) {
        refusal = "MARKED";
    }
    if (refusal != nullptr) {
        write_nak(tile, refusal, reader_.field(0), sentence);
        return Result::Answer;
    }
    wanted_.revision = static_cast<uint8_t>(revision);
    wanted_.serial = serial;
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
    const uint8_t setting = index_in(kSettings, name);
    if (setting == kNoSetting || !number_of(text, setting == kLeds ? most_leds : kMost[setting], &number)) {
        return false;
    }
    if (setting == kId) {
        settings->tile_id = static_cast<uint8_t>(number);
    } else if (setting == kPeriod) {
        settings->period_ms = number;
        return number >= kMinPeriodMs;
    } else if (setting == kUpdates) {
        settings->updates = number;
    } else if (setting == kBrightness) {
        settings->brightness = static_cast<uint8_t>(number);
    } else {
        settings->leds = number == 2 ? kLedsMissing : number == 1 ? kLedsLinks : kLedsDark;
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
