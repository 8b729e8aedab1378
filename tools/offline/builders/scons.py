"""Starts the SCons that lies in `lib` beside this file; PlatformIO runs it as tool-scons/scons.py."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent / "lib"))

from SCons.Script import main  # only now can it be found

if __name__ == "__main__":
    main()
