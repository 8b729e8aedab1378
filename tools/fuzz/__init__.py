"""What parses in firmware and emulator, under libFuzzer with sanitizers: python -m fuzz, or make fuzz."""
