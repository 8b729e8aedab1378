"""Measurements and checks of the built firmware: budgets, stack, cycles, disassembly."""
