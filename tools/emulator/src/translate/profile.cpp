#include "translate/profile.h"

#include "avr/ops.h"

namespace tilenca::translate {

namespace {

using avr::Cpu;
using avr::Instruction;

void counted(TILENCA_STATE) {
    avr::Counts& counts = *cpu->counts;
    const auto word = static_cast<size_t>(at - cpu->program);
    counts.executed[word]++;
    return counts.handlers[word](cpu, at, cycle, carry, zero, nvh);
}

} // namespace

void count_instructions(avr::Program& program) {
    program.count_with(counted);
}

} // namespace tilenca::translate
