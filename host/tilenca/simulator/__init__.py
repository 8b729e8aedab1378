"""Many runs at once on the firmware's own core, compiled for this machine."""
