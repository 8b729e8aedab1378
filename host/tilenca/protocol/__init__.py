"""Every byte on a wire, twin of the firmware's core and app (docs/PROTOCOL.md). Standard library only."""
