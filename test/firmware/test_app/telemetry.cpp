#include <doctest/doctest.h>

#include "../support.h"
#include "app/telemetry.h"
#include "lines.h"

using namespace tilenca;
using test::line_of;
using test::Numbers;
using test::RandomModel;
using test::text_of;

namespace {

// Three channels; every state grows by 1/8192 * (bias) per update, so that texts are known beforehand.
struct Fixture {
    const std::vector<int8_t> zeros = std::vector<int8_t>(20, 0);
    const std::vector<int16_t> growth = {0, 1280, -2560};
    const LayerStream hidden1 = LayerStream(15, 1, zeros.data(), growth.data());
    const LayerStream hidden2 = LayerStream(1, 1, zeros.data(), growth.data());
    LayerStream output = LayerStream(1, 3, zeros.data(), growth.data());
    const std::vector<Look> looks = {{'4', 0x66, 1, 2, 3}, {'b', 0x7C, 4, 5, 6}};
    const Model model = {
        0xBEEF, 2, {hidden1.layer(), hidden2.layer(), output.layer()}, FlashView<Look>(looks.data())};

    // Ticks until a period has ended; returns that millisecond.
    uint32_t end_period(Tile& tile, uint32_t now_ms) {
        for (int i = 0; i < 20000; ++i) {
            if (tile.tick(++now_ms)) {
                return now_ms;
            }
        }
        FAIL("no period ended");
        return 0;
    }

    void let_neighbour_speak(Tile& tile, Side side, int frames, uint32_t now_ms) {
        Link neighbour(0xBEEF, 3, 1000);
        const int8_t message[3] = {1, 2, 3};
        for (int i = 0; i < frames; ++i) {
            uint8_t wire[kMaxFrame];
            const uint8_t size = neighbour.send(Side::West, 200, message, wire);
            for (uint8_t at = 0; at < size; ++at) {
                tile.receive(side, wire[at], now_ms);
            }
        }
    }
};

} // namespace

TEST_CASE_FIXTURE(Fixture, "hello says what the tile is") {
    const Tile tile(model, {7, 2000, 30, 128}, 0);
    Sentence sentence;
    write_hello(tile, {0x0A, 0x00C0FFEE, {}}, &sentence);
    CHECK(text_of(sentence) == line_of("hello of tile 7"));
}

TEST_CASE_FIXTURE(Fixture, "hello says whether the model has directions") {
    const Model directed = {0xBEEF, 2, model.network, model.looks, kSides};
    const Tile tile(directed, {7, 2000, 30, 128}, 0);
    Sentence sentence;
    write_hello(tile, {0x0A, 0x00C0FFEE, {}}, &sentence);
    CHECK(text_of(sentence) == line_of("hello of a tile with directions"));
}

TEST_CASE_FIXTURE(Fixture, "a tile that shows nothing yet says so") {
    const Tile tile(model, {0, 100, 0, 255}, 0);
    Sentence sentence;
    write_tile(tile, 0, &sentence);
    CHECK(text_of(sentence) == line_of("tile before its first update"));
}

TEST_CASE_FIXTURE(Fixture, "a tile says what it shows, which links live, and its state as sent") {
    Tile tile(model, {255, 100, 0, 255}, 0);
    let_neighbour_speak(tile, Side::North, 1, 90);
    let_neighbour_speak(tile, Side::South, 2, 95);
    end_period(tile, 99);
    Sentence sentence;
    write_tile(tile, 4294967295, &sentence);
    CHECK(text_of(sentence) == line_of("tile after its first update"));
}

TEST_CASE_FIXTURE(Fixture,
                  "a decision is told until the tile starts again, and that of one class has no margin") {
    Tile tile(model, {7, 100, 0, 255}, 0);
    const auto told = [&] {
        Sentence sentence;
        write_tile(tile, 5, &sentence);
        return text_of(sentence);
    };
    end_period(tile, 0);
    CHECK(told().find("$TILE,7,5,1,4,0,30,----,") == 0);
    tile.restart();
    CHECK(told().find("$TILE,7,5,0,,,,----,") == 0);
    const Model single = {0xBEEF, 1, model.network, FlashView<Look>(looks.data() + 1)};
    Tile alone(single, {7, 100, 0, 255}, 0);
    end_period(alone, 0);
    Sentence sentence;
    write_tile(alone, 5, &sentence);
    CHECK(text_of(sentence).find("$TILE,7,5,1,b,0,,----,") == 0);
}

TEST_CASE_FIXTURE(Fixture, "a link tells its counters and its age") {
    Tile tile(model, {7, 100, 0, 255}, 0);
    Sentence sentence;
    write_link(tile, Side::West, 0, 5, &sentence);
    CHECK(text_of(sentence) == line_of("link that never heard a frame"));
    let_neighbour_speak(tile, Side::East, 3, 90);
    tile.receive(Side::East, 1, 90);
    tile.receive(Side::East, 0, 90);
    uint8_t wire[kMaxFrame];
    tile.take_frame(Side::East, wire);
    write_link(tile, Side::East, 12, 300, &sentence);
    CHECK(text_of(sentence) == line_of("link with a corrupt frame"));
}

TEST_CASE_FIXTURE(Fixture, "a tile tells its times, its stack and what it dropped") {
    const Tile tile(model, {7, 100, 0, 255}, 0);
    Sentence sentence;
    write_time(tile, {14200, 2048, 163, 5000, {}, {}, {}, 0}, 3, 1000, &sentence);
    CHECK(text_of(sentence) == line_of("time"));
}

TEST_CASE_FIXTURE(Fixture, "a tile tells its fuses, and its board's marking") {
    Sentence sentence;
    write_chip(Tile(model, {7, 100, 0, 255}, 0), {0, 0, {0xFF, 0xD8, 0xFD, 0xCF}}, &sentence);
    CHECK(text_of(sentence) == line_of("chip"));
    const Settings marked = {7, 100, 0, 255, 0, 2, 1017};
    write_chip(Tile(model, marked, 0), {0, 0, {0xFF, 0xD8, 0xFD, 0xCF}}, &sentence);
    CHECK(text_of(sentence) == line_of("chip on a marked board"));
}

TEST_CASE_FIXTURE(Fixture, "a tile tells its supply, framing errors and lines that stay low") {
    const Tile tile(model, {7, 100, 0, 255}, 0);
    Sentence sentence;
    write_board(tile, {}, 500, &sentence);
    CHECK(text_of(sentence) == line_of("board whose supply is not known"));
    write_board(tile, {0, 0, 0, 0, {}, {1, 0, 65535, 12}, {0, 0, 60000, 4294967295}, 4380}, 60500, &sentence);
    CHECK(text_of(sentence) == line_of("board with a line that is low"));
}

TEST_CASE_FIXTURE(Fixture, "what is wrong is said in words") {
    Sentence sentence;
    write_error(Tile(model, {7, 100, 0, 255}, 0), Error::Settings, 0, 12, &sentence);
    CHECK(text_of(sentence) == line_of("error without an address"));
    write_error(Tile(model, {0, 100, 0, 255}, 0), Error::Watchdog, 0x0A2C, 3, &sentence);
    CHECK(text_of(sentence) == line_of("error with an address"));
    write_error(Tile(model, {7, 100, 0, 255}, 0), Error::Supply, 4380, 1500, &sentence);
    CHECK(text_of(sentence) == line_of("error of a low supply"));
}

TEST_CASE("the longest sentences fit") {
    Numbers numbers(1);
    const RandomModel random(kMaxChannels, 3, 3, kMaxChannels, numbers, 9);
    const Model model = random.model(0xFFFF);
    Tile tile(model, {255, 10, 65535, 255}, 0);
    Sentence sentence;
    for (uint32_t now_ms = 0; tile.updates() < 20; ++now_ms) {
        tile.tick(now_ms);
    }
    write_tile(tile, 4294967295, &sentence);
    // Its number of updates may have eight more digits, and its class and margin two or three.
    CHECK(sentence.size() + 8 + 3 <= kMaxSentence);
    CHECK(text_of(sentence).substr(sentence.size() - 2) == "\r\n");
    CHECK(text_of(sentence).find(",----,") != std::string::npos);
    const size_t state_digits = text_of(sentence).find('*') - text_of(sentence).rfind(',') - 1;
    CHECK(state_digits == 2 * kMaxChannels);
    Tile heard(model, {255, 10000, 65535, 255}, 0);
    write_link(heard, Side::West, 65535, 4294967295, &sentence);
    CHECK(sentence.size() <= kMaxSentence);
    constexpr uint32_t kMost = 4294967295;
    const Health most = {
        kMost, kMost, 1000, 65535, {}, {65535, 65535, 65535, 65535}, {kMost, kMost, kMost, kMost}, 65535};
    write_time(heard, most, kMost, kMost, &sentence);
    CHECK(sentence.size() <= kMaxSentence);
    write_board(heard, most, kMost, &sentence);
    CHECK(sentence.size() <= kMaxSentence);
}

namespace {

// All that is due now, by the first letters of the names; of a LINK, the side's.
std::string said_at(uint32_t now_ms, const Tile& tile, Telemetry* telemetry) {
    std::string names;
    while (telemetry->next(now_ms) != Telemetry::Next::Nothing) {
        Sentence sentence;
        telemetry->write(tile, {}, now_ms, &sentence);
        const std::string text = text_of(sentence);
        const std::string time = std::to_string(now_ms);
        names += text[1] == 'L'                     ? text.at(text.find("," + time + ",") + time.size() + 2)
                 : text[2] == 'I' && text[3] == 'M' ? 't'
                                                    : text[1];
    }
    return names;
}

} // namespace

TEST_CASE_FIXTURE(Fixture, "after every period comes a tile sentence, then one link, in turn") {
    Tile tile(model, {7, 100, 0, 255}, 0);
    Telemetry telemetry;
    CHECK(said_at(0, tile, &telemetry) == "");
    uint32_t now_ms = 0;
    std::string names;
    for (int period = 0; period < 5; ++period) {
        now_ms = end_period(tile, now_ms);
        telemetry.period_ended(tile);
        names += said_at(now_ms, tile, &telemetry);
    }
    CHECK(names == "TNTETSTWTNB"); // half a second is over, too
}

TEST_CASE_FIXTURE(Fixture, "a fast tile speaks every 100 ms, and at once when its label changes") {
    output.set_bias(1, 0);
    output.set_bias(2, 0);
    Tile tile(model, {7, 10, 0, 255}, 0);
    Telemetry telemetry;
    uint32_t now_ms = 0;
    std::vector<uint32_t> spoken_at;
    for (int period = 1; period <= 40; ++period) {
        if (period == 15) {
            output.set_bias(2, 500); // now the second class wins
        }
        now_ms = end_period(tile, now_ms);
        telemetry.period_ended(tile);
        if (said_at(now_ms, tile, &telemetry).find('T') != std::string::npos) {
            spoken_at.push_back(tile.updates());
        }
    }
    CHECK(spoken_at == std::vector<uint32_t>{1, 11, 15, 25, 35});
}

TEST_CASE_FIXTURE(Fixture, "times are told every second by the tile's clock, however late the calls come") {
    const Tile tile(model, {7, 100, 0, 255}, 0);
    Telemetry telemetry;
    std::vector<uint32_t> told_at, board_at;
    for (uint32_t now_ms = 0; now_ms < 5000; now_ms += 7) {
        const std::string said = said_at(now_ms, tile, &telemetry);
        if (said == "t") {
            told_at.push_back(now_ms);
        } else if (said == "B") {
            board_at.push_back(now_ms);
        } else {
            CHECK(said == "");
        }
    }
    CHECK(told_at == std::vector<uint32_t>{1001, 2002, 3003, 4004});
    CHECK(board_at == std::vector<uint32_t>{504, 1505, 2506, 3500, 4501});
}

TEST_CASE_FIXTURE(Fixture, "a low supply is told with the voltage at which it was first seen") {
    const Tile tile(model, {7, 100, 0, 255}, 0);
    Telemetry telemetry;
    Sentence sentence;
    telemetry.failed(Error::Supply, 4380);
    telemetry.failed(Error::Supply, 4100);
    telemetry.write(tile, {}, 1500, &sentence);
    CHECK(text_of(sentence) == line_of("error of a low supply"));
    telemetry.failed(Error::Supply, 4100);
    CHECK(said_at(1500, tile, &telemetry) == "tB");
}

TEST_CASE_FIXTURE(Fixture, "an error is said once, before all else") {
    Tile tile(model, {7, 100, 0, 255}, 0);
    Telemetry telemetry;
    telemetry.failed(Error::Stack);
    telemetry.failed(Error::Settings);
    telemetry.failed(Error::Stack);
    const uint32_t now_ms = end_period(tile, 0);
    telemetry.period_ended(tile);
    CHECK(said_at(now_ms, tile, &telemetry) == "EETN");
    telemetry.failed(Error::Settings);
    CHECK(said_at(now_ms, tile, &telemetry) == "");
}

TEST_CASE_FIXTURE(Fixture, "what waits when its successor is due is dropped and counted") {
    Tile tile(model, {7, 100, 0, 255}, 0);
    Telemetry telemetry;
    uint32_t now_ms = 0;
    for (int period = 0; period < 4; ++period) {
        now_ms = end_period(tile, now_ms);
        telemetry.period_ended(tile);
    }
    telemetry.drop();
    CHECK(said_at(now_ms, tile, &telemetry) == "TN");
    Sentence sentence;
    CHECK(telemetry.write(tile, {}, 1000, &sentence));
    CHECK(text_of(sentence).find(",7*") != std::string::npos); // three of each, and one
}
