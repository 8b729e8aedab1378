"""The places of the project's files, independent of the current directory."""

from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
SHAPES = ROOT / "shapes"
MODELS = ROOT / "models"
DEFAULT_SHAPES = SHAPES / "digits.toml"
DEFAULT_MODEL = MODELS / "digits"
FIRMWARE = ROOT / "firmware"
FIRMWARE_ENV = "megaatmega2560"
FIRMWARE_ELF = ROOT / ".pio" / "build" / FIRMWARE_ENV / "firmware.elf"
BUILD = ROOT / "build"
