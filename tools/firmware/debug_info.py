"""Lets PlatformIO keep line numbers in the ELF file; the image stays the same, to the byte.

Link-time optimisation generates the code, so the linker needs the option as well.
"""

Import("env")  # type: ignore[name-defined]  # noqa: F821  SCons brings it
env.Append(CCFLAGS=["-g"], LINKFLAGS=["-g"])  # type: ignore[name-defined]  # noqa: F821
