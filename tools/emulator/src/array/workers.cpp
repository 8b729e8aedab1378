#include "array/workers.h"

#include "array/spin.h"

#include <chrono>
#include <utility>

namespace tilenca {

Workers::Workers(unsigned threads, std::function<void(unsigned)> work)
    : threads_(threads), work_(std::move(work)), parts_(new Part[threads]), is_manned_(threads, 1) {
    try {
        for (unsigned i = 1; i < threads; i++) {
            helpers_.emplace_back([this, i] { help(i); });
        }
    } catch (...) { // no more threads are to be had
        stop();
        throw;
    }
}

Workers::~Workers() {
    stop();
}

void Workers::stop() {
    ends_ = true;
    for (std::thread& helper : helpers_) {
        helper.join();
    }
}

Workers::Order Workers::order_of(const Part& part) {
    const uint64_t word = part.order.load(std::memory_order_acquire);
    return {static_cast<uint32_t>(word >> 32), static_cast<unsigned>(word >> 16 & kMostCalls),
            static_cast<unsigned>(word & kMostCalls)};
}

unsigned Workers::work_off(Part& part, uint32_t round) {
    const Order order = order_of(part);
    if (order.round != round) {
        return 0;
    }
    for (unsigned calls = 0;; calls++) {
        uint64_t taken = part.taken.load(std::memory_order_acquire);
        // Below 0: nobody has begun with it. Above: the round is over, and this thread slept through its end.
        const auto ahead = static_cast<int32_t>(static_cast<uint32_t>(taken >> 32) - round);
        const unsigned next = ahead < 0 ? order.begin : static_cast<unsigned>(taken);
        if (ahead > 0 || next >= order.end ||
            !part.taken.compare_exchange_strong(taken, uint64_t{round} << 32 | (next + 1),
                                                std::memory_order_acq_rel)) {
            return calls;
        }
        call(next);
    }
}

// An exception that left a thread's function would end the program.
void Workers::call(unsigned number) noexcept {
    try {
        work_(number);
    } catch (...) {
        const std::lock_guard<std::mutex> lock(failing_);
        failure_ = std::current_exception();
    }
}

void Workers::help(unsigned own) {
    Part& mine = parts_[own];
    for (int spins = 0; !ends_.load(std::memory_order_relaxed); spins++) {
        const uint32_t round = order_of(mine).round;
        if (round != mine.seen.load(std::memory_order_relaxed)) {
            mine.seen.store(round, std::memory_order_relaxed);
            spins = 0;
        }
        const unsigned part = spins < kPatience ? own : (own + static_cast<unsigned>(spins)) % threads_;
        if (const unsigned calls = round == 0 ? 0 : work_off(parts_[part], round); calls != 0) {
            mine.done.store(mine.done.load(std::memory_order_relaxed) + calls, std::memory_order_release);
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

// An owner that did not come in time last time is not waited for before it shows itself again.
unsigned Workers::help_out(bool is_late) {
    unsigned calls = 0;
    for (unsigned i = 1; i < threads_; i++) {
        if (is_manned_[i] == 0) {
            is_manned_[i] = parts_[i].seen.load(std::memory_order_relaxed) == round_;
        }
        if (is_late || is_manned_[i] == 0) {
            const unsigned done = work_off(parts_[i], round_);
            is_manned_[i] = is_manned_[i] != 0 && done == 0;
            calls += done;
        }
    }
    return calls;
}

uint64_t Workers::done_by_helpers() const {
    uint64_t done = 0;
    for (unsigned i = 1; i < threads_; i++) {
        done += parts_[i].done.load(std::memory_order_acquire);
    }
    return done;
}

void Workers::share(unsigned count) {
    if (resting_.load(std::memory_order_relaxed)) {
        resting_ = false;
    }
    const uint64_t before = done_by_helpers();
    round_ = round_ == 0xFFFFFFFF ? 1 : round_ + 1;
    for (unsigned i = threads_; i-- != 0;) {
        const uint64_t begin = i * count / threads_, end = (i + 1) * count / threads_;
        parts_[i].order.store(uint64_t{round_} << 32 | begin << 16 | end, std::memory_order_release);
    }
    unsigned own = work_off(parts_[0], round_);
    for (int spins = 0; done_by_helpers() - before + own != count; spins++) {
        own += help_out(spins >= kPatience);
        if (spins < kSpins) {
            relax();
        } else {
            std::this_thread::yield();
        }
    }
    if (failure_ != nullptr) {
        std::rethrow_exception(std::exchange(failure_, nullptr));
    }
}

} // namespace tilenca
