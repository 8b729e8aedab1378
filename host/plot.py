#!/usr/bin/env python3
"""Launcher: `python host/plot.py ...` is `tilenca plot ...`."""

import sys

from tilenca.cli import main

sys.exit(main(["plot", *sys.argv[1:]]))
