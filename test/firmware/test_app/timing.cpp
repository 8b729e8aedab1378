#include <doctest/doctest.h>

#include "app/timing.h"

using tilenca::Timing;

TEST_CASE("the longest turn, the longest update and the share of time awake, until they are reported") {
    Timing timing;
    uint32_t now_us = 0xFFFFF000; // the clock wraps on the way
    timing.turn(now_us);
    for (int i = 0; i < 100; ++i) {
        timing.computed(700, false);
        timing.computed(i == 50 ? 900 : 300, true);
        timing.slept(6000);
        timing.turn(now_us += i == 20 ? 12000 : 10000);
    }
    CHECK(timing.compute_us() == 1600);
    CHECK(timing.gap_us() == 12000);
    CHECK(timing.awake_permille() == 402); // 600 ms of 1,002 asleep
    timing.reported();
    CHECK(timing.compute_us() == 0);
    CHECK(timing.gap_us() == 0);
    timing.turn(now_us += 5000);
    CHECK(timing.gap_us() == 5000);
    CHECK(timing.awake_permille() == 1000);
}

TEST_CASE("before any time has passed a tile is awake") {
    Timing timing;
    CHECK(timing.awake_permille() == 1000);
    timing.turn(77);
    CHECK(timing.gap_us() == 0);
    CHECK(timing.awake_permille() == 1000);
}
