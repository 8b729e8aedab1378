#include <doctest/doctest.h>

#include <initializer_list>

#include "app/timing.h"

using tilenca::Timing;

namespace {

// A loop whose clock and stamps go together, as on the board.
struct Loop {
    Timing timing;
    uint32_t now_ms = 0xFFFFFFF0; // the clock wraps on the way

    void turn_after(uint32_t ms) {
        now_ms += ms;
        timing.turn(now_ms, static_cast<uint16_t>(now_ms * 2000));
    }
};

} // namespace

TEST_CASE_FIXTURE(
    Loop, "the longest turn, the longest update and the share of time awake, until they are reported") {
    turn_after(0);
    for (int i = 0; i < 100; ++i) {
        timing.computed(1400, false);
        timing.computed(i == 50 ? 1800 : 600, true);
        timing.slept(12000);
        turn_after(i == 20 ? 12 : 10);
    }
    CHECK(timing.compute_us() == 1600);
    CHECK(timing.gap_us() == 12000);
    CHECK(timing.awake_permille() == 402); // 600 ms of 1,002 asleep
    timing.reported();
    CHECK(timing.compute_us() == 0);
    CHECK(timing.gap_us() == 0);
    turn_after(5);
    CHECK(timing.gap_us() == 5000);
    CHECK(timing.awake_permille() == 1000);
}

TEST_CASE_FIXTURE(Loop, "a turn longer than the stamps' range is told as long as it was") {
    turn_after(0);
    for (uint32_t ms : {1u, 31u, 32u, 33u, 40u, 1000u}) {
        turn_after(ms);
        CHECK(timing.gap_us() == ms * 1000);
    }
}

TEST_CASE_FIXTURE(Loop, "before any time has passed a tile is awake") {
    CHECK(timing.awake_permille() == 1000);
    turn_after(77);
    CHECK(timing.gap_us() == 0);
    CHECK(timing.awake_permille() == 1000);
}
