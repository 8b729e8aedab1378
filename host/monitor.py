#!/usr/bin/env python3
"""Launcher: `python host/monitor.py ...` is `tilenca monitor ...`."""

import sys

from tilenca.cli import main

sys.exit(main(["monitor", *sys.argv[1:]]))
