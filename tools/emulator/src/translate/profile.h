// Which instructions a program executes, and how often.
#pragma once

#include "avr/program.h"

namespace tilenca::translate {

// Makes every chip that runs the program from now on count each instruction it executes. Only for programs
// whose chips share one thread.
void count_instructions(avr::Program& program);

} // namespace tilenca::translate
