// A whole tile without its hardware. Its inputs are bytes and the time, its outputs frames and the class to
// show.
//
// Everything happens inside the calls below, so that one process can have any number of tiles, and a test can
// set the clock.
#pragma once

#include <stdint.h>

#include "app/settings.h"
#include "core/cell.h"
#include "core/link.h"
#include "core/model.h"
#include "core/side.h"

namespace tilenca {

class Tile {
  public:
    static constexpr uint8_t kNothing = 0xFF;

    // Starts as the seed, with a frame for every side. The first update is one period from now. The model
    // must outlive the tile.
    Tile(const Model& model, const Settings& settings, uint32_t now_ms);

    // Starts again from the seed. The links and the phase of the updates stay.
    void restart();

    // Changes the settings. The state, the links and the number of updates stay. A new period counts from the
    // end of the last one.
    void apply(const Settings& settings);

    // Takes the next byte from the line on this side.
    void receive(Side side, uint8_t byte, uint32_t now_ms);

    // Does at most one slice of work, which takes about a millisecond on the chip. True when this ended a
    // period: the tile has new frames for its neighbours, after an update or, once it has stopped, without
    // one.
    bool tick(uint32_t now_ms);

    // Whether an update is under way. Then call tick() again soon.
    bool busy() const { return cell_.updating(); }

    // Whether there is a frame for this side, and takes it, at most kMaxFrame bytes. The next state replaces
    // a frame that was not taken.
    bool has_frame(Side side) const { return untold_ & mask_of(side); }
    uint8_t take_frame(Side side, uint8_t* wire);

    // The class to show, or kNothing before the first update, and how sure it is, as Decision says.
    uint8_t shown() const { return decided_.best; }
    uint8_t margin() const { return decided_.margin; }

    // The side on which a tile is missing, as missing_side() says. Only if the model has directions.
    uint8_t missing() const { return missing_side(message() + cell_.channels() - model_.classes - kSides); }

    uint32_t updates() const { return updates_; }
    const Link& link(Side side) const { return links_[index_of(side)]; }
    const int8_t* message() const { return cell_.message(); }
    const Model& model() const { return model_; }
    const Settings& settings() const { return settings_; }

    // When the last period was due to end. A late tick() does not move it.
    uint32_t period_ended_ms() const { return due_ms_ - settings_.period_ms; }

  private:
    static uint8_t mask_of(Side side) { return static_cast<uint8_t>(1 << index_of(side)); }

    bool period_ends(uint32_t now_ms);
    bool stopped() const { return settings_.updates != 0 && updates_ >= settings_.updates; }
    void begin_update();
    void tell() { untold_ = (1 << kSides) - 1; }

    const Model& model_;
    Settings settings_;
    Cell cell_;
    Link links_[kSides];
    uint32_t due_ms_; // end of the current period
    uint32_t updates_ = 0;
    Decision decided_ = {kNothing, Decision::kNoMargin};
    uint8_t untold_ = 0; // one bit per side that has not taken the current state
};

} // namespace tilenca
