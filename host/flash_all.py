#!/usr/bin/env python3
"""Launcher: `python host/flash_all.py ...` is `tilenca flash ...`."""

import sys

from tilenca.cli import main

sys.exit(main(["flash", *sys.argv[1:]]))
