#include "array/workers.h"

#include <chrono>

namespace tilenca {

namespace {

constexpr int kSpins = 2000;

// Leaves the other thread of the same core more of it.
void relax() {
#if defined(__x86_64__)
    __builtin_ia32_pause();
#endif
}

template <class Condition>
void wait_for(const Condition& holds, const std::atomic<bool>& resting) {
    for (int spins = 0; !holds(); spins++) {
        if (spins < kSpins) {
            relax();
        } else if (resting.load(std::memory_order_relaxed)) {
            std::this_thread::sleep_for(std::chrono::microseconds(200));
        } else {
            std::this_thread::yield();
        }
    }
}

} // namespace

Workers::Workers(unsigned threads) {
    for (unsigned i = 1; i < threads; i++) {
        helpers_.emplace_back([this] { help(); });
    }
}

Workers::~Workers() {
    ends_ = true;
    for (std::thread& helper : helpers_) {
        helper.join();
    }
}

void Workers::take_turns() {
    for (unsigned i = next_.fetch_add(1); i < count_; i = next_.fetch_add(1)) {
        (*work_)(i);
    }
}

void Workers::help() {
    unsigned seen = 0;
    for (;;) {
        wait_for([&] { return round_.load(std::memory_order_acquire) != seen || ends_; }, resting_);
        if (ends_) {
            return;
        }
        seen++;
        take_turns();
        finished_.fetch_add(1, std::memory_order_release);
    }
}

void Workers::share(unsigned count, const std::function<void(unsigned)>& work) {
    resting_ = false;
    count_ = count;
    work_ = &work;
    finished_ = 0;
    next_ = 0;
    round_.fetch_add(1, std::memory_order_release);
    take_turns();
    const auto all = static_cast<unsigned>(helpers_.size());
    static const std::atomic<bool> never{false};
    wait_for([&] { return finished_.load(std::memory_order_acquire) == all; }, never);
}

} // namespace tilenca
