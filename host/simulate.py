#!/usr/bin/env python3
"""Launcher: `python host/simulate.py ...` is `tilenca simulate ...`."""

import sys

from tilenca.cli import main

sys.exit(main(["simulate", *sys.argv[1:]]))
