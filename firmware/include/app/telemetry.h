// What a tile tells the host, and when: docs/PROTOCOL.md section 3.
#pragma once

#include <stdint.h>

#include "app/sentence.h"
#include "app/tile.h"

namespace tilenca {

void write_hello(const Tile& tile, uint8_t reset_cause, Sentence* sentence);
void write_tile(const Tile& tile, uint32_t now_ms, Sentence* sentence);
void write_link(const Tile& tile, Side side, uint32_t now_ms, Sentence* sentence);

// Decides which sentence comes next, and lets the host read at its own pace.
class Telemetry {
  public:
    static constexpr uint8_t kTilePeriodMs = 100;

    // Call it when a period of the tile has ended.
    void period_ended(const Tile& tile);

    // Writes the next sentence that is due; false if none is. Call it until then.
    bool next(const Tile& tile, uint32_t now_ms, Sentence* sentence);

  private:
    uint32_t last_ms_ = 0; // end of the period that was last reported
    uint8_t last_shown_ = Tile::kNothing;
    uint8_t next_side_ = 0;
    bool any_yet_ = false;
    bool tile_due_ = false;
    bool link_due_ = false;
};

} // namespace tilenca
