// Carries out the host's commands and answers each: docs/PROTOCOL.md section 6.
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
    // `preset default` restores `defaults`. Both must outlive this.
    Host(const Settings& defaults, const Boot& boot) : defaults_(defaults), boot_(boot) {}

    // Takes bytes from the host until one of them completes a command or none is left. `read(&byte)` gives
    // the next one, or false. True if `sentence` is now the answer.
    //
    // `store` is a SettingsStore; call this only while it is not writing(). A later call gives the answer to
    // settings that went there.
    template <class Store, class Read>
    bool answer(Store& store, Read read, Tile* tile, uint32_t now_ms, Sentence* sentence);

    // Whether the display is to blink, so that a person finds the tile.
    bool blinking(uint32_t now_ms);

  private:
    enum class Result : uint8_t { Nothing, Answer, Store };

    Result receive(uint8_t byte, Tile* tile, uint32_t now_ms, Sentence* sentence);
    Result obey(Tile* tile, uint32_t now_ms, Sentence* sentence);
    Result begin_set(const Tile& tile, Sentence* sentence);
    Result begin_mark(const Tile& tile, Sentence* sentence);
    void end_set(bool stored, Tile* tile, Sentence* sentence);
    bool change(uint16_t most_leds, Settings* settings) const;
    void begin_ack(const Tile& tile, Sentence* sentence) const;
    void write_nak(const Tile& tile, const char* reason, const char* name, Sentence* sentence) const;

    const Settings& defaults_;
    const Boot& boot_;
    CommandReader reader_;
    Settings wanted_ = {}; // by the last command
    Block wanted_in_ = Block::Settings;
    bool storing_ = false; // they are being written, and the answer is due
    bool blinking_ = false;
    uint32_t blink_until_ms_ = 0;
};

template <class Store, class Read>
bool Host::answer(Store& store, Read read, Tile* tile, uint32_t now_ms, Sentence* sentence) {
    if (storing_) {
        storing_ = false;
        const bool stored = store.verify();
        if (!stored) {
            store.write(wanted_in_, tile->settings()); // back
        }
        end_set(stored, tile, sentence);
        return true;
    }
    for (uint8_t byte; read(&byte);) {
        const Result result = receive(byte, tile, now_ms, sentence);
        if (result == Result::Store) {
            store.write(wanted_in_, wanted_);
            storing_ = true;
            return false;
        }
        if (result == Result::Answer) {
            return true;
        }
    }
    return false;
}

} // namespace tilenca
