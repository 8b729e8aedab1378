#include "array/workers.h"

#include <chrono>

namespace tilenca {

namespace {

constexpr int kSpins = 2000;
constexpr uint64_t kRound = uint64_t{1} << 32;

// Leaves the other thread of the same core more of it.
void relax() {
#if defined(__x86_64__)
    __builtin_ia32_pause();
#endif
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

bool Workers::take_turn() {
    uint64_t ticket = ticket_.load(std::memory_order_acquire);
    const auto index = static_cast<unsigned>(ticket);
    // A round that has ended meanwhile has another ticket: then the exchange fails.
    if (index >= count_.load(std::memory_order_acquire) ||
        !ticket_.compare_exchange_strong(ticket, ticket + 1, std::memory_order_acq_rel)) {
        return index < count_.load(std::memory_order_relaxed);
    }
    (*work_.load(std::memory_order_acquire))(index);
    done_.fetch_add(1, std::memory_order_release);
    return true;
}

void Workers::help() {
    for (int spins = 0; !ends_.load(std::memory_order_relaxed); spins++) {
        if (take_turn()) {
            spins = 0;
        } else if (spins < kSpins) {
            relax();
        } else if (resting_.load(std::memory_order_relaxed)) {
            std::this_thread::sleep_for(std::chrono::microseconds(200));
        } else {
            std::this_thread::yield();
        }
    }
}

void Workers::share(unsigned count, const std::function<void(unsigned)>& work) {
    resting_ = false;
    done_ = 0;
    count_ = 0; // so that nobody takes a ticket of the new round with the old work
    ticket_ = (ticket_ / kRound + 1) * kRound;
    work_ = &work;
    count_.store(count, std::memory_order_release);
    while (take_turn()) {
    }
    for (int spins = 0; done_.load(std::memory_order_acquire) != count; spins++) {
        if (spins < kSpins) {
            relax();
        } else {
            std::this_thread::yield();
        }
    }
}

} // namespace tilenca
