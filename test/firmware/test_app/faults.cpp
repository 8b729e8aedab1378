#include <doctest/doctest.h>

#include "array.h"

using namespace tilenca;
using namespace tilenca::test;

TEST_CASE_FIXTURE(ArrayFixture, "neighbours know whom they hear, and from which side") {
    Array square(model, {77, 100, 0, 255}, kSquare);
    square.run_until(50);
    CHECK(square[0].link(Side::East).neighbour() == 77);
    CHECK(square[0].link(Side::East).neighbour_side() == Side::West);
    CHECK(square[3].link(Side::North).neighbour_side() == Side::South);
}

TEST_CASE_FIXTURE(ArrayFixture, "a tile taken away is a zero state after six periods, and may come back") {
    Array square(model, {0, 100, 0, 255}, kSquare);
    square.run_until(1050);
    square.take_away(1);
    square.run_until(1050 + 540);
    CHECK(square[0].link(Side::East).alive()); // last spoke at about 1000 ms
    square.run_until(1050 + 570);
    CHECK_FALSE(square[0].link(Side::East).alive());
    CHECK(square[0].link(Side::East).message() == nullptr);
    CHECK(square[0].link(Side::South).alive());
    square.run_until(3050);
    square.put_back();
    square.run_until(3250);
    CHECK(square[0].link(Side::East).alive());
    CHECK(square[0].link(Side::East).counters().lost == 0);
}

TEST_CASE_FIXTURE(ArrayFixture, "dropped frames are counted as lost and stop nobody") {
    Array square(model, {0, 20, 0, 255}, kSquare);
    int dropped = 0;
    square.fault = [&](std::vector<uint8_t> frame) {
        const bool drop = numbers.chance(30);
        dropped += drop;
        return drop ? std::vector<std::vector<uint8_t>>{} : std::vector<std::vector<uint8_t>>{frame};
    };
    square.run_until(20010);
    uint32_t lost = 0, received = 0, silent = 0;
    for (size_t i = 0; i < 4; ++i) {
        CHECK(square[i].updates() == 1000);
        received += received_by(square[i]);
        for (uint8_t side = 0; side < kSides; ++side) {
            lost += square[i].link(side_at(side)).counters().lost;
            silent += kSquare[i][side] != kNobody && !square[i].link(side_at(side)).alive();
            CHECK(square[i].link(side_at(side)).counters().corrupt == 0);
        }
    }
    CHECK(received + dropped == 8 * 1001);
    CHECK(lost > 2000);
    CHECK(lost <= static_cast<uint32_t>(dropped));
    CHECK(silent <= 1); // four in a row are rare
}

TEST_CASE_FIXTURE(ArrayFixture, "flipped bits never reach a state: each damaged frame is corrupt") {
    Array square(model, {0, 20, 0, 255}, kSquare);
    int damaged = 0;
    square.fault = [&](std::vector<uint8_t> frame) {
        if (numbers.chance(20)) {
            // Not the delimiter: without it two frames would be one corrupt sequence.
            const int bit = numbers.draw(0, static_cast<int32_t>(frame.size() - 1) * 8 - 1);
            frame[static_cast<size_t>(bit / 8)] ^= 1 << bit % 8;
            ++damaged;
        }
        return std::vector<std::vector<uint8_t>>{frame};
    };
    square.run_until(20010);
    uint32_t corrupt = 0, received = 0;
    for (size_t i = 0; i < 4; ++i) {
        received += received_by(square[i]);
        for (uint8_t side = 0; side < kSides; ++side) {
            corrupt += square[i].link(side_at(side)).counters().corrupt;
            CHECK(square[i].link(side_at(side)).counters().foreign == 0);
        }
    }
    CHECK(received == 8 * 1001 - static_cast<uint32_t>(damaged));
    CHECK(corrupt >= static_cast<uint32_t>(damaged)); // a flip to zero makes two sequences of one frame
}

TEST_CASE_FIXTURE(ArrayFixture, "doubled frames change no state, only the counters") {
    Array square(model, {0, 100, 0, 255}, kSquare);
    square.fault = [](std::vector<uint8_t> frame) { return std::vector<std::vector<uint8_t>>{frame, frame}; };
    square.run_until(2050);
    const auto expected = square_after(20);
    for (size_t i = 0; i < 4; ++i) {
        CHECK(message_of(square[i]) == expected[i]);
        CHECK(received_by(square[i]) == 2 * 2 * 21);
    }
}

TEST_CASE_FIXTURE(ArrayFixture, "a neighbour of another model is absent") {
    const Model other = random.model(0x1234);
    Tile tile(model, {0, 100, 0, 255}, 0), stranger(other, {0, 100, 0, 255}, 0),
        alone(model, {0, 100, 0, 255}, 0);
    for (uint32_t now_ms = 0; now_ms < 1050; ++now_ms) {
        stranger.tick(now_ms);
        if (stranger.has_frame(Side::West)) {
            uint8_t wire[kMaxFrame];
            for (uint8_t at = 0, size = stranger.take_frame(Side::West, wire); at < size; ++at) {
                tile.receive(Side::East, wire[at], now_ms);
            }
        }
        tile.tick(now_ms);
        alone.tick(now_ms);
    }
    CHECK(tile.link(Side::East).counters().foreign == 11);
    CHECK_FALSE(tile.link(Side::East).alive());
    CHECK(message_of(tile) == message_of(alone));
}

TEST_CASE_FIXTURE(ArrayFixture, "random bytes on every side at full rate change nothing") {
    Array alone(model, {0, 100, 0, 255}, kAlone), deafened(model, {0, 100, 0, 255}, kAlone);
    Numbers noise(8);
    for (uint32_t now_ms = 0; now_ms < 5050; ++now_ms) {
        for (int i = 0; i < 4 * kSides; ++i) {
            deafened[0].receive(side_at(i % kSides), static_cast<uint8_t>(noise.draw(0, 255)), now_ms);
        }
        alone.run_until(now_ms + 1);
        deafened.run_until(now_ms + 1);
    }
    CHECK(deafened[0].updates() == 50);
    CHECK(message_of(deafened[0]) == message_of(alone[0]));
    CHECK(deafened[0].link(Side::North).counters().corrupt > 10);
    CHECK(received_by(deafened[0]) == 0);
}
