#include <doctest/doctest.h>

#include "../support.h"
#include "core/link.h"
#include "core/side.h"

using namespace tilenca;

namespace {

constexpr uint16_t kModel = 0xBEEF;
constexpr uint8_t kChannels = 3;
constexpr uint16_t kPeriodMs = 100;
constexpr uint32_t kTimeoutMs = silence_ms(kPeriodMs);

// A link and the neighbour that speaks to it.
struct Pair {
    Link neighbour{kModel, kChannels, kPeriodMs};
    Link link{kModel, kChannels, kPeriodMs};

    std::vector<uint8_t> next_frame(int8_t first_message = 1) {
        const int8_t message[kChannels] = {first_message, -2, 3};
        uint8_t wire[kMaxFrame];
        return {wire, wire + neighbour.send(Side::West, 200, message, wire)};
    }

    void deliver(const std::vector<uint8_t>& bytes, uint32_t now_ms) {
        for (uint8_t byte : bytes) {
            link.receive(byte, now_ms);
        }
    }
};

} // namespace

TEST_CASE("sides face their opposites") {
    CHECK(opposite(Side::North) == Side::South);
    CHECK(opposite(Side::South) == Side::North);
    CHECK(opposite(Side::East) == Side::West);
    CHECK(opposite(Side::West) == Side::East);
    CHECK(kSideLetters[index_of(Side::West)] == 'W');
}

TEST_CASE("nobody is there until the first frame") {
    Pair pair;
    CHECK_FALSE(pair.link.alive());
    CHECK(pair.link.message() == nullptr);
    CHECK_FALSE(pair.link.ever_received());
    pair.deliver(pair.next_frame(-7), 1000);
    REQUIRE(pair.link.alive());
    CHECK(pair.link.message()[0] == -7);
    CHECK(pair.link.message()[2] == 3);
    CHECK(pair.link.age_ms(1234) == 234);
    CHECK(pair.link.neighbour() == 200);
    CHECK(pair.link.neighbour_side() == Side::West);
    CHECK(pair.link.counters().received == 1);
    CHECK(pair.link.counters().lost == 0);
}

TEST_CASE("the latest value wins") {
    Pair pair;
    pair.deliver(pair.next_frame(1), 0);
    pair.deliver(pair.next_frame(2), 1);
    CHECK(pair.link.message()[0] == 2);
}

TEST_CASE("a neighbour is silent when its last frame is older than six periods, not before") {
    Pair pair;
    pair.deliver(pair.next_frame(), 1000);
    pair.link.tick(1600);
    CHECK(pair.link.alive());
    pair.link.tick(1601);
    CHECK_FALSE(pair.link.alive());
    CHECK(pair.link.message() == nullptr);
    CHECK(pair.link.ever_received());
    pair.deliver(pair.next_frame(9), 5000);
    CHECK(pair.link.alive());
    CHECK(pair.link.message()[0] == 9);
}

TEST_CASE("silence is found across the wrap of the clock and does not end by itself") {
    Pair pair;
    pair.deliver(pair.next_frame(), 0xFFFFFF00);
    pair.link.tick(0x00000010);
    CHECK(pair.link.alive());
    pair.link.tick(0x00000400);
    CHECK_FALSE(pair.link.alive());
    pair.link.tick(0xFFFFFF01); // the same age again, 49 days later
    CHECK_FALSE(pair.link.alive());
}

TEST_CASE("a gap in the sequence is counted, also where the sequence wraps") {
    Pair pair;
    uint32_t now_ms = 0;
    for (int i = 0; i < 600; ++i) {
        const auto frame = pair.next_frame();
        if (i % 10 != 9) {
            pair.deliver(frame, now_ms += 10);
        }
    }
    CHECK(pair.neighbour.counters().sent == 600);
    CHECK(pair.link.counters().received == 540);
    CHECK(pair.link.counters().lost == 59); // nothing came after the last one
    CHECK(pair.link.counters().corrupt == 0);
}

TEST_CASE("what is missed during silence is not counted as lost") {
    Pair pair;
    pair.deliver(pair.next_frame(), 0);
    for (int i = 0; i < 5; ++i) {
        pair.next_frame();
    }
    pair.deliver(pair.next_frame(), 10000); // nobody called tick() in between
    CHECK(pair.link.counters().received == 2);
    CHECK(pair.link.counters().lost == 0);
}

TEST_CASE("a damaged frame is counted and leaves the last message standing") {
    Pair pair;
    pair.deliver(pair.next_frame(1), 0);
    auto damaged = pair.next_frame(2);
    damaged[6] ^= 0x10;
    pair.deliver(damaged, 10);
    CHECK(pair.link.counters().corrupt == 1);
    CHECK(pair.link.message()[0] == 1);
    pair.deliver(pair.next_frame(3), 20);
    CHECK(pair.link.message()[0] == 3);
    CHECK(pair.link.counters().lost == 1);
}

TEST_CASE("a neighbour with another model is absent at once, and back at once with the same model") {
    Pair pair;
    Link foreigner(0x1234, kChannels, kPeriodMs);
    pair.deliver(pair.next_frame(), 0);
    REQUIRE(pair.link.alive());
    const int8_t message[kChannels] = {5, 5, 5};
    uint8_t wire[kMaxFrame];
    const uint8_t size = foreigner.send(Side::East, 9, message, wire);
    pair.deliver({wire, wire + size}, 10);
    CHECK_FALSE(pair.link.alive());
    CHECK(pair.link.foreign());
    CHECK(pair.link.neighbour() == 200); // that of the last good frame
    CHECK(pair.link.counters().foreign == 1);
    CHECK(pair.link.counters().received == 1);
    CHECK(pair.link.age_ms(110) == 110);
    pair.deliver(pair.next_frame(), 20);
    CHECK(pair.link.alive());
    CHECK_FALSE(pair.link.foreign());
}

TEST_CASE("a stranger that falls silent is no longer there") {
    Pair pair;
    Link foreigner(0x1234, kChannels, kPeriodMs);
    const int8_t message[kChannels] = {5, 5, 5};
    uint8_t wire[kMaxFrame];
    const uint8_t size = foreigner.send(Side::East, 9, message, wire);
    pair.deliver({wire, wire + size}, 0xFFFFFF00);
    pair.link.tick(0xFFFFFF00 + kTimeoutMs);
    CHECK(pair.link.foreign());
    pair.link.tick(0xFFFFFF01 + kTimeoutMs);
    CHECK_FALSE(pair.link.foreign());
    pair.link.tick(0xFFFFFF01); // the same age again, 49 days later
    CHECK_FALSE(pair.link.foreign());
}

TEST_CASE("a new period holds from then on") {
    Pair pair;
    pair.deliver(pair.next_frame(), 1000);
    pair.link.set_period(10);
    pair.link.tick(1060);
    CHECK(pair.link.alive());
    pair.link.tick(1061);
    CHECK_FALSE(pair.link.alive());
}

namespace {

// Frames so far apart; how often the link was alive when it looked, each millisecond.
uint32_t alive_ms(Pair& pair, uint32_t* now_ms, uint32_t apart_ms, int frames) {
    uint32_t alive = 0;
    for (int i = 0; i < frames; ++i) {
        pair.deliver(pair.next_frame(), *now_ms);
        for (uint32_t ms = 0; ms < apart_ms; ++ms) {
            pair.link.tick(++*now_ms);
            alive += pair.link.alive();
        }
    }
    return alive;
}

} // namespace

TEST_CASE("a neighbour slower than the tile is heard all the time from its second frame on") {
    Pair pair;
    uint32_t now_ms = 0xFFFFFFF0;
    CHECK(alive_ms(pair, &now_ms, 2000, 1) == kTimeoutMs);
    CHECK(alive_ms(pair, &now_ms, 2000, 5) == 5 * 2000);
    CHECK(alive_ms(pair, &now_ms, 12500, 1) == silence_ms(2000)); // longer than ever
    CHECK(alive_ms(pair, &now_ms, 12500, 2) == 2 * 12500);
    CHECK(pair.link.counters().lost == 0);
}

TEST_CASE("a slow neighbour is silent after six of its periods, and so is one that became faster") {
    Pair pair;
    uint32_t now_ms = 0;
    alive_ms(pair, &now_ms, 2000, 3);
    CHECK(alive_ms(pair, &now_ms, 60000, 1) == silence_ms(2000));
    alive_ms(pair, &now_ms, 50, 20);
    CHECK(alive_ms(pair, &now_ms, 60000, 1) == kTimeoutMs); // the tile's own period
}

TEST_CASE("frames that got lost do not make a neighbour slow") {
    Pair pair;
    uint32_t now_ms = 0;
    for (int i = 0; i < 20; ++i) {
        alive_ms(pair, &now_ms, 100, 1);
        pair.next_frame();
        now_ms += 100;
    }
    CHECK(alive_ms(pair, &now_ms, 60000, 1) == kTimeoutMs);
}

TEST_CASE("a slow stranger does not come and go either") {
    Pair pair;
    Link foreigner(0x1234, kChannels, kPeriodMs);
    const int8_t message[kChannels] = {5, 5, 5};
    for (uint32_t now_ms = 0; now_ms < 6000; now_ms += 2000) {
        uint8_t wire[kMaxFrame];
        const uint8_t size = foreigner.send(Side::East, 9, message, wire);
        pair.deliver({wire, wire + size}, now_ms);
        pair.link.tick(now_ms + kTimeoutMs + 1);
        CHECK(pair.link.foreign() == (now_ms != 0));
    }
}
