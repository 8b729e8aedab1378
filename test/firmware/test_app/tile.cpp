#include <doctest/doctest.h>

#include <array>
#include <functional>
#include <memory>

#include "../support.h"
#include "app/tile.h"
#include "core/crc16.h"

using namespace tilenca;
using test::Numbers;
using test::RandomModel;

namespace {

constexpr uint8_t kNobody = 0xFF;

// What the line between two tiles may do to a frame: change it in place, repeat it, or swallow it.
using Fault = std::function<std::vector<std::vector<uint8_t>>(std::vector<uint8_t>)>;

// Tiles wired to each other in one process; the test owns the clock. Frames arrive within the same
// millisecond.
class Array {
  public:
    Array(const Model& model, Settings settings, std::vector<std::array<uint8_t, kSides>> neighbours)
        : neighbours_(std::move(neighbours)) {
        for (size_t i = 0; i < neighbours_.size(); ++i) {
            tiles_.push_back(std::make_unique<Tile>(model, settings, 0));
        }
    }

    Tile& operator[](size_t index) { return *tiles_[index]; }

    void run_until(uint32_t end_ms) {
        for (; now_ms < end_ms; ++now_ms) {
            for (size_t i = 0; i < tiles_.size(); ++i) {
                if (present(i)) {
                    tiles_[i]->tick(now_ms);
                    pass_frames(i);
                }
            }
        }
    }

    void take_away(size_t index) { absent_ = index; }
    void put_back() { absent_ = kNobody; }

    Fault fault = [](std::vector<uint8_t> frame) { return std::vector<std::vector<uint8_t>>{frame}; };
    uint32_t now_ms = 0;

  private:
    bool present(size_t index) const { return index != absent_; }

    void pass_frames(size_t from) {
        for (uint8_t i = 0; i < kSides; ++i) {
            const Side side = side_at(i);
            if (!tiles_[from]->has_frame(side)) {
                continue;
            }
            uint8_t wire[kMaxFrame];
            const uint8_t size = tiles_[from]->take_frame(side, wire);
            const uint8_t to = neighbours_[from][i];
            if (to == kNobody || !present(to)) {
                continue;
            }
            for (const auto& frame : fault({wire, wire + size})) {
                for (uint8_t byte : frame) {
                    tiles_[to]->receive(opposite(side), byte, now_ms);
                }
            }
        }
    }

    std::vector<std::array<uint8_t, kSides>> neighbours_;
    std::vector<std::unique_ptr<Tile>> tiles_;
    size_t absent_ = kNobody;
};

// Four tiles in a square: 0 1 / 2 3.
const std::vector<std::array<uint8_t, kSides>> kSquare = {
    {kNobody, 1, 2, kNobody}, {kNobody, kNobody, 3, 0}, {0, 3, kNobody, kNobody}, {1, kNobody, kNobody, 2}};
const std::vector<std::array<uint8_t, kSides>> kAlone = {{kNobody, kNobody, kNobody, kNobody}};

struct Fixture {
    Numbers numbers{42};
    RandomModel random{6, 12, 10, 3, numbers, 30};
    Model model = random.model();

    // The messages of every tile after n updates in step, computed with cells alone.
    std::vector<std::vector<int8_t>> square_after(int updates) const {
        std::vector<Cell> cells(4, Cell(model.network));
        for (int n = 0; n < updates; ++n) {
            std::vector<std::vector<int8_t>> told;
            for (const Cell& cell : cells) {
                told.emplace_back(cell.message(), cell.message() + 6);
            }
            for (size_t i = 0; i < cells.size(); ++i) {
                const int8_t* heard[kSides];
                for (uint8_t side = 0; side < kSides; ++side) {
                    heard[side] = kSquare[i][side] == kNobody ? nullptr : told[kSquare[i][side]].data();
                }
                cells[i].perceive(heard);
                while (!cells[i].update_slice()) {
                }
            }
        }
        std::vector<std::vector<int8_t>> messages;
        for (const Cell& cell : cells) {
            messages.emplace_back(cell.message(), cell.message() + 6);
        }
        return messages;
    }

    static std::vector<int8_t> message_of(const Tile& tile) { return {tile.message(), tile.message() + 6}; }

    static uint32_t received_by(Tile& tile) {
        uint32_t sum = 0;
        for (uint8_t i = 0; i < kSides; ++i) {
            sum += tile.link(side_at(i)).counters().received;
        }
        return sum;
    }
};

} // namespace

TEST_CASE_FIXTURE(Fixture, "tiles in step do what cells in step do, update by update") {
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

TEST_CASE_FIXTURE(Fixture,
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

TEST_CASE_FIXTURE(Fixture, "what was not taken in time is replaced: the latest value wins") {
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

TEST_CASE_FIXTURE(Fixture, "the phase of the updates is that of the boot, however late the calls come") {
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

TEST_CASE_FIXTURE(Fixture, "periods that were missed are left out, not made up for") {
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

TEST_CASE_FIXTURE(Fixture, "a tile that is to stop keeps its state, and goes on telling it every period") {
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

TEST_CASE_FIXTURE(Fixture, "a restarted tile is the seed, shows nothing, and begins its updates again") {
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

TEST_CASE_FIXTURE(Fixture, "a new period counts from the end of the last one and keeps the state") {
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

TEST_CASE_FIXTURE(Fixture, "a tile told to do fewer updates than it has done stops, to do more goes on") {
    Array alone(model, {0, 100, 0, 255}, kAlone);
    alone.run_until(1050);
    alone[0].apply({0, 100, 5, 255});
    alone.run_until(2050);
    CHECK(alone[0].updates() == 10);
    alone[0].apply({0, 100, 12, 255});
    alone.run_until(3050);
    CHECK(alone[0].updates() == 12);
}

TEST_CASE_FIXTURE(Fixture, "neighbours know whom they hear, and from which side") {
    Array square(model, {77, 100, 0, 255}, kSquare);
    square.run_until(50);
    CHECK(square[0].link(Side::East).neighbour() == 77);
    CHECK(square[0].link(Side::East).neighbour_side() == Side::West);
    CHECK(square[3].link(Side::North).neighbour_side() == Side::South);
}

TEST_CASE_FIXTURE(Fixture, "a tile taken away is a zero state after six periods, and may come back") {
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

TEST_CASE_FIXTURE(Fixture, "dropped frames are counted as lost and stop nobody") {
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

TEST_CASE_FIXTURE(Fixture, "flipped bits never reach a state: each damaged frame is corrupt") {
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

TEST_CASE_FIXTURE(Fixture, "doubled frames change no state, only the counters") {
    Array square(model, {0, 100, 0, 255}, kSquare);
    square.fault = [](std::vector<uint8_t> frame) { return std::vector<std::vector<uint8_t>>{frame, frame}; };
    square.run_until(2050);
    const auto expected = square_after(20);
    for (size_t i = 0; i < 4; ++i) {
        CHECK(message_of(square[i]) == expected[i]);
        CHECK(received_by(square[i]) == 2 * 2 * 21);
    }
}

TEST_CASE_FIXTURE(Fixture, "a neighbour of another model is absent") {
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

TEST_CASE_FIXTURE(Fixture, "random bytes on every side at full rate change nothing") {
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
