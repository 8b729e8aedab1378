#include <doctest/doctest.h>

#include "../support.h"
#include "app/appearance.h"
#include "app/host.h"
#include "eeprom.h"
#include "lines.h"

using namespace tilenca;
using test::Eeprom;
using test::line_of;
using test::Memory;
using test::memory_of;
using test::Numbers;
using test::RandomModel;
using test::Store;
using test::text_of;

namespace {

constexpr Settings kDefaults = {0, 100, 0, 255};

// A tile, what its host says, and an EEPROM.
struct Fixture {
    Numbers numbers{3};
    RandomModel random{6, 12, 10, 3, numbers, 30};
    Model model = random.model();
    Tile tile{model, {7, 100, 0, 255}, 0};
    const Boot boot{1, 0x1234ABCD};
    Host host{kDefaults, boot};
    Memory memory = memory_of({7, 100, 0, 255});
    Store store{Eeprom(&memory)};
    uint32_t now_ms = 500;

    // Everything the tile answers, in one text. As in the main loop: bytes wait while EEPROM is written.
    std::string answers(const std::vector<uint8_t>& bytes) {
        std::string text;
        size_t at = 0;
        const auto read = [&](uint8_t* byte) { return at < bytes.size() && (*byte = bytes[at++], true); };
        for (bool answered = true; answered || at < bytes.size();) {
            Sentence sentence;
            answered = host.answer(store, read, &tile, now_ms, &sentence);
            text += answered ? text_of(sentence) : "";
            while (store.writing()) {
                answered = true;
            }
        }
        return text;
    }

    std::string answer(const std::string& body) {
        Sentence line; // has the same framing
        line.begin(body.c_str());
        line.end();
        return answers({line.bytes(), line.bytes() + line.size()});
    }
};

} // namespace

TEST_CASE_FIXTURE(Fixture, "asked, a tile greets") {
    Sentence hello;
    write_hello(tile, boot, &hello);
    CHECK(answer("ASK") == text_of(hello));
}

TEST_CASE_FIXTURE(Fixture, "settings are kept, in force at once, and answered with what holds") {
    CHECK(answer("SET,period,20") == line_of("answer to a period"));
    CHECK(tile.settings().period_ms == 20);
    CHECK(answer("SET,preset,paper") == line_of("answer to a preset"));
    CHECK(tile.settings().period_ms == 2000);
    CHECK(tile.settings().updates == 30);
    CHECK(answer("SET,brightness,9").find("$ACK,7,SET,brightness,9*") == 0);
    CHECK(answer("SET,leds,0").find("$ACK,7,SET,leds,0*") == 0);
    CHECK(tile.settings().leds == kLedsDark);
    CHECK(answer("SET,leds,1").find("$ACK,7,SET,leds,1*") == 0);
    CHECK(tile.settings().leds == kLedsLinks);
    CHECK(answer("SET,id,9") == line_of("answer to a new id"));
    answer("SET,preset,default");
    CHECK(tile.settings().period_ms == kDefaults.period_ms);
    CHECK(tile.settings().updates == kDefaults.updates);
    CHECK(tile.settings().tile_id == 9);
    CHECK(tile.settings().brightness == 9);
    answer("SET,updates,65535");
    CHECK(tile.settings().updates == 65535);
    CHECK(memory.bytes == memory_of({9, 100, 65535, 9}).bytes);
}

TEST_CASE_FIXTURE(Fixture, "a marking is kept for good, unless the command says that it is to be replaced") {
    CHECK(answer("MARK,2,1017") == line_of("answer to a marking"));
    CHECK(answer("MARK,2,1017") == line_of("answer to a marking"));
    for (const char* other : {"MARK,3,1017", "MARK,2,1018"}) {
        CHECK(answer(other) == line_of("a marking that is for good"));
    }
    CHECK(memory.bytes == memory_of({7, 100, 0, 255, 0, 2, 1017}).bytes);
    CHECK(answer("CHIP").find(",2,1017*") != std::string::npos);
    answer("SET,period,20");
    CHECK(memory.bytes == memory_of({7, 20, 0, 255, 0, 2, 1017}).bytes);
    CHECK(answer("MARK,3,65535,replace").find("$ACK,7,MARK,3,65535*") == 0);
    CHECK(memory.bytes == memory_of({7, 20, 0, 255, 0, 3, 65535}).bytes);
    for (const char* wrong : {"MARK", "MARK,2", "MARK,0,1", "MARK,256,1", "MARK,2,65536", "MARK,2,x",
                              "MARK,2,1,now", "MARK,2,1,replace,", "MARK,,"}) {
        CAPTURE(wrong);
        CHECK(answer(wrong).find("$NAK,7,VALUE,MARK*") == 0);
    }
    CHECK(tile.settings().serial == 65535);
}

TEST_CASE_FIXTURE(Fixture, "a marking that EEPROM does not keep is told, and the board stays unmarked") {
    memory.worn = 2 * kSettingsSize + 4;
    CHECK(answer("MARK,2,1017").find("$NAK,7,EEPROM,MARK*") == 0);
    CHECK(tile.settings().revision == 0);
    CHECK(answer("SET,period,20") == line_of("answer to a period"));
    CHECK(answer("CHIP").find(",,*") != std::string::npos);
}

TEST_CASE_FIXTURE(Fixture, "the link LEDs show what is missing only where the model says it") {
    CHECK(answer("SET,leds,2") == line_of("a value out of range"));
    model.directions = kSides;
    CHECK(answer("SET,leds,2").find("$ACK,7,SET,leds,2*") == 0);
    CHECK(tile.settings().leds == kLedsMissing);
    CHECK(answer("SET,leds,3") == line_of("a value out of range"));
}

TEST_CASE_FIXTURE(Fixture, "what is not in range changes nothing") {
    for (const char* wrong : {"SET,period,9", "SET,period,10001", "SET,id,256", "SET,updates,65536",
                              "SET,brightness,256", "SET,leds,2", "SET,preset,fast", "SET,preset,",
                              "SET,colour,3", "SET,id,", "SET,id,-1", "SET,id", "SET,id,1,2", "SET"}) {
        CAPTURE(wrong);
        CHECK(answer(wrong) == line_of("a value out of range"));
    }
    CHECK(tile.settings().period_ms == 100);
    CHECK(memory.writes == 0);
}

TEST_CASE_FIXTURE(Fixture,
                  "an EEPROM that does not keep what it is given is told, and the old settings stay") {
    answer("SET,brightness,9");
    const auto before = memory.bytes;
    for (const int period_at : {4, kSettingsSize + 4}) {
        memory.worn = period_at;
        CHECK(answer("SET,period,20") == line_of("an EEPROM that does not keep"));
        CHECK(tile.settings().period_ms == 100);
        CHECK(memory.bytes == before);
    }
}

TEST_CASE_FIXTURE(Fixture, "commands that come while EEPROM is being written are answered after it") {
    std::vector<uint8_t> all;
    for (const char* body : {"SET,id,9", "SET,period,20", "RESTART"}) {
        Sentence line;
        line.begin(body);
        line.end();
        all.insert(all.end(), line.bytes(), line.bytes() + line.size());
    }
    const std::string text = answers(all);
    CHECK(text.find("$ACK,9,SET,id,9*") == 0);
    CHECK(text.find("$ACK,9,SET,period,20*") < text.find("$ACK,9,RESTART*"));
    CHECK(text.find("$ACK,9,RESTART*") != std::string::npos);
    CHECK(memory.bytes == memory_of({9, 20, 0, 255}).bytes);
}

TEST_CASE_FIXTURE(Fixture, "what cannot be obeyed is answered too") {
    CHECK(answer("FLY") == line_of("a command nobody knows"));
    CHECK(answers({'$', 'A', '*', '0', '0'}) == line_of("a damaged command"));
    CHECK(answers(std::vector<uint8_t>(1, '$')) == "");
    CHECK(answers(std::vector<uint8_t>(100, 'x')) == line_of("a command too long"));
    for (const char* wrong : {"ASK,1", "BLINK", "BLINK,61", "BLINK,x", "BLINK,1,1", "RESTART,now"}) {
        CAPTURE(wrong);
        CHECK(answer(wrong).find(",VALUE,") != std::string::npos);
    }
}

TEST_CASE_FIXTURE(Fixture, "restart is as the button") {
    while (tile.updates() < 3) {
        tile.tick(now_ms += 10);
    }
    CHECK(answer("RESTART") == line_of("answer to restart"));
    CHECK(tile.updates() == 0);
    CHECK(tile.shown() == Tile::kNothing);
}

TEST_CASE_FIXTURE(Fixture, "a display blinks as long as told, across the wrap of the clock") {
    now_ms = 0xFFFFF000;
    CHECK_FALSE(host.blinking(now_ms));
    CHECK(answer("BLINK,5") == line_of("answer to blink"));
    CHECK(host.blinking(now_ms));
    CHECK(host.blinking(now_ms + 4999));
    CHECK_FALSE(host.blinking(now_ms + 5000));
    CHECK_FALSE(host.blinking(now_ms)); // 49 days later
    answer("BLINK,60");
    CHECK(host.blinking(now_ms));
    answer("BLINK,0");
    CHECK_FALSE(host.blinking(now_ms));
}

TEST_CASE_FIXTURE(Fixture, "any bytes are survived, and the next command is obeyed") {
    Numbers noise(11);
    for (int i = 0; i < 300; ++i) {
        answers(noise.draw_all<uint8_t>(noise.draw(0, 400), 0, 255));
        const std::string text = answer("RESTART");
        CHECK(text.find("ACK,7,RESTART") != std::string::npos);
    }
    CHECK(tile.settings().period_ms == 100);
}

TEST_CASE_FIXTURE(Fixture, "a tile shows its class, blinks when told, and its links on the debug LEDs") {
    CHECK(look_of(tile, appearance_of(tile, false, 0).shown).segments == 0);
    uint32_t at_ms = 500;
    while (tile.shown() == Tile::kNothing) {
        tile.tick(at_ms += 10);
    }
    CHECK(appearance_of(tile, false, 0).shown == tile.shown());
    CHECK(look_of(tile, tile.shown()).segments == model.looks[tile.shown()].segments);
    CHECK(look_of(tile, appearance_of(tile, true, 0).shown).segments == 0);
    CHECK(look_of(tile, appearance_of(tile, true, 256).shown).segments == 0x7F);
    CHECK(appearance_of(tile, false, 0).leds == 0);

    const int8_t message[6] = {};
    uint8_t wire[kMaxFrame];
    Link friendly(0xBEEF, 6, 1000), stranger(0x1234, 6, 1000);
    for (uint8_t at = 0, size = friendly.send(Side::South, 3, message, wire); at < size; ++at) {
        tile.receive(Side::North, wire[at], at_ms);
    }
    for (uint8_t at = 0, size = stranger.send(Side::East, 4, message, wire); at < size; ++at) {
        tile.receive(Side::West, wire[at], at_ms);
    }
    CHECK(appearance_of(tile, false, 0).leds == 0x1);
    CHECK(appearance_of(tile, false, 256).leds == 0x9);
    CHECK(appearance_of(tile, false, 512).leds == 0x1);
    Settings dark = tile.settings();
    dark.leds = kLedsDark;
    tile.apply(dark);
    CHECK(appearance_of(tile, false, 256).leds == 0);
    dark.leds = kLedsMissing; // from EEPROM, written for another model: this one has no directions
    tile.apply(dark);
    CHECK(appearance_of(tile, false, 256).leds == 0x9);
}

TEST_CASE("a tile whose model has directions shows by a setting where a tile is missing") {
    // Two classes; every update adds 1280 to the score of east, and takes as much from that of north.
    const std::vector<int8_t> zeros(35, 0);
    const std::vector<int16_t> growth = {0, -1280, 1280, 0, 0, 0, 0};
    const LayerStream hidden1(35, 1, zeros.data(), growth.data());
    const LayerStream hidden2(1, 1, zeros.data(), growth.data());
    const LayerStream output(1, 7, zeros.data(), growth.data());
    const std::vector<Look> looks(2);
    const Model model = {
        1, 2, {hidden1.layer(), hidden2.layer(), output.layer()}, FlashView<Look>(looks.data()), kSides};
    Tile tile(model, {7, 100, 0, 255, kLedsMissing}, 0);
    uint32_t now_ms = 0;
    const auto update_until = [&](uint32_t number) {
        while (tile.updates() < number) {
            REQUIRE(++now_ms < 1000);
            tile.tick(now_ms);
        }
    };
    CHECK(tile.missing() == kSides);
    update_until(3); // 3840, a message of 30
    CHECK(tile.missing() == kSides);
    CHECK(appearance_of(tile, false, 0).leds == 0);
    update_until(4);
    CHECK(tile.missing() == index_of(Side::East));
    CHECK(appearance_of(tile, false, 0).leds == 1 << index_of(Side::East));
    tile.apply({7, 100, 0, 255, kLedsLinks});
    CHECK(appearance_of(tile, false, 0).leds == 0);
}

TEST_CASE_FIXTURE(Fixture, "brightness scales a colour") {
    for (const auto& [brightness, duty] : {std::pair<int, int>{255, 60}, {128, 30}, {1, 0}, {0, 0}}) {
        tile.apply({7, 100, 0, static_cast<uint8_t>(brightness)});
        CHECK(look_of(tile, Appearance::kFound).green == duty);
    }
}
