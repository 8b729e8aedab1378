"""For `env:native` of platformio.ini: outside `pio test` there is no program, only its core."""

from SCons.Script import COMMAND_LINE_TARGETS, DefaultEnvironment

if "__test" not in COMMAND_LINE_TARGETS:
    DefaultEnvironment().Append(LINKFLAGS=["-r", "-nostdlib"])  # one object file, which needs no main()
