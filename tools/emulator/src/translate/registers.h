// The chip's registers as variables of a translated function: r0 to r31 and sp in its text.
//
// They are read when the function is entered, and written back wherever it is left. Registers that hold one
// number together share a variable: v2 is r4:r3:r2, say, and r2, r3 and r4 are then views of its bytes.
#pragma once

#include "translate/forms.h"

#include <array>

namespace tilenca::translate {

constexpr unsigned kStackPointer = 32, kVariables = 33; // the stack pointer is one more register

class Registers {
  public:
    // So many registers from one on hold one number; where some of them share another variable, nothing
    // changes.
    void join(unsigned first, unsigned count);
    bool are_joined(unsigned first, unsigned count) const {
        return first_[first] == first && count_[first] == count;
    }
    // An instruction's text tells what it uses and writes: "r24 = ", "put(r24, r25, ".
    void note(const std::string& text, Kind kind);
    // Nothing was written so far.
    void forget() { written_.fill(false); }
    std::string declared() const;
    std::string written_back() const;

  private:
    std::array<unsigned, kVariables> first_{}, count_{}; // of each register's variable; a count of 0: its own
    std::array<bool, kVariables> used_{}, written_{};
};

// The variable that registers from one on share.
std::string joint_name(unsigned first);

} // namespace tilenca::translate
