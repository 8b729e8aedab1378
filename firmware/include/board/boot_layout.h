// What boot.cpp shares with the start-up code and the watchdog's interrupt in avr/boot.S. Read by the
// assembler too, so only macros.
#pragma once

// The stack's room is filled with this byte at the start. What has another value later was used.
#define STACK_PAINT 0xC5

// Members of Survivors, which outlive a reset in SRAM that nobody clears.
#define SURVIVORS_MARK 0
#define SURVIVORS_CAUSE 4
#define SURVIVORS_HUNG_AT 5
#define SURVIVORS_BYTES 8

// Values of the mark: the program runs, or the watchdog's interrupt stopped it.
#define MARK_RUNNING 0x52554E21
#define MARK_HUNG 0x48554E47
