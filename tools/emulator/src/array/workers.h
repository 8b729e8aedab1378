// Threads that share the tiles of one quantum among them, quantum after quantum.
//
// They wait for each other by spinning for a moment, since a quantum takes microseconds, and then by giving
// way to others.
#pragma once

#include <atomic>
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

    unsigned threads() const { return static_cast<unsigned>(helpers_.size()) + 1; }
    // Calls `work` with 0 .. count - 1, each once, on all threads, and returns when all calls have.
    void share(unsigned count, const std::function<void(unsigned)>& work);
    // Between calls of `share` helpers look out for work all the time; so let them rest.
    void rest() { resting_ = true; }

  private:
    void help();
    void take_turns();

    std::vector<std::thread> helpers_;
    std::atomic<unsigned> round_{0}, next_{0}, finished_{0};
    std::atomic<bool> ends_{false}, resting_{true};
    unsigned count_ = 0;
    const std::function<void(unsigned)>* work_ = nullptr;
};

} // namespace tilenca
