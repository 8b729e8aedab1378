#!/usr/bin/env python3
"""Launcher: `python host/train.py ...` is `tilenca train ...`."""

import sys

from tilenca.cli import main

sys.exit(main(["train", *sys.argv[1:]]))
