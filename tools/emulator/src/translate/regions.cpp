#include "translate/regions.h"

#include "translate/forms.h"

#include <algorithm>

namespace tilenca::translate {

namespace {

constexpr size_t kMostInstructions = 200; // of a function, or compilers take long
// A loop that leaves its function in one of so many rounds gains nothing.
constexpr uint64_t kRoundsToLeave = 8;

struct Interval {
    uint32_t first, last; // words at which its first block begins, and its last
};

class Loops {
  public:
    Loops(const avr::Program& program, const std::vector<Block>& blocks, const uint8_t* special)
        : program_(program), blocks_(blocks), special_(special) {
        for (size_t i = 0; i < blocks.size(); i++) {
            in_flash_.push_back(i);
        }
        std::sort(in_flash_.begin(), in_flash_.end(),
                  [this](size_t one, size_t other) { return begin(one) < begin(other); });
    }

    // Disjoint; loops that overlap are one.
    std::vector<Interval> find() const {
        std::vector<Interval> found;
        for (Interval loop : jumps_back()) {
            std::vector<Interval> apart;
            for (const Interval& other : found) {
                if (other.last < loop.first || loop.last < other.first) {
                    apart.push_back(other);
                } else {
                    loop = {std::min(loop.first, other.first), std::max(loop.last, other.last)};
                }
            }
            if (is_worthwhile(loop)) {
                apart.push_back(loop);
                found = std::move(apart);
            }
        }
        return found;
    }

    const std::vector<size_t>& in_flash() const { return in_flash_; }

  private:
    uint32_t begin(size_t block) const { return blocks_[block].words[0]; }
    uint64_t rounds(const Block& block) const { return block.executed / block.words.size(); }

    // The shortest come first.
    std::vector<Interval> jumps_back() const {
        std::vector<Interval> all;
        for (const Block& block : blocks_) {
            for (const uint32_t word : block.words) {
                const avr::Instruction in = program_.original(word);
                const Kind kind = form_of(in, special_).kind;
                const uint32_t to = word + static_cast<uint32_t>(in.jump);
                if ((kind == Kind::Branch || kind == Kind::Jump) && to <= block.words[0]) {
                    all.push_back({to, block.words[0]});
                }
            }
        }
        std::stable_sort(all.begin(), all.end(), [](const Interval& one, const Interval& other) {
            return one.last - one.first < other.last - other.first;
        });
        return all;
    }

    bool is_worthwhile(const Interval& loop) const {
        size_t instructions = 0;
        uint64_t most = 0, leaving = 0;
        for (const Block& block : blocks_) {
            if (block.words[0] < loop.first || block.words[0] > loop.last) {
                continue;
            }
            instructions += block.words.size();
            most = std::max(most, rounds(block));
            const bool leaves = std::any_of(block.words.begin(), block.words.end(), [this](uint32_t word) {
                const Kind kind = form_of(program_.original(word), special_).kind;
                return kind > Kind::Jump;
            });
            leaving += leaves ? rounds(block) : 0;
        }
        return instructions <= kMostInstructions && leaving * kRoundsToLeave <= most;
    }

    const avr::Program& program_;
    const std::vector<Block>& blocks_;
    const uint8_t* special_;
    std::vector<size_t> in_flash_; // all blocks, by where they begin
};

} // namespace

std::vector<std::vector<size_t>> regions_of(const avr::Program& program, const std::vector<Block>& blocks,
                                            const uint8_t* special) {
    const Loops loops(program, blocks, special);
    const std::vector<Interval> found = loops.find();
    std::vector<std::vector<size_t>> regions(found.size());
    for (const size_t block : loops.in_flash()) {
        const uint32_t begin = blocks[block].words[0];
        const auto loop = std::find_if(found.begin(), found.end(), [begin](const Interval& one) {
            return one.first <= begin && begin <= one.last;
        });
        if (loop == found.end()) {
            regions.push_back({block});
        } else {
            regions[static_cast<size_t>(loop - found.begin())].push_back(block);
        }
    }
    return regions;
}

} // namespace tilenca::translate
