// Threads that share the tiles of one quantum among them, quantum after quantum.
//
// A quantum takes microseconds, so they look out for work all the time. Nobody waits for a thread that has
// not begun with a tile: on a machine with other things to do, whoever runs does the work.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <thread>
#include <vector>

namespace tilenca {

class Workers {
  public:
    // `threads` counts the caller's.
    explicit Workers(unsigned threads);
    ~Workers();
    Workers(const Workers&) = delete;
    Workers& operator=(const Workers&) = delete;

    // Calls `work` with 0 .. count - 1, each once, on all threads, and returns when all calls have.
    void share(unsigned count, const std::function<void(unsigned)>& work);
    // Until the next call of `share` the helpers need not look out for work so often.
    void rest() { resting_ = true; }

  private:
    void help();
    // Does one piece of work; false: there is none to be had.
    bool take_turn();

    std::vector<std::thread> helpers_;
    // The round in the upper half, the next number to be called with in the lower one.
    std::atomic<uint64_t> ticket_{0};
    std::atomic<unsigned> count_{0}, done_{0};
    std::atomic<const std::function<void(unsigned)>*> work_{nullptr};
    std::atomic<bool> ends_{false}, resting_{true};
};

} // namespace tilenca
