#include <doctest/doctest.h>

#include "../support.h"
#include "app/line_watch.h"

using namespace tilenca;
using test::Numbers;

namespace {

constexpr uint8_t kSouthLow = 1 << 2;

// Looks at every millisecond, at a clock that wraps on the way.
struct Looks {
    LineWatch lines;
    uint32_t now_ms = 0xFFFFFF00;

    void look(uint8_t low, uint32_t for_ms) {
        for (uint32_t i = 0; i < for_ms; ++i) {
            lines.look(low, ++now_ms);
        }
    }
};

} // namespace

TEST_CASE_FIXTURE(Looks, "a line that stays low is counted from its first millisecond on, and only it") {
    look(0, 300);
    look(kSouthLow, 1000);
    look(0, 300);
    CHECK(lines.low_ms(Side::South) >= 1000 - 16); // whole windows
    CHECK(lines.low_ms(Side::South) <= 1000);
    for (Side side : {Side::North, Side::East, Side::West}) {
        CHECK(lines.low_ms(side) == 0);
    }
    const uint32_t before = lines.low_ms(Side::South);
    look(0, 1000);
    CHECK(lines.low_ms(Side::South) == before);
}

TEST_CASE_FIXTURE(Looks, "short times add up only if each is long enough") {
    for (int i = 0; i < 100; ++i) {
        look(kSouthLow, LineWatch::kLeastLowMs - 1);
        look(0, 1);
    }
    CHECK(lines.low_ms(Side::South) == 0);
    for (int i = 0; i < 10; ++i) {
        look(kSouthLow, 80);
        look(0, 20);
    }
    CHECK(lines.low_ms(Side::South) >= 10 * (80 - 16));
}

TEST_CASE_FIXTURE(Looks, "bytes are not taken for a line that stays low") {
    Numbers numbers(3);
    for (uint32_t i = 0; i < 1000000; ++i) {
        // Half of the looks find it low, and so they do for at most 8 ms together.
        look(i % 20 < 8 && numbers.draw(0, 1) ? kSouthLow : 0, 1);
    }
    CHECK(lines.low_ms(Side::South) == 0);
}

TEST_CASE_FIXTURE(Looks, "turns of the main loop may be longer than a millisecond, or shorter") {
    for (int i = 0; i < 100; ++i) {
        lines.look(kSouthLow, now_ms += 5);
        lines.look(kSouthLow, now_ms);
    }
    CHECK(lines.low_ms(Side::South) >= 500 - 20);
    CHECK(lines.low_ms(Side::South) <= 500);
    for (int i = 0; i < 100; ++i) {
        lines.look(kSouthLow, now_ms += 5);
        lines.look(0, now_ms); // high at one look of the same millisecond
    }
    CHECK(lines.low_ms(Side::South) <= 510);
}
