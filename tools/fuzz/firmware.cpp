// The targets of the firmware.
#include "targets.h"

#include <stdio.h>
#include <string.h>

#include <array>
#include <string>

#include "app/host.h"
#include "app/settings_store.h"
#include "core/link.h"
#include "model/model.h"

namespace tilenca {
namespace fuzz {

namespace {

constexpr Settings kDefaults = {0, 100, 0, 255, 0};

using Bytes = std::array<uint8_t, 2 * kSettingsSize * kBlocks>;

// What a SettingsStore takes; busy for two questions after each write.
struct Eeprom {
    Bytes* bytes;
    int* left; // writes until the power fails
    int* busy_for;

    bool busy() { return *busy_for != 0 && (*busy_for)-- != 0; }
    uint8_t read(uint8_t address) const { return bytes->at(address); }
    void write(uint8_t address, uint8_t byte) {
        if (*left > 0) {
            bytes->at(address) = byte;
        }
        --*left;
        *busy_for = 2;
    }
};

constexpr int kForEver = 1 << 30;

bool same(const Settings& a, const Settings& b) {
    return a.tile_id == b.tile_id && a.period_ms == b.period_ms && a.updates == b.updates &&
           a.brightness == b.brightness && a.leds == b.leds && a.revision == b.revision &&
           a.serial == b.serial;
}

struct Board {
    Bytes bytes;
    int left = kForEver;
    int busy_for = 0;
    bool damaged[kBlocks] = {}; // both blocks were, at the last load()
    SettingsStore<Eeprom> store{Eeprom{&bytes, &left, &busy_for}};

    Board() { bytes.fill(0xFF); }
    explicit Board(const Bytes& kept) : bytes(kept) {}

    // As at the start of a tile.
    Settings load() {
        Settings found = kDefaults;
        for (uint8_t kind = kBlocks; kind-- != 0;) {
            damaged[kind] = store.load(static_cast<Block>(kind), &found) == decltype(store)::Found::Damage;
        }
        finish();
        return found;
    }

    void finish() {
        while (store.writing()) {
        }
    }
};

// A sentence of a tile is whole, printable, and right by its checksum.
void check(const Sentence& sentence) {
    const uint8_t size = sentence.size();
    const char* text = sentence.bytes();
    must(size >= 6 && size <= kMaxSentence && text[0] == '$', "a sentence without its frame");
    uint8_t sum = 0;
    for (uint8_t i = 1; i < size - 5; ++i) {
        must(text[i] >= ' ' && text[i] <= '~', "a byte that no sentence has");
        sum ^= static_cast<uint8_t>(text[i]);
    }
    char end[6];
    snprintf(end, sizeof end, "*%02X\r\n", sum);
    must(memcmp(text + size - 5, end, 5) == 0, "a wrong end of a sentence");
}

} // namespace

void frames(const uint8_t* bytes, size_t size) {
    const uint8_t channels = model::kModel.network.channels();
    Link link(model::kModel.id, channels, 20);
    uint32_t now_ms = 0, corrupt_or_not = 0;
    for (size_t i = 0; i < size; ++i) {
        link.receive(bytes[i], now_ms);
        corrupt_or_not += bytes[i] == 0;
        if ((i & 0x3F) == 0) {
            link.tick(now_ms += bytes[i]);
        }
        const LinkCounters& counters = link.counters();
        must(counters.received + counters.corrupt + counters.foreign <= corrupt_or_not,
             "more frames than delimiters");
        must(!link.alive() || link.ever_received(), "a neighbour that was never heard");
        if (const int8_t* message = link.message()) {
            for (uint8_t c = 0; c < channels; ++c) {
                must(message[c] != -128, "a message that does not exist");
            }
        }
    }
    // What is sent after all that arrives, whatever came before.
    int8_t state[kMaxChannels] = {};
    uint8_t wire[kMaxFrame];
    Link other(model::kModel.id, channels, 20);
    link.receive(0, now_ms);
    const uint32_t received = link.counters().received;
    for (uint8_t at = 0, count = other.send(Side::South, 3, state, wire); at < count; ++at) {
        link.receive(wire[at], now_ms);
    }
    must(link.counters().received == received + 1 && link.neighbour() == 3, "a good frame was not heard");
}

void commands(const uint8_t* bytes, size_t size) {
    const Boot boot = {1, 0x1234ABCD, {0xFF, 0xD8, 0xFD, 0xCF}};
    Board board;
    Tile tile(model::kModel, board.load(), 0);
    Host host(kDefaults, boot);
    size_t at = 0;
    const auto read = [&](uint8_t* byte) { return at < size && (*byte = bytes[at++], true); };
    Sentence sentence;
    for (bool more = true; more || at < size;) {
        more = host.answer(board.store, read, &tile, static_cast<uint32_t>(at), &sentence);
        if (more) {
            check(sentence);
        }
        while (board.store.writing()) {
            more = true;
        }
        const Settings& now = tile.settings();
        must(now.period_ms >= kMinPeriodMs && now.period_ms <= kMaxPeriodMs && now.leds <= kLedsMissing,
             "a setting out of range");
    }
    must(same(Board(board.bytes).load(), tile.settings()), "EEPROM has other settings than are in force");
    const std::string ask = "$ASK*59"; // the next command is obeyed, whatever came before
    size_t asked = 0;
    const auto read_ask = [&](uint8_t* byte) {
        return asked < ask.size() && (*byte = static_cast<uint8_t>(ask[asked++]), true);
    };
    bool greeted = false;
    while (host.answer(board.store, read_ask, &tile, 0, &sentence)) {
        greeted = memcmp(sentence.bytes(), "$HELLO", 6) == 0;
    }
    must(greeted, "a tile does not greet any more");
}

void settings(const uint8_t* bytes, size_t size) {
    if (size == 0) {
        return;
    }
    Board board;
    for (size_t i = 1; i < size && i <= board.bytes.size(); ++i) {
        board.bytes[i - 1] = bytes[i];
    }
    const Settings found = board.load();
    must(found.period_ms >= kMinPeriodMs && found.period_ms <= kMaxPeriodMs && found.leds <= kLedsMissing,
         "a setting out of range");
    must(same(Board(board.bytes).load(), found), "another start finds other settings");
    Settings wanted = found;
    wanted.tile_id = static_cast<uint8_t>(found.tile_id + 1);
    wanted.revision = static_cast<uint8_t>(found.revision | 1);
    wanted.serial = static_cast<uint16_t>(found.serial + 1);
    const Block kind = bytes[0] & 0x80 ? Block::Marking : Block::Settings;
    board.left = bytes[0] & 0x1F;
    const bool whole = board.left >= 2 * kSettingsSize;
    board.store.write(kind, wanted);
    board.finish();
    const Settings after = Board(board.bytes).load();
    const bool marking = kind == Block::Marking;
    const bool is_old = marking ? after.serial == found.serial : after.tile_id == found.tile_id;
    const bool is_new = marking ? after.serial == wanted.serial : after.tile_id == wanted.tile_id;
    // Where both blocks were damaged, mending one byte may bring back what was there before.
    must(is_old || is_new || board.damaged[static_cast<uint8_t>(kind)], "neither old nor new");
    must(!whole || is_new, "not what was written");
    must(marking ? after.tile_id == found.tile_id : after.serial == found.serial, "the other block changed");
}

const std::vector<Named>& targets() {
    static const std::vector<Named> all = {
        {"frames", frames}, {"commands", commands}, {"settings", settings}};
    return all;
}

} // namespace fuzz
} // namespace tilenca
