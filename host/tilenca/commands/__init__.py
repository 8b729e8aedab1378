"""The commands of `tilenca`, one module each."""
