// What a tile reports to the host, and when: docs/PROTOCOL.md section 3.
#pragma once

#include <stdint.h>

#include "app/sentence.h"
#include "app/tile.h"

namespace tilenca {

// How the tile was started, and its program.
struct Boot {
    uint8_t reset_cause; // MCUSR, or what the marks in SRAM say
    uint32_t firmware_id;
    uint8_t fuses[4]; // low, high, extended, and the lock byte
};

// The health of a tile, as the board and the main loop measure it.
struct Health {
    uint32_t compute_us;
    uint32_t gap_us;
    uint16_t awake_permille;
    uint16_t stack_unused;
    uint16_t overruns[kSides];
    uint16_t framing_errors[kSides];
    uint32_t low_ms[kSides]; // for how long the receiving line stayed low
    uint16_t supply_mv;      // 0: not known yet
};

constexpr uint16_t kLeastSupplyMv = 4500; // 16 MHz need it (data sheet, speed grades)

// What can be wrong with a tile.
enum class Error : uint8_t { Settings, Watchdog, Stack, Supply };
constexpr uint8_t kErrors = 4;

void write_hello(const Tile& tile, const Boot& boot, Sentence* sentence);
void write_tile(const Tile& tile, uint32_t now_ms, Sentence* sentence);
void write_link(const Tile& tile, Side side, uint16_t overruns, uint32_t now_ms, Sentence* sentence);
void write_time(const Tile& tile, const Health& health, uint32_t dropped, uint32_t now_ms,
                Sentence* sentence);
void write_chip(const Tile& tile, const Boot& boot, Sentence* sentence);
void write_board(const Tile& tile, const Health& health, uint32_t now_ms, Sentence* sentence);

// `detail` of Error::Watchdog is the byte address in flash where the program hung, 0 if not known; of
// Error::Supply it is the voltage in mV.
void write_error(const Tile& tile, Error error, uint32_t detail, uint32_t now_ms, Sentence* sentence);

// Decides which sentence comes next. The host may read at its own pace.
class Telemetry {
  public:
    static constexpr uint8_t kTilePeriodMs = 100;
    static constexpr uint16_t kTimePeriodMs = 1000;
    static constexpr uint16_t kBoardAfterMs = 500; // TIME, so that no turn of the main loop writes both

    // Call it when a period of the tile has ended.
    void period_ended(const Tile& tile);

    // Reports an error, only once however often this is called.
    void failed(Error error, uint32_t detail = 0);

    // Counts a sentence that could not be sent. One that still waits when its successor is due is counted
    // without this.
    void drop() { ++dropped_; }

    enum class Next : uint8_t { Nothing, Error, Tile, Link, Time, Board };

    // The kind of sentence that is due.
    Next next(uint32_t now_ms) const;

    // Writes the sentence that next() names. True if it was TIME: then the measurements of health start anew.
    bool write(const Tile& tile, const Health& health, uint32_t now_ms, Sentence* sentence);

  private:
    static uint8_t mask_of(Error error) { return static_cast<uint8_t>(1 << static_cast<uint8_t>(error)); }
    Error first_error() const;

    uint32_t last_ms_ = 0;      // end of the period that was reported last
    uint32_t last_time_ms_ = 0; // when the last TIME was due
    uint32_t dropped_ = 0;
    uint32_t hung_at_ = 0;
    uint16_t sagged_mv_ = 0;
    uint8_t last_shown_ = Tile::kNothing;
    uint8_t next_side_ = 0;
    uint8_t errors_due_ = 0;  // one bit per Error
    uint8_t errors_told_ = 0; // one bit per Error
    bool any_yet_ = false;
    bool tile_due_ = false;
    bool link_due_ = false;
    bool board_due_ = true; // half a second after TIME
};

} // namespace tilenca
