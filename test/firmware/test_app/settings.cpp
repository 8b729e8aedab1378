#include <doctest/doctest.h>

#include <string.h>

#include "../support.h"
#include "app/button.h"
#include "app/settings.h"

using namespace tilenca;

namespace {

struct SettingsCase {
    const char* name;
    const char* block;
    const char* meaning;
};

const SettingsCase kCases[] = {
#define CASE(name, block, meaning) {name, block, meaning},
#include "settings.inc"
#undef CASE
};

std::string meaning_of(const std::vector<uint8_t>& bytes) {
    uint8_t block[kSettingsSize];
    REQUIRE(bytes.size() == sizeof block);
    memcpy(block, bytes.data(), sizeof block);
    Settings settings = {99, 9999, 999, 9, 0};
    if (!parse_settings(Block::Settings, block, &settings)) {
        CHECK(settings.tile_id == 99);
        CHECK(settings.period_ms == 9999);
        CHECK(settings.updates == 999);
        CHECK(settings.brightness == 9);
        return "ignored";
    }
    return std::to_string(settings.tile_id) + " " + std::to_string(settings.period_ms) + " " +
           std::to_string(settings.updates) + " " + std::to_string(settings.brightness) +
           (settings.leds == kLedsDark    ? " 0"
            : settings.leds == kLedsLinks ? " 1"
                                          : " 2");
}

} // namespace

TEST_CASE("every case of the shared table") {
    for (const SettingsCase& settings_case : kCases) {
        CAPTURE(settings_case.name);
        CHECK(meaning_of(test::bytes_of_hex(settings_case.block)) == settings_case.meaning);
    }
}

TEST_CASE("writing gives the block of every case that is not ignored") {
    int written = 0;
    for (const SettingsCase& settings_case : kCases) {
        const std::vector<uint8_t> bytes = test::bytes_of_hex(settings_case.block);
        uint8_t block[kSettingsSize];
        memcpy(block, bytes.data(), sizeof block);
        Settings settings;
        if (parse_settings(Block::Settings, block, &settings)) {
            memset(block, 0x55, sizeof block);
            write_settings(Block::Settings, settings, block);
            CHECK(std::vector<uint8_t>(block, block + sizeof block) == bytes);
            ++written;
        }
        CHECK(is_blank(block) == (std::string(settings_case.name) == "erased"));
    }
    CHECK(written == 5);
}

TEST_CASE("a block with any one bit flipped is ignored") {
    const std::vector<uint8_t> good = test::bytes_of_hex(kCases[0].block);
    for (size_t bit = 0; bit < good.size() * 8; ++bit) {
        CAPTURE(bit);
        std::vector<uint8_t> damaged = good;
        damaged[bit / 8] ^= 1 << bit % 8;
        CHECK(meaning_of(damaged) == "ignored");
    }
}

TEST_CASE("a marking has a block of its own, which is told from that of settings") {
    const Settings marked = {7, 100, 0, 255, 0, 2, 1017};
    uint8_t block[kSettingsSize];
    write_settings(Block::Marking, marked, block);
    Settings found = {99, 9999, 999, 9, 1, 0, 0};
    CHECK_FALSE(parse_settings(Block::Settings, block, &found));
    REQUIRE(parse_settings(Block::Marking, block, &found));
    CHECK(found.revision == 2);
    CHECK(found.serial == 1017);
    CHECK(found.tile_id == 99);
    CHECK(found.period_ms == 9999);
    CHECK(std::vector<uint8_t>(block, block + sizeof block) ==
          test::bytes_of_hex("54420202f90300000000f7eb"));
    write_settings(Block::Settings, marked, block);
    CHECK_FALSE(parse_settings(Block::Marking, block, &found));
}

TEST_CASE("a button that bounces counts once per press") {
    Button button;
    int presses = 0;
    uint32_t now_ms = 0xFFFFFFF0; // the clock wraps on the way
    const auto hold = [&](bool closed, int ms) {
        for (int i = 0; i < ms; ++i) {
            presses += button.pressed(closed, now_ms++);
        }
    };
    hold(false, 50);
    for (int i = 0; i < 5; ++i) {
        hold(true, 2);
        hold(false, 1);
    }
    CHECK(presses == 0);
    hold(true, 25);
    CHECK(presses == 1);
    hold(true, 5000);
    CHECK(presses == 1);
    hold(false, 5);
    hold(true, 100);
    CHECK(presses == 1);
    hold(false, 30);
    hold(true, 30);
    CHECK(presses == 2);
}
