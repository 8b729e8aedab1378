"""Benchmarks. `PYTHONPATH=tools python -m bench.NAME` runs one; --write puts its table into a document."""
