"""Stand-in for the builder of PlatformIO's `atmelavr` platform: ELF and hex by avr-gcc, upload by avrdude."""

from pathlib import Path

from SCons.Script import COMMAND_LINE_TARGETS, AlwaysBuild, Builder, Default, DefaultEnvironment

env = DefaultEnvironment()
env.Replace(
    AR="avr-gcc-ar",
    AS="avr-as",
    CC="avr-gcc",
    CXX="avr-g++",
    GDB="avr-gdb",
    OBJCOPY="avr-objcopy",
    RANLIB="avr-gcc-ranlib",
    SIZETOOL="avr-size",
    ARFLAGS=["rc"],
    PROGNAME="firmware",
    PROGSUFFIX=".elf",
    SIZECHECKCMD="$SIZETOOL -A -d $SOURCES",
    SIZEPRINTCMD="$SIZETOOL --mcu=$BOARD_MCU -C -d $SOURCES",
    SIZEPROGREGEXP=r"^(?:\.text|\.data|\.bootloader)\s+(\d+)",
    SIZEDATAREGEXP=r"^(?:\.data|\.bss|\.noinit)\s+(\d+)",
    UPLOADER="avrdude",
    UPLOADERFLAGS=[
        "-p",
        "$BOARD_MCU",
        "-C",
        str(Path(env.PioPlatform().get_package_dir("tool-avrdude") or "") / "avrdude.conf"),
        "-c",
        "$UPLOAD_PROTOCOL",
        "-b",
        "$UPLOAD_SPEED",
        "-D",  # the bootloader erases page by page and cannot erase the chip
        "-P",
        "$UPLOAD_PORT",
    ],
    UPLOADHEXCMD="$UPLOADER $UPLOADERFLAGS -U flash:w:$SOURCES:i",
)
env.Append(
    BUILDERS={
        "ElfToHex": Builder(
            action=env.VerboseAction("$OBJCOPY -O ihex -R .eeprom $SOURCES $TARGET", "Building $TARGET"),
            suffix=".hex",
        ),
    }
)

elf_path = str(Path("$BUILD_DIR") / "${PROGNAME}.elf")
hex_path = str(Path("$BUILD_DIR") / "${PROGNAME}.hex")
if "nobuild" in COMMAND_LINE_TARGETS:
    elf_file, hex_file = elf_path, hex_path
else:
    elf_file = env.BuildProgram()
    hex_file = env.ElfToHex(str(Path("$BUILD_DIR") / "${PROGNAME}"), elf_file)
    env.Depends(hex_file, "checkprogsize")

AlwaysBuild(env.Alias("nobuild", hex_file))
AlwaysBuild(env.Alias("buildprog", hex_file, hex_file))
env.AddPlatformTarget(
    "size",
    elf_file,
    env.VerboseAction("$SIZEPRINTCMD", "Calculating size $SOURCE"),
    "Program Size",
    "Calculate program size",
)
env.AddPlatformTarget(
    "upload",
    hex_file,
    [
        env.VerboseAction(env.AutodetectUploadPort, "Looking for upload port..."),
        env.VerboseAction("$UPLOADHEXCMD", "Uploading $SOURCE"),
    ],
    "Upload",
)
Default([elf_file, hex_file])
