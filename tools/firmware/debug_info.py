"""Lets PlatformIO keep line numbers in the ELF file; the image stays the same, to the byte.

Link-time optimisation makes the code, and so the linker has to be asked as well.
"""

Import("env")  # type: ignore[name-defined]  # noqa: F821  SCons brings it
env.Append(CCFLAGS=["-g"], LINKFLAGS=["-g"])  # type: ignore[name-defined]  # noqa: F821
