#include "display.h"

namespace tilenca {

Display::Display(const tilenca_setup& setup, int first, int last, const Schedule& schedule, int8_t* shown)
    : target_(setup.target + setup.starts[first]), shown_(shown), right_(last - first), total_(last - first) {
    for (int run = first; run < last; ++run) {
        run_.insert(run_.end(), setup.starts[run + 1] - setup.starts[run], run - first);
    }
    for (int cell = 0; cell < static_cast<int>(run_.size()); ++cell) {
        counted_.push_back(schedule.counts(cell));
        total_[run_[cell]] += counted_[cell];
        right_[run_[cell]] += counted_[cell] && shown_[cell] == target_[cell];
    }
}

void Display::shares(float* shares) const {
    for (size_t run = 0; run < right_.size(); ++run) {
        shares[run] =
            total_[run] == 0 ? 0 : static_cast<float>(right_[run]) / static_cast<float>(total_[run]);
    }
}

} // namespace tilenca
