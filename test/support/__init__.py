"""What tests share: fixtures, references that fast code must equal, faults, a lab of emulated tiles."""
