"""What is measured and checked on the built firmware: budgets, stack, cycles, disassembly."""
