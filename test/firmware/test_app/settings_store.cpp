#include <doctest/doctest.h>

#include <vector>

#include "eeprom.h"

using namespace tilenca;
using test::Eeprom;
using test::kTorn;
using test::Memory;
using test::memory_of;
using test::Store;
using test::Torn;

namespace {

// From one to the next, every byte changes that carries something.
constexpr Settings kDefaults = {0, 100, 0, 255};
constexpr Settings kOld = {7, 0x0102, 0x0304, 40};
constexpr Settings kNew = {8, 0x1112, 0x1314, 41};
constexpr Settings kNewer = {9, 0x2122, 0x2324, 42};
constexpr int kWritten = 2 * (kSettingsSize - 4); // all but the magic, the version and the reserved byte

bool same(const Settings& a, const Settings& b) {
    return a.tile_id == b.tile_id && a.period_ms == b.period_ms && a.updates == b.updates &&
           a.brightness == b.brightness;
}

void write(Memory& memory, const Settings& settings, Block kind = Block::Settings) {
    Store store{Eeprom(&memory)};
    store.write(kind, settings);
    while (store.writing()) {
    }
}

// Starts a tile, which has power as long as `memory` says; returns what it found.
Settings start(Memory& memory, Block kind = Block::Settings) {
    Store store{Eeprom(&memory)};
    Settings settings = kDefaults;
    CHECK(store.load(kind, &settings) == Store::Found::Settings);
    while (store.writing()) {
    }
    return settings;
}

// The memory after the power failed in the write after `at` others of what `act` does.
template <class Act>
Memory cut_off(Memory memory, int at, Torn torn, Act act) {
    memory.writes = 0;
    memory.power_fails = at;
    memory.torn = torn;
    act(memory);
    CHECK_FALSE(memory.has_power());
    memory.power_fails = Memory::kNever;
    memory.busy_for = 3; // a reset does not stop it
    return memory;
}

} // namespace

TEST_CASE("what was written is found at the next start, and costs no more writes than bytes that differ") {
    Memory memory = memory_of(kOld);
    write(memory, kNew);
    CHECK(memory.writes == kWritten);
    CHECK(memory.bytes == memory_of(kNew).bytes);
    CHECK(same(start(memory), kNew));
    write(memory, kNew);
    CHECK(memory.writes == kWritten);
}

TEST_CASE("a blank EEPROM has nothing, a damaged one is told from it, and neither changes the settings") {
    Memory memory;
    Settings settings = kDefaults;
    CHECK(Store{Eeprom(&memory)}.load(Block::Settings, &settings) == Store::Found::Nothing);
    memory.bytes = memory_of(kOld).bytes;
    memory.bytes[3] ^= 1;
    memory.bytes[kSettingsSize + 5] ^= 1;
    CHECK(Store{Eeprom(&memory)}.load(Block::Settings, &settings) == Store::Found::Damage);
    CHECK(same(settings, kDefaults));
    CHECK(memory.writes == 0);
}

TEST_CASE("only the second block is whole: it is found, and the first mended") {
    for (int damaged = 0; damaged < kSettingsSize; ++damaged) {
        CAPTURE(damaged);
        Memory memory = memory_of(kOld);
        memory.bytes[damaged] ^= 0x10;
        CHECK(same(start(memory), kOld));
        CHECK(memory.bytes == memory_of(kOld).bytes);
        CHECK(memory.writes == 1);
    }
}

TEST_CASE("when the power fails in any byte, the old settings are found or the new ones, and new for ever") {
    bool is_new = false;
    for (int at = 0; at < kWritten; ++at) {
        for (const Torn torn : kTorn) {
            CAPTURE(at);
            CAPTURE(static_cast<int>(torn));
            Memory memory = cut_off(memory_of(kOld), at, torn, [](Memory& cut) { write(cut, kNew); });
            const Settings found = start(memory);
            CHECK((same(found, kNew) || (!is_new && same(found, kOld))));
            is_new = same(found, kNew);
            CHECK(same(start(memory), found));
        }
    }
    CHECK(is_new);
}

TEST_CASE("the power may fail in a first write, while that is mended, and in a second write") {
    for (int at = 0; at < kWritten; ++at) {
        for (const Torn torn : kTorn) {
            CAPTURE(at);
            const Memory once = cut_off(memory_of(kOld), at, torn, [](Memory& cut) { write(cut, kNew); });
            Memory mended = once;
            const Settings found = start(mended);
            const int mending = mended.writes - once.writes;
            for (int mend_at = 0; mend_at < mending; ++mend_at) {
                CAPTURE(mend_at);
                Memory twice = cut_off(once, mend_at, torn, [](Memory& cut) { start(cut); });
                CHECK(same(start(twice), found));
            }
            mended.writes = 0;
            Memory whole = mended;
            write(whole, kNewer);
            for (int second_at = 0; second_at < whole.writes; ++second_at) {
                CAPTURE(second_at);
                Memory twice = cut_off(mended, second_at, torn, [](Memory& cut) { write(cut, kNewer); });
                const Settings last = start(twice);
                CHECK((same(last, found) || same(last, kNewer)));
            }
        }
    }
}

TEST_CASE("a worn byte in either block is seen, and the old settings written back") {
    for (int worn = 0; worn < 2 * kSettingsSize; ++worn) {
        CAPTURE(worn);
        Memory memory = memory_of(kOld);
        memory.worn = worn;
        Store store{Eeprom(&memory)};
        store.write(Block::Settings, kNew);
        while (store.writing()) {
        }
        const bool carries = memory.bytes != memory_of(kNew).bytes;
        CHECK(store.verify() == !carries);
        if (carries) {
            store.write(Block::Settings, kOld);
            while (store.writing()) {
            }
            CHECK(store.verify());
            CHECK(same(start(memory), kOld));
        }
    }
}

TEST_CASE("a marking is written beside the settings, and old or new whenever the power fails") {
    const Settings old = {7, 0x0102, 0x0304, 40, 0, 1, 0x0506},
                   marked = {7, 0x0102, 0x0304, 40, 0, 2, 0x1516};
    constexpr int kMarkingWritten = 2 * 5; // revision, serial number, CRC
    bool is_new = false;
    for (int at = 0; at < kMarkingWritten; ++at) {
        for (const Torn torn : kTorn) {
            CAPTURE(at);
            Memory memory =
                cut_off(memory_of(old), at, torn, [&](Memory& cut) { write(cut, marked, Block::Marking); });
            const Settings found = start(memory, Block::Marking);
            const Settings& whole = found.revision == marked.revision ? marked : old;
            CHECK(found.revision == whole.revision);
            CHECK(found.serial == whole.serial);
            CHECK((!is_new || found.revision == marked.revision));
            is_new = found.revision == marked.revision;
            CHECK(start(memory, Block::Marking).revision == whole.revision);
            CHECK(same(start(memory), old));
        }
    }
    CHECK(is_new);
}

TEST_CASE("a first marking is there or not, and damage of one kind of block harms no other") {
    const Settings marked = {7, 0x0102, 0x0304, 40, 0, 2, 0x1516};
    Memory blank = memory_of(kOld);
    write(blank, marked, Block::Marking);
    CHECK(blank.bytes == memory_of(marked).bytes);
    for (int at = 0; at < kSettingsSize * 2; ++at) {
        Memory memory = cut_off(memory_of(kOld), at, Torn::Erased,
                                [&](Memory& cut) { write(cut, marked, Block::Marking); });
        memory.busy_for = 0;
        Settings found = kDefaults;
        Store store{Eeprom(&memory)};
        if (store.load(Block::Marking, &found) == Store::Found::Settings) {
            CHECK(found.serial == 0x1516);
        } else {
            CHECK(found.revision == 0);
        }
        CHECK(store.load(Block::Settings, &found) == Store::Found::Settings);
        CHECK(same(found, kOld));
    }
}
