// What a tile tells the host, and when: docs/PROTOCOL.md section 3.
#pragma once

#include <stdint.h>

#include "app/sentence.h"
#include "app/tile.h"

namespace tilenca {

// What a tile knows of its start.
struct Boot {
    uint8_t reset_cause; // MCUSR, as far as known
    uint32_t firmware_id;
};

// What only the board and the main loop know of a tile's health.
struct Health {
    uint32_t compute_us;
    uint32_t gap_us;
    uint16_t awake_permille;
    uint16_t stack_unused;
    uint16_t overruns[kSides];
};

// What can be wrong with a tile.
enum class Error : uint8_t { Settings, Watchdog, Stack };
constexpr uint8_t kErrors = 3;

void write_hello(const Tile& tile, const Boot& boot, Sentence* sentence);
void write_tile(const Tile& tile, uint32_t now_ms, Sentence* sentence);
void write_link(const Tile& tile, Side side, uint16_t overruns, uint32_t now_ms, Sentence* sentence);
void write_time(const Tile& tile, const Health& health, uint32_t dropped, uint32_t now_ms,
                Sentence* sentence);

// `place`: the byte address in flash where the program hung, 0 if not known; only for Error::Watchdog.
void write_error(const Tile& tile, Error error, uint32_t place, uint32_t now_ms, Sentence* sentence);

// Decides which sentence comes next, and lets the host read at its own pace.
class Telemetry {
  public:
    static constexpr uint8_t kTilePeriodMs = 100;
    static constexpr uint16_t kTimePeriodMs = 1000;

    // Call it when a period of the tile has ended.
    void period_ended(const Tile& tile);

    // Something is wrong; said once, however often this is called.
    void failed(Error error, uint32_t place = 0);

    // Counts a sentence that could not be said. One that waits when its successor is due counts by itself.
    void drop() { ++dropped_; }

    enum class Next : uint8_t { Nothing, Error, Tile, Link, Time };

    // What is due; Nothing if that is so.
    Next next(uint32_t now_ms) const;

    // Writes what next() says; true if it was the report of the health, whose count then begins anew.
    bool write(const Tile& tile, const Health& health, uint32_t now_ms, Sentence* sentence);

  private:
    static uint8_t mask_of(Error error) { return static_cast<uint8_t>(1 << static_cast<uint8_t>(error)); }
    Error first_error() const;

    uint32_t last_ms_ = 0;      // end of the period that was last reported
    uint32_t last_time_ms_ = 0; // of the last TIME
    uint32_t dropped_ = 0;
    uint32_t hung_at_ = 0;
    uint8_t last_shown_ = Tile::kNothing;
    uint8_t next_side_ = 0;
    uint8_t errors_due_ = 0;  // one bit per Error
    uint8_t errors_told_ = 0; // the same
    bool any_yet_ = false;
    bool tile_due_ = false;
    bool link_due_ = false;
};

} // namespace tilenca
