"""Stand-in for PlatformIO's `arduino` framework on AVR: Arduino's own flags, core and variant.

The same flags in the same order as the official builder has them: the same compiler makes the same image.
"""

from pathlib import Path

from SCons.Script import DefaultEnvironment

env = DefaultEnvironment()
board = env.BoardConfig()
framework = Path(env.PioPlatform().get_package_dir("framework-arduino-avr"))
core = framework / "cores" / board.get("build.core")
variant = framework / "variants" / board.get("build.variant")

env.Append(
    ASPPFLAGS=["-x", "assembler-with-cpp"],
    CFLAGS=["-std=gnu11"],
    CCFLAGS=["-Os", "-Wall", "-ffunction-sections", "-fdata-sections", "-flto", "-mmcu=$BOARD_MCU"],
    CXXFLAGS=["-fno-exceptions", "-fno-threadsafe-statics", "-fpermissive", "-std=gnu++11"],
    CPPDEFINES=[
        ("F_CPU", "$BOARD_F_CPU"),
        "ARDUINO_ARCH_AVR",
        ("ARDUINO", 10808),
        # gcc 5.4 has only the reserved name, and this core's Print.cpp uses the other one.
        ("DECIMAL_DIG", "__DECIMAL_DIG__"),
    ],
    CPPPATH=[str(core), str(variant)],
    LINKFLAGS=["-Os", "-mmcu=$BOARD_MCU", "-Wl,--gc-sections", "-flto", "-fuse-linker-plugin"],
    LIBS=["m"],
    LIBSOURCE_DIRS=[str(framework / "libraries")],
)
env.Append(ASFLAGS=env.get("CCFLAGS", [])[:])

libraries = [env.BuildLibrary(str(Path("$BUILD_DIR") / "FrameworkArduino"), str(core))]
if any(variant.glob("*.c*")):
    libraries.insert(0, env.BuildLibrary(str(Path("$BUILD_DIR") / "FrameworkArduinoVariant"), str(variant)))
env.Prepend(LIBS=libraries)
