"""PlatformIO where its registry cannot be reached: stand-in packages made of Debian's and PyPI's.

`probe.py` asks whether the registry answers; `seed.py` fills a core directory of the project's own, out of
which plain `pio run`, `pio test`, `pio check` and the rest then work without a network. platformio.ini stays
the official one.
"""
