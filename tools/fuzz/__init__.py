"""What parses in the firmware, under libFuzzer with sanitizers: python -m fuzz, or make fuzz."""
