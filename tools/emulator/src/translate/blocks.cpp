#include "translate/blocks.h"

#include "translate/forms.h"

#include <algorithm>
#include <numeric>
#include <set>

namespace tilenca::translate {

namespace {

// An event within a block leaves the whole of it to the interpreter, so it must not be long.
constexpr unsigned kMostCycles = 28;
constexpr double kCovered = 0.998; // of all instructions executed
constexpr uint64_t kSeldom = 8;    // fewer executions are not worth a block's compilation

class Finder {
  public:
    Finder(const avr::Program& program, const std::vector<uint64_t>& executed, const uint8_t* special)
        : program_(program), executed_(executed), special_(special), reached_(executed.size() + 4) {}

    std::vector<Block> find() {
        for (uint32_t word = 0; word < avr::kFlashWords; word++) {
            if (executed_[word] != 0) {
                look_at(word);
            }
        }
        for (uint32_t word = 0; word < avr::kFlashWords; word++) {
            if (executed_[word] != 0 &&
                !reached_[word]) { // an interrupt, or a jump to a place that was computed
                begins_.insert(word);
            }
        }
        std::vector<Block> all;
        for (auto begin = begins_.begin(); begin != begins_.end(); ++begin) { // grows meanwhile, further on
            if (Block block = block_from(*begin); !block.words.empty()) {
                all.push_back(std::move(block));
            }
        }
        return hottest(std::move(all));
    }

  private:
    void begin_at(uint32_t word) {
        if (word < avr::kFlashWords && executed_[word] != 0) {
            begins_.insert(word);
        }
    }

    // Where an instruction leads: what is come to from elsewhere begins a block.
    void look_at(uint32_t word) {
        const avr::Instruction& in = program_.original(word);
        const Form form = form_of(in, special_);
        const uint32_t after = word_after(program_, word);
        const uint32_t to = word + static_cast<uint32_t>(in.jump);
        const bool ends = form.kind == Kind::Jump || form.kind == Kind::Dynamic ||
                          form.kind == Kind::InterpretedEnd || form.kind == Kind::Call ||
                          form.kind == Kind::DynamicCall;
        if (form.kind == Kind::Jump || form.kind == Kind::Call || form.kind == Kind::Branch) {
            begin_at(to);
        }
        if (form.kind == Kind::Call || form.kind == Kind::DynamicCall || form.kind == Kind::Interpreted) {
            begin_at(after);
        }
        if (form.kind == Kind::Interpreted && in.jump != 0) { // a skip
            begin_at(to);
        }
        reached_[after] = reached_[after] || !ends;
        if (form.kind == Kind::Skip) {
            reached_[to] = true;
        }
    }

    Block block_from(uint32_t begin) {
        Block block;
        unsigned cycles = 0;
        bool is_skipped = false;
        for (uint32_t word = begin; word < avr::kFlashWords && executed_[word] != 0;) {
            const bool is_next = word != begin && !is_skipped;
            if (is_next && begins_.count(word) != 0) {
                break;
            }
            if (is_next && cycles >= kMostCycles) {
                begins_.insert(word);
                break;
            }
            const Form form = form_of(program_.original(word), special_);
            block.words.push_back(word);
            block.executed += executed_[word];
            const bool goes_on =
                form.kind == Kind::Plain || form.kind == Kind::Skip || form.kind == Kind::Branch;
            if (!goes_on && !is_skipped) {
                break;
            }
            cycles += form.cycles;
            is_skipped = form.kind == Kind::Skip;
            word = word_after(program_, word);
        }
        const bool only_interpreted =
            block.words.size() == 1 && form_of(program_.original(begin), special_).kind >= Kind::Interpreted;
        return only_interpreted ? Block{} : block;
    }

    std::vector<Block> hottest(std::vector<Block> all) const {
        std::stable_sort(all.begin(), all.end(),
                         [](const Block& one, const Block& other) { return one.executed > other.executed; });
        const double total =
            static_cast<double>(std::accumulate(executed_.begin(), executed_.end(), uint64_t{0}));
        double covered = 0;
        size_t kept = 0;
        while (kept < all.size() && covered < kCovered * total && executed_[all[kept].words[0]] >= kSeldom) {
            covered += static_cast<double>(all[kept++].executed);
        }
        all.resize(kept);
        return all;
    }

    const avr::Program& program_;
    const std::vector<uint64_t>& executed_;
    const uint8_t* special_;
    std::vector<bool> reached_; // by words that are executed before them
    std::set<uint32_t> begins_;
};

} // namespace

uint32_t word_after(const avr::Program& program, uint32_t word) {
    return word + (avr::is_two_words(program.word(word)) ? 2 : 1);
}

std::vector<Block> hot_blocks(const avr::Program& program, const std::vector<uint64_t>& executed,
                              const uint8_t* special) {
    return Finder(program, executed, special).find();
}

} // namespace tilenca::translate
