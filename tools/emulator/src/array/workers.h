// Threads that share the tiles of one quantum among them, quantum after quantum.
//
// A quantum takes microseconds, so they look out for work all the time, and a message from one to the other
// is one cache line written by one and read by the other. Each thread has its own part, whose tiles stay in
// its caches. The other threads finish the work of one that lost its processor to another program.
#pragma once

#include <atomic>
#include <cstdint>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

namespace tilenca {

class Workers {
  public:
    static constexpr unsigned kMostCalls = 0xFFFF;

    // `threads` counts the caller's; `work` is what `share` calls.
    Workers(unsigned threads, std::function<void(unsigned)> work);
    ~Workers();
    Workers(const Workers&) = delete;
    Workers& operator=(const Workers&) = delete;

    // Calls `work` with 0 .. count - 1, each once, on all threads, and returns when all calls have. What a
    // call throws, this throws when all have ended.
    void share(unsigned count);
    // Until the next call of `share` the helpers need not look out for work so often.
    void rest() { resting_ = true; }

  private:
    struct Order {
        uint32_t round;
        unsigned begin, end;
    };
    struct Part {
        // From the caller to the owner: an order, in one word.
        alignas(64) std::atomic<uint64_t> order{0};
        // The round in the upper half, the next number to be called with in the lower one.
        alignas(64) std::atomic<uint64_t> taken{0};
        // From the owner to the caller: how many calls it has done since it exists, and the last round it
        // saw.
        alignas(64) std::atomic<uint64_t> done{0};
        std::atomic<uint32_t> seen{0};
    };

    static Order order_of(const Part& part);
    void call(unsigned number) noexcept;
    void stop();
    void help(unsigned own);
    // Does what is left of a part in that round; returns how many calls that were.
    unsigned work_off(Part& part, uint32_t round);
    unsigned help_out(bool is_late);
    uint64_t done_by_helpers() const;

    const unsigned threads_;
    const std::function<void(unsigned)> work_;
    std::unique_ptr<Part[]> parts_; // the caller's comes first
    std::vector<std::thread> helpers_;
    std::vector<char> is_manned_; // whether each part's owner was there lately
    uint32_t round_ = 0;
    std::mutex failing_; // guards failure_ while calls are under way
    std::exception_ptr failure_;
    alignas(64) std::atomic<bool> ends_{false};
    std::atomic<bool> resting_{true};
};

} // namespace tilenca
