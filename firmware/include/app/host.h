// Does what the host's commands ask for, and answers each: docs/PROTOCOL.md section 6.
#pragma once

#include <stdint.h>

#include "app/command.h"
#include "app/sentence.h"
#include "app/telemetry.h"
#include "app/tile.h"

namespace tilenca {

constexpr uint8_t kMaxBlinkS = 60;

class Host {
  public:
    // Answer: `sentence` is to be said. Store: block() is to be written into EEPROM, then stored() called;
    // until then no more bytes may come.
    enum class Result : uint8_t { Nothing, Answer, Store };

    // `defaults` is what `preset default` brings back; it must outlive this.
    Host(const Settings& defaults, const Boot& boot) : defaults_(defaults), boot_(boot) {}

    // Takes the next byte from the host.
    Result receive(uint8_t byte, Tile* tile, uint32_t now_ms, Sentence* sentence);

    // The settings that are to be kept, as they lie in EEPROM.
    const uint8_t (&block() const)[kSettingsSize] { return block_; }

    // What EEPROM holds twice after the attempt; `sentence` is the answer. If both are the block, it is in
    // force. Else false: block() is now that of the settings in force, to be written back.
    bool stored(const uint8_t (&first)[kSettingsSize], const uint8_t (&second)[kSettingsSize], Tile* tile,
                Sentence* sentence);

    // Whether the face is to blink, so that a person finds the tile.
    bool blinking(uint32_t now_ms);

  private:
    Result obey(Tile* tile, uint32_t now_ms, Sentence* sentence);
    Result begin_set(const Tile& tile, Sentence* sentence);
    bool change(Settings* settings) const;
    void begin_ack(const Tile& tile, Sentence* sentence) const;
    void write_nak(const Tile& tile, const char* reason, const char* name, Sentence* sentence) const;

    const Settings& defaults_;
    const Boot& boot_;
    CommandReader reader_;
    uint8_t block_[kSettingsSize] = {};
    bool blinking_ = false;
    uint32_t blink_until_ms_ = 0;
};

} // namespace tilenca
