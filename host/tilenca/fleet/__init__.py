"""Real and served tiles behind ports: find, identify, flash, command, hear and record them."""
