"""Sweeps: a model's scores over every combination of conditions, in many runs on many cores."""
