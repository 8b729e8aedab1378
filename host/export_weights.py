#!/usr/bin/env python3
"""Launcher: `python host/export_weights.py ...` is `tilenca export ...`."""

import sys

from tilenca.cli import main

sys.exit(main(["export", *sys.argv[1:]]))
