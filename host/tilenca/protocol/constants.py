"""The numbers of docs/PROTOCOL.md. Names are as in C++: `kMaxSentence` there is `MAX_SENTENCE` here."""

PROTOCOL_VERSION = 3
KIND_STATE = 0
# Frames between tiles (section 1).
LINK_BAUD = 38400  # between south and north
ROW_BAUD = 125000  # between east and west
HEADER_SIZE = 5
CRC_SIZE = 2
MAX_CHANNELS = 51
MAX_PAYLOAD = HEADER_SIZE + MAX_CHANNELS + CRC_SIZE
MESSAGE_MAX = 127
MESSAGE_SHIFT = 7  # stored state 2^-13, message 2^-6 (section 4)
STATE_MAX = MESSAGE_MAX << MESSAGE_SHIFT
HIDDEN_MAX = 127
MESSAGE_OFFSET = 128
# Silence (section 2).
SILENT_PERIODS = 6
# Telemetry (section 3).
HOST_BAUD = 115200
MAX_SENTENCE = 200
LEAST_SUPPLY_MV = 4500
# Commands (section 6).
MAX_COMMAND = 64
MAX_BLINK_S = 60
# Settings in EEPROM (section 5).
SETTINGS_SIZE = 12
SETTINGS_VERSION = 2
MIN_PERIOD_MS = 10
MAX_PERIOD_MS = 10000
DEFAULT_PERIOD_MS = 20  # as platformio.ini builds it into the firmware
MAX_BRIGHTNESS = 255
SETTING_RANGES = {
    "id": (0, 255),
    "period": (MIN_PERIOD_MS, MAX_PERIOD_MS),
    "updates": (0, 0xFFFF),
    "brightness": (0, MAX_BRIGHTNESS),
    "leds": (0, 2),
}
PRESETS = ("paper", "default")
# The marking of a board in EEPROM, twice from this address.
MARKING_AT = 2 * SETTINGS_SIZE
MAX_REVISION = 0xFF
MAX_SERIAL = 0xFFFF
MISSING = 32  # a direction's score above which a tile is missing there, as a message (section 4)
