#include <doctest/doctest.h>

#include "array.h"

using namespace tilenca;
using namespace tilenca::test;

TEST_CASE_FIXTURE(ArrayFixture, "tiles in step do what cells in step do, update by update") {
    Array square(model, {0, 100, 0, 255}, kSquare);
    for (int updates = 1; updates <= 40; ++updates) {
        square.run_until(100 * updates + 50);
        const auto expected = square_after(updates);
        for (size_t i = 0; i < 4; ++i) {
            CAPTURE(i);
            CAPTURE(updates);
            REQUIRE(square[i].updates() == updates);
            REQUIRE(message_of(square[i]) == expected[i]);
        }
    }
}

TEST_CASE_FIXTURE(ArrayFixture,
                  "at boot a tile tells its seed on all sides and shows nothing before its first update") {
    Tile tile(model, {0, 100, 0, 255}, 5000);
    uint8_t wire[kMaxFrame];
    FrameDecoder decoder(6);
    for (uint8_t i = 0; i < kSides; ++i) {
        REQUIRE(tile.has_frame(side_at(i)));
        const uint8_t size = tile.take_frame(side_at(i), wire);
        CHECK_FALSE(tile.has_frame(side_at(i)));
        FrameDecoder::Result result = FrameDecoder::Result::Pending;
        for (uint8_t at = 0; at < size; ++at) {
            result = decoder.feed(wire[at]);
        }
        REQUIRE(result == FrameDecoder::Result::Ready);
        CHECK(decoder.header().model_id == 0xBEEF);
        CHECK(decoder.messages()[0] == 64);
        CHECK(decoder.messages()[1] == 0);
    }
    for (uint32_t now_ms = 5000; now_ms < 5100; ++now_ms) {
        CHECK_FALSE(tile.tick(now_ms));
        CHECK(tile.shown() == Tile::kNothing);
        CHECK_FALSE(tile.busy());
    }
    tile.tick(5100);
    CHECK(tile.busy());
}

TEST_CASE_FIXTURE(ArrayFixture, "what was not taken in time is replaced: the latest value wins") {
    Tile tile(model, {0, 100, 0, 255}, 0);
    for (uint32_t now_ms = 0; now_ms < 350; ++now_ms) {
        tile.tick(now_ms);
    }
    uint8_t wire[kMaxFrame];
    FrameDecoder decoder(6);
    for (uint8_t at = 0, size = tile.take_frame(Side::North, wire); at < size; ++at) {
        decoder.feed(wire[at]);
    }
    CHECK(decoder.header().sequence == 0);
    CHECK(std::vector<int8_t>(decoder.messages(), decoder.messages() + 6) == message_of(tile));
    CHECK_FALSE(tile.has_frame(Side::North));
    CHECK(tile.has_frame(Side::East));
}

TEST_CASE_FIXTURE(ArrayFixture, "the phase of the updates is that of the boot, however late the calls come") {
    Tile tile(model, {0, 100, 0, 255}, 0xFFFFFF00); // the clock wraps on the way
    Numbers gaps(7);
    uint32_t last_updates = 0;
    for (uint32_t passed_ms = 0; passed_ms < 20000; passed_ms += gaps.draw(1, 9)) {
        tile.tick(0xFFFFFF00 + passed_ms);
        if (tile.updates() != last_updates) {
            last_updates = tile.updates();
            CHECK((tile.period_ended_ms() - 0xFFFFFF00) % 100 == 0);
            CHECK(tile.period_ended_ms() - 0xFFFFFF00 <= passed_ms);
            CHECK(passed_ms - (tile.period_ended_ms() - 0xFFFFFF00) < 100);
        }
    }
    CHECK(last_updates == 199);
}

TEST_CASE_FIXTURE(ArrayFixture, "periods that were missed are left out, not made up for") {
    Tile tile(model, {0, 100, 0, 255}, 0);
    for (uint32_t now_ms = 0; now_ms < 150; ++now_ms) {
        tile.tick(now_ms);
    }
    for (uint32_t now_ms = 10030; now_ms < 10099; ++now_ms) {
        tile.tick(now_ms);
    }
    CHECK(tile.updates() == 2);
    for (uint32_t now_ms = 10100; now_ms < 10150; ++now_ms) {
        tile.tick(now_ms);
    }
    CHECK(tile.updates() == 3);
}

TEST_CASE_FIXTURE(ArrayFixture,
                  "a tile that is to stop keeps its state, and goes on telling it every period") {
    Array square(model, {0, 100, 3, 255}, kSquare);
    square.run_until(350);
    const auto stopped = message_of(square[0]);
    const uint32_t sent = square[0].link(Side::East).counters().sent;
    CHECK(square[0].updates() == 3);
    CHECK(sent == 4); // the seed and three states
    square.run_until(5050);
    CHECK(square[0].updates() == 3);
    CHECK(message_of(square[0]) == stopped);
    CHECK(square[0].link(Side::East).counters().sent == sent + 47);
    CHECK(square[0].link(Side::East).alive());
    CHECK(square[0].shown() != Tile::kNothing);
}

TEST_CASE_FIXTURE(ArrayFixture, "a restarted tile is the seed, shows nothing, and begins its updates again") {
    Array square(model, {0, 100, 3, 255}, kSquare);
    square.run_until(1000);
    square[2].restart();
    CHECK(square[2].shown() == Tile::kNothing);
    CHECK(square[2].updates() == 0);
    CHECK(square[2].message()[0] == 64);
    CHECK(square[2].has_frame(Side::North));
    square.run_until(1650);
    CHECK(square[2].updates() == 3);
    CHECK(square[0].updates() == 3);
    CHECK(square[2].link(Side::North).counters().lost == 0);
}

TEST_CASE_FIXTURE(ArrayFixture, "a new period counts from the end of the last one and keeps the state") {
    Tile tile(model, {0, 1000, 0, 255}, 0);
    uint32_t now_ms = 0;
    const auto run_until = [&](uint32_t end_ms) {
        while (now_ms < end_ms) {
            tile.tick(now_ms++);
        }
    };
    run_until(2300);
    REQUIRE(tile.updates() == 2);
    const auto before = message_of(tile);
    tile.apply({9, 100, 0, 255}); // the next one was due at 2100
    CHECK(message_of(tile) == before);
    CHECK(tile.updates() == 2);
    run_until(2350);
    CHECK(tile.updates() == 3);
    CHECK(tile.period_ended_ms() == 2300);
    run_until(2450);
    CHECK(tile.updates() == 4);
    tile.apply({9, 2000, 0, 255});
    run_until(4399);
    CHECK(tile.updates() == 4);
    run_until(4450);
    CHECK(tile.updates() == 5);
    uint8_t wire[kMaxFrame];
    FrameDecoder decoder(6);
    for (uint8_t at = 0, size = tile.take_frame(Side::South, wire); at < size; ++at) {
        decoder.feed(wire[at]);
    }
    CHECK(decoder.header().tile == 9);
    CHECK(decoder.header().side == Side::South);
}

TEST_CASE_FIXTURE(ArrayFixture,
                  "a tile told to do fewer updates than it has done stops, to do more goes on") {
    Array alone(model, {0, 100, 0, 255}, kAlone);
    alone.run_until(1050);
    alone[0].apply({0, 100, 5, 255});
    alone.run_until(2050);
    CHECK(alone[0].updates() == 10);
    alone[0].apply({0, 100, 12, 255});
    alone.run_until(3050);
    CHECK(alone[0].updates() == 12);
}
